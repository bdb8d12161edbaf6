// How the contact pass and the heights pass divide tiles among workgroups, and the constants of stage 1, which both compute.
#pragma once

#include <cstdint>

#include "simulation/model_data.h"
#include "simulation/passes/recorder.h"
#include "simulation/passes/sizes.h"

namespace taxelsim {

// Samples that a tile may have on this device; `area`: with area sampling; `variation`: ModelData::variation().
std::uint32_t maxTileSamples(const DeviceInfo& info, bool area, bool variation);

// The part of a kernel that finds depths.
struct DepthVariant {
  std::uint32_t search = DepthInterface::kNoSearch;
  std::uint32_t list = layout::kNumLists;                 // instances that it processes, kList...; kNumLists: all
  std::uint32_t kinds = 0;                                // bit per kind of object that it processes; 0: all of the model
  bool many_slots = false;                                // several objects may be near an instance
  bool keeps_slots = false;                               // of a batch with several slots and friction
  bool area = false;                                      // cells instead of points
  auto operator<=>(const DepthVariant&) const = default;  // NOLINT(modernize-use-nullptr): clang-tidy 14 misreads it
};

class TilePlan {
 public:
  // Throws Error(kInput) for sizes that are not allowed or need more shared memory than the device has.
  TilePlan(const ModelData& model, const ModelOptions& options, const Tuning& tuning);

  const PassSizes& sizes() const { return sizes_; }
  // Sizes of a dispatch, which may leave tiles to a second one.
  PassSizes sizesOf(const DepthVariant& variant, bool leaves_tiles = false) const;
  // Instances of a list that a workgroup takes in sequence, in a batch of `num_instances`.
  std::uint32_t repeatOfLists(std::uint64_t num_instances) const;
  // Groups of a mesh's clusters that are culled between two barriers.
  std::uint32_t groupsPerBatch() const { return groups_per_batch_; }
  // Whether workgroups leave tiles to a second dispatch, shaders/depth/tile_sequence.glsl.
  bool leavesTiles(std::uint64_t num_instances) const;

  // Kinds of the objects that a dispatch processes.
  std::uint32_t kindsOf(const DepthVariant& variant) const;
  // `variation`: VARIATION of shaders/passes/depth.h.
  DepthInterface depthInterface(const DepthVariant& variant, bool variation) const;

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
