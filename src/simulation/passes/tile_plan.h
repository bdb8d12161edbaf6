// How the contact pass and the heights pass divide tiles among workgroups, and the constants of stage 1, which both compute.
#pragma once

#include <cstdint>

#include "simulation/model_data.h"
#include "simulation/passes/recorder.h"
#include "simulation/passes/sizes.h"

namespace taxelsim {

// Samples that a tile may have on this device; `area`: with area sampling; `variation`: ModelData::variation().
std::uint32_t maxTileSamples(const DeviceInfo& info, bool area, bool variation);

// The part of a kernel that finds depths; fields as in shaders/passes/depth.h.
struct DepthVariant {
  std::uint32_t search = DepthConstants::kNoSearch;
  std::uint32_t list = layout::kNumLists;
  std::uint32_t kinds = 0;  // of objects, as TilePlan::kindsOf() returns them
  bool many_slots = false;
  bool keeps_slots = false;
  bool area = false;
  bool variation = false;
};

class TilePlan {
 public:
  // Throws Error(kInput) for sizes that are not allowed or need more shared memory than the device has.
  TilePlan(const ModelData& model, const ModelOptions& options, const Tuning& tuning);

  const PassSizes& sizes() const { return sizes_; }
  // Sizes of a dispatch. `kinds`: of the objects that it processes; `leaves_tiles`: to a second dispatch.
  PassSizes sizesOf(std::uint32_t search, std::uint32_t list, std::uint32_t kinds, bool leaves_tiles) const;
  // Instances of a list that a workgroup takes in sequence, in a batch of `num_instances`.
  std::uint32_t repeatOfLists(std::uint64_t num_instances) const;
  // Groups of a mesh's clusters that are culled between two barriers.
  std::uint32_t groupsPerBatch() const { return groups_per_batch_; }
  // Whether workgroups leave tiles to a second dispatch, shaders/depth/tile_sequence.glsl.
  bool leavesTiles(std::uint64_t num_instances) const;

  // Kinds of objects in the instances of a list; `kinds`: those that a dispatch is limited to, 0 for all of the model.
  std::uint32_t kindsOf(std::uint32_t list, std::uint32_t kinds) const;
  DepthConstants depthConstants(const DepthVariant& variant) const;

  // Dispatches a kernel over the instances of a list; layout::kNumLists: over all.
  template <typename Interface>
  void dispatch(Recorder& recorder, const gpu::PassKernel<Interface>& kernel, std::uint32_t list, std::uint32_t repeat) const {
    if (list != layout::kNumLists) return recorder.dispatchOverList(kernel, list);
    recorder.dispatch(kernel, numWorkgroups(recorder.num_instances * model_.contact_packed.tiles.size(), repeat));
  }

 private:
  std::uint32_t mostInSequence() const;
  std::uint32_t repeatFor(std::uint32_t kinds) const;

  const ModelData& model_;
  PassSizes sizes_;
  int tuned_repeat_ = 0;
  std::uint32_t groups_per_batch_ = 0;
};

}  // namespace taxelsim
