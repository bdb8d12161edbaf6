// Image pass, shaders/image.comp: stages 3 (spread), 4 (time), 5 (readout) and 6 (features).
#pragma once

#include "simulation/model_data.h"
#include "simulation/passes/kernel_cache.h"
#include "simulation/passes/recorder.h"
#include "simulation/passes/sizes.h"

namespace taxelsim {

class ImagePass {
 public:
  struct Variant {
    bool random = false;                               // some instance draws noise or gains
    bool whole_array = false;                          // taxels that no object reaches may have a force
    bool masked = false;                               // by the law deformation_mask
    bool with_normal = false;                          // outputs tactile_normal_force
    bool with_shear = false;                           // outputs tactile_shear_force of a sensor with friction
    bool random_skin = false;                          // every instance has factors of its own, SkinVariation
    auto operator<=>(const Variant&) const = default;  // NOLINT(modernize-use-nullptr): clang-tidy 14 misreads it
  };

  // Throws Error(kInput) for sizes that are not allowed or need more shared memory than the device has.
  ImagePass(const ModelData& model, const ModelOptions& options, const Tuning& tuning);

  // Items are instances.
  const TeamSizes& sizes() const { return sizes_; }

  void record(Recorder recorder, const Variant& variant) const;

 private:
  using Kernel = gpu::PassKernel<ImageInterface>;
  Kernel makeKernel(const Variant& variant) const;

  const ModelData& model_;
  TeamSizes sizes_;
  KernelCache<Variant, Kernel> kernels_;
};

}  // namespace taxelsim
