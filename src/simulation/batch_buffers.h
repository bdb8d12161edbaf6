// The device memory of one batch: every array that has a row per instance.
#pragma once

#include <cstdint>
#include <vector>

#include "gpu/buffer.h"
#include "simulation/model_impl.h"
#include "taxelsim/simulator.h"

namespace taxelsim {

// A device array and, where its memory cannot be seen by the host, the place it is copied to.
struct ReadableBuffer {
  gpu::Buffer device;
  gpu::Buffer readback;

  bool copied() const { return device.mapped().empty(); }
  template <typename T>
  std::span<const T> read() const {
    return copied() ? readback.mappedAs<T>() : device.mappedAs<T>();
  }
};

inline bool wantsJacobian(const OutputOptions& outputs) {
  return outputs.tactile_jacobian || outputs.clean_tactile_jacobian;
}

// Whether a batch keeps what the contact pass need look at from step to step: where it can, and there is room.
bool keepsCandidates(const Model::Impl& model, const SimulatorOptions& options);

struct BatchBuffers {
  BatchBuffers(const Model::Impl& model, const SimulatorOptions& options);

  gpu::Buffer poses, motions, instances, step, loads, contacts, num_contacts;  // from the host
  // stay on the device
  gpu::Buffer candidates, candidate_quads, work_instances;
  gpu::Buffer state, friction_state, law_state, contact_normal, contact_shear, tile_results, taxel_states;
  gpu::Buffer image_windows;            // of one grid patch with a frame at every step: what of it was written a step before
  gpu::Buffer heights, windows, layer;  // of an elastic layer: per node, per tile of the contact pass, arrays over strips of nodes
  gpu::Buffer forces, taxel_regions, region_sums, regions;                                    // of contact features
  gpu::Buffer contact_cells, tile_changes, taxel_jacobian, masked_jacobian, wrench_jacobian;  // of the tactile Jacobian
  // come back
  ReadableBuffer contact_depth, image, spread_normal, spread_shear, features, contact_features, clean_contact_features, jacobian,
      clean_jacobian, problems, work;
  std::vector<ReadableBuffer*> readable(const OutputOptions& outputs);
};

MemoryPlan planBatch(const Model::Impl& model, const SimulatorOptions& options);

// Throws Error(kInput) when an option is out of its range or the batch does not fit, with the size that does.
void checkBatchFits(const Model::Impl& model, const SimulatorOptions& options);

}  // namespace taxelsim
