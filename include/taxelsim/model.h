// What does not change while it is simulated: one sensor, the objects it may touch, the compiled passes. Immutable once made, so that
// many simulators share one.
#pragma once

#include <cstdint>
#include <memory>
#include <vector>

#include "taxelsim/device.h"
#include "taxelsim/object.h"
#include "taxelsim/sensor.h"

namespace taxelsim {

// How the passes are cut into workgroups, for who measures a device (bench/sweep); nobody needs it to simulate. 0 everywhere takes what was
// measured best for the kind of device. Results do not depend on it, bit for bit. What a device has no room for is refused.
struct Tuning {
  int contact_repeat = 0;    // tiles that a workgroup of the contact pass does one after another, 1 to 64
  int image_team = 0;        // invocations that share an instance in the image pass: a power of two, 1 to its workgroup
  int image_repeat = 0;      // instances that such a team does one after another, 1 to 64
  int groups_per_batch = 0;  // groups of a mesh's clusters that the contact pass culls between two barriers: a power of two, 16 to 128
};

struct ModelOptions {
  Sensor sensor;
  std::vector<Object> objects{};  // an instance refers to them by index; empty where all simulators take contacts
  // Workgroup sizes; 0 takes what was measured best for the kind of device. Powers of two, 4 to 256.
  int contact_workgroup = 0;
  int image_workgroup = 0;
  Tuning tuning{};
};

class Model {
 public:
  // Uploads objects, builds pipelines; waits. Throws Error(kInput) for a sensor or object that checkSensor() or checkObject()
  // refuses and for workgroups or a tuning out of their range, Error(kDevice) when memory runs out.
  Model(const Device& device, const ModelOptions& options);

  const Sensor& sensor() const;
  const std::vector<Object>& objects() const;
  const Device& device() const;

  struct Impl;
  const std::shared_ptr<const Impl>& impl() const { return impl_; }

 private:
  std::shared_ptr<const Impl> impl_;
};

}  // namespace taxelsim
