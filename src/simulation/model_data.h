// What the passes of a model read: sensor and objects, packed and on the device, and what is known about the driver.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "gpu/bindings.h"
#include "gpu/buffer.h"
#include "gpu/driver_profile.h"
#include "simulation/pack/pack_contact_features.h"
#include "simulation/pack/pack_law.h"
#include "simulation/pack/pack_layer.h"
#include "simulation/pack/pack_objects.h"
#include "simulation/pack/pack_sensor.h"
#include "simulation/passes/blocks.h"
#include "simulation/tuning.h"
#include "taxelsim/model.h"

namespace taxelsim {

// Device buffers that never change, by block.
class ModelBuffers {
 public:
  explicit ModelBuffers(const Device& device) : device_(device) {}

  // Throws Error(kInput) where the device's buffers are too small, Error(kDevice) where its memory is.
  template <typename Block>
  void upload(const char* name, const std::vector<typename Block::Element>& values) {
    upload(Block::kIndex, name, std::as_bytes(std::span(values)));
  }

  std::uint64_t bytes() const { return bytes_; }
  void bindTo(gpu::Bindings& bindings) const;

 private:
  void upload(std::size_t block_index, const char* name, std::span<const std::byte> bytes);

  Device device_;
  std::array<gpu::Buffer, block::kNumBlocks> buffers_;
  std::uint64_t bytes_ = 0;
};

// What the contact pass is compiled for.
struct ObjectKinds {
  std::uint32_t kinds = 0;            // bit per kind of object
  std::vector<std::uint32_t> passes;  // the kinds that the contact pass processes in one dispatch, where each instance has one object
  std::uint32_t triangle_sizes = 0;   // bit 0: meshes of small triangles, bit 1: of large ones, bits 2 and 3: closed ones for area sampling
  std::uint32_t num_faces = 1;        // of each polyhedron
  std::uint32_t max_groups = 0;       // of clusters, of any mesh
  std::uint64_t max_triangles = 0;    // of any mesh
};

struct ModelData {
  // Throws as the constructor of Model.
  ModelData(const Device& device, const ModelOptions& options);

  gpu::Context& context() const;
  bool hasFriction() const { return taxelsim::hasFriction(sensor.skin); }
  bool relaxes() const { return !sensor.skin.relaxation.empty(); }
  bool area() const { return sensor.depth_sampling == DepthSampling::kArea; }
  // Words that a sample of the contact pass keeps between steps, shaders/skin/sample_states.glsl.
  std::uint32_t numSampleStates() const;
  // Whether cells of area sampling know how the depth varies within them, shaders/skin/law.glsl.
  bool variation() const { return area() && (isElasticLayer() || hasFriction() || foundationOf(sensor.skin).normal_exponent != 1); }
  bool isElasticLayer() const { return std::holds_alternative<ElasticLayer>(sensor.skin.law); }
  bool hasMask() const { return std::holds_alternative<DeformationMask>(sensor.skin.law); }
  // Sources of a taxel in the mask.
  std::uint32_t numMaskSources() const { return static_cast<std::uint32_t>(mask.size() / num_taxels); }

  Device device;
  gpu::DriverProfile profile;
  Sensor sensor;
  std::vector<Object> objects;
  std::vector<layout::LoadBoundsRecord> load_bounds;
  std::vector<layout::ObjectRecord> object_records;
  std::optional<PackedLayer> layer;  // of an elastic layer
  PackedSensor packed;
  // What the contact pass works on: the sensor, or the solver nodes of its layer as taxels.
  Sensor contact_sensor;
  PackedSensor contact_packed;
  PackedLaw law;
  PackedContactFeatures packed_contact;
  std::vector<glm::vec2> mask;  // packMask(), of the law deformation_mask
  std::uint32_t num_taxels = 0;
  ObjectKinds object_kinds;
  // Whether batches may keep candidates: shaders/keep_candidates.comp.
  bool keeps_candidates = false;
  // Whether workgroups of the contact pass may leave tiles to a second dispatch: shaders/depth/tile_sequence.glsl.
  bool leaves_tiles = false;
  ModelBuffers buffers;
};

}  // namespace taxelsim
