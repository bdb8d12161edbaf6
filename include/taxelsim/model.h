// What does not change while it is simulated: one sensor, the objects it may touch, the compiled passes. Immutable once made, so that
// many simulators share one.
#pragma once

#include <cstdint>
#include <memory>
#include <utility>
#include <vector>

#include "taxelsim/device.h"
#include "taxelsim/object.h"
#include "taxelsim/sensor.h"

namespace taxelsim {

struct ModelAccess;

struct ModelOptions {
  Sensor sensor;
  std::vector<Object> objects{};  // an instance refers to them by index; empty where all simulators take contacts
  // Workgroup sizes; 0 takes what was measured best for the kind of device. Powers of two, 4 to 256.
  int contact_workgroup = 0;
  int image_workgroup = 0;
};

class Model {
 public:
  // Uploads objects, builds pipelines; waits. Throws Error(kInput) for a sensor or object that checkSensor() or checkObject()
  // refuses and for workgroups out of their range, Error(kDevice) when memory runs out.
  Model(const Device& device, const ModelOptions& options);

  const Sensor& sensor() const;
  const std::vector<Object>& objects() const;
  const Device& device() const;

  struct Impl;

 private:
  friend struct ModelAccess;
  explicit Model(std::shared_ptr<const Impl> impl) : impl_(std::move(impl)) {}
  std::shared_ptr<const Impl> impl_;
};

}  // namespace taxelsim
