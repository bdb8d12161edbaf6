// Contact pass, shaders/contact.comp: stages 1 (depth) and 2 (contact law) from poses of objects.
#pragma once

#include <cstdint>

#include "simulation/model_data.h"
#include "simulation/passes/kernel_cache.h"
#include "simulation/passes/recorder.h"
#include "simulation/passes/sizes.h"

namespace taxelsim {

// Samples that a tile may have on this device; `area`: with area sampling; `variation`: ModelData::variation().
std::uint32_t maxTileSamples(const DeviceInfo& info, bool area, bool variation);

class ContactPass {
 public:
  struct Variant {
    std::uint32_t search = ContactInterface::kNoSearch;
    bool many_slots = false;                           // several objects may be near an instance
    bool keeps_slots = false;                          // of a batch with several slots and friction
    bool with_depth = false;                           // outputs penetration_depth
    bool with_shear = false;                           // outputs tactile_shear_force of a sensor with friction
    bool with_jacobian = false;                        // outputs what a tactile Jacobian is computed from
    bool with_wrench = false;                          // and what the wrench's is computed from
    std::uint32_t list = layout::kNumLists;            // instances that it processes, kList...; kNumLists: all
    std::uint32_t kinds = 0;                           // bit per kind of object that it processes; 0: all of the model
    bool random_skin = false;                          // every instance has factors of its own, SkinVariation
    bool cells = false;                                // second run of a coupled law with area sampling: writes node_cells
    bool leaves_tiles = false;                         // to a second dispatch, shaders/depth/tile_sequence.glsl; set by record()
    auto operator<=>(const Variant&) const = default;  // NOLINT(modernize-use-nullptr): clang-tidy 14 misreads it
  };

  // Throws Error(kInput) for sizes that are not allowed or need more shared memory than the device has.
  ContactPass(const ModelData& model, const ModelOptions& options, const Tuning& tuning);

  const PassSizes& sizes() const { return sizes_; }
  // Instances of a list that a workgroup takes in sequence, in a batch of so many.
  std::uint32_t repeatOfLists(std::uint64_t num_instances) const;
  // Groups of a mesh's clusters that are culled between two barriers.
  std::uint32_t groupsPerBatch() const { return groups_per_batch_; }

  // For a globally coupled law writes heights and windows instead of forces, or with `cells` node_cells and the windows of both.
  void record(Recorder recorder, Variant variant) const;

 private:
  using Kernel = gpu::PassKernel<ContactInterface>;
  Kernel makeKernel(const Variant& variant) const;
  std::uint32_t mostInSequence() const;
  std::uint32_t repeatFor(std::uint32_t kinds) const;
  bool leavesTiles(std::uint64_t num_instances) const;
  std::uint32_t repeatOf(const Variant& variant) const;

  const ModelData& model_;
  PassSizes sizes_;
  int tuned_repeat_ = 0;
  std::uint32_t groups_per_batch_ = 0;
  KernelCache<Variant, Kernel> kernels_;
};

}  // namespace taxelsim
