/// @file
/// The immutable part of a simulation: one sensor, the objects that it may touch, and the compiled passes. Not the state of a batch: that
/// belongs to Simulator.
#pragma once

#include <memory>
#include <utility>
#include <vector>

#include "taxelsim/device.h"
#include "taxelsim/object.h"
#include "taxelsim/sensor.h"

namespace taxelsim {

/// @cond
struct ModelAccess;
/// @endcond

/// Options of a Model.
struct ModelOptions {
  Sensor sensor;                  ///< The sensor; must pass checkSensor().
  std::vector<Object> objects{};  ///< Objects, referred to by index; may be empty if all simulators take contact points.
  /// Invocations per workgroup of the contact pass, a power of two, 4 to 256. 0 (default): the value measured best for the kind of device.
  /// Results do not depend on it.
  int contact_workgroup = 0;
  int image_workgroup = 0;  ///< The same for the image pass and the feature passes.
};

/// A sensor and objects on a device, shared by any number of simulators.
///
/// A copy is a handle to the same model, whose device memory is released with its last handle; a Simulator holds one.
///
/// Threads: immutable; may be used from several threads at once.
class Model {
 public:
  /// Uploads the objects and prepares the passes. Waits.
  ///
  /// Kernels are compiled when a simulator first needs them, in threads of their own; see Simulator::prepare(). Throws Error(kInput) for a
  /// sensor or object that checkSensor() or checkObject() refuses and for workgroup sizes out of range; Error(kDevice) when memory runs
  /// out.
  Model(const Device& device, const ModelOptions& options);

  const Sensor& sensor() const;                ///< The sensor; valid as long as any handle.
  const std::vector<Object>& objects() const;  ///< The objects; valid as long as any handle.
  const Device& device() const;                ///< The device; valid as long as any handle.

  /// @cond
  struct Impl;
  /// @endcond

 private:
  friend struct ModelAccess;
  explicit Model(std::shared_ptr<const Impl> impl) : impl_(std::move(impl)) {}
  std::shared_ptr<const Impl> impl_;
};

}  // namespace taxelsim
