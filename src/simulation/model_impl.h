// What a Model holds on the device.
#pragma once

#include <vector>

#include "gpu/buffer.h"
#include "gpu/kernel.h"
#include "simulation/pack_sensor.h"
#include "taxelsim/model.h"

namespace taxelsim {

struct Model::Impl {
  Impl(const Device& of, const ModelOptions& options);

  Device device;
  Sensor sensor;
  std::vector<Object> objects;
  std::vector<Bounds> bounds;  // of the objects, in O; the endless ones cut at 1 m
  PackedSensor packed;
  std::uint32_t contact_workgroup = 0;
  std::uint32_t image_workgroup = 0;
  bool has_state = false;  // the law remembers the depth of the step before

  gpu::Buffer object_records, groups, clusters, triangles;
  gpu::Buffer sensor_record, patches, tiles, taxels, spread_entries;
  std::uint64_t static_bytes = 0;

  gpu::Kernel contact, image;
  gpu::Kernel load;  // made only for sensors that do not search in their one tile

 private:
  gpu::Kernel makeContactKernel() const;
  gpu::Kernel makeImageKernel() const;
  gpu::Kernel makeLoadKernel() const;
};

// Evaluations of the load search over several tiles.
inline constexpr std::uint32_t kLoadEvaluations = 48;

}  // namespace taxelsim
