// Contact pass, shaders/contact.comp: stages 1 (depth) and 2 (contact law) from poses of objects.
#pragma once

#include "simulation/model_data.h"
#include "simulation/passes/kernel_cache.h"
#include "simulation/passes/recorder.h"
#include "simulation/passes/tile_plan.h"

namespace taxelsim {

class ContactPass {
 public:
  struct Variant {
    DepthVariant depth;
    bool with_depth = false;                           // outputs penetration_depth
    bool with_shear = false;                           // outputs tactile_shear_force of a sensor with friction
    bool with_jacobian = false;                        // outputs what a tactile Jacobian is computed from
    bool with_wrench = false;                          // and what the wrench's is computed from
    bool random_skin = false;                          // every instance has factors of its own, SkinVariation
    bool leaves_tiles = false;                         // to a second dispatch, shaders/depth/tile_sequence.glsl; set by record()
    auto operator<=>(const Variant&) const = default;  // NOLINT(modernize-use-nullptr): clang-tidy 14 misreads it
  };

  ContactPass(const ModelData& model, const TilePlan& tiles) : model_(model), tiles_(tiles) {}

  void record(Recorder recorder, Variant variant) const;

 private:
  using Kernel = gpu::PassKernel<ContactInterface>;
  Kernel makeKernel(const Variant& variant) const;

  const ModelData& model_;
  const TilePlan& tiles_;
  KernelCache<Variant, Kernel> kernels_;
};

}  // namespace taxelsim
