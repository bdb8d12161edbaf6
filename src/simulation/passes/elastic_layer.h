// Elastic layer, shaders/elastic_layer.comp: stage 2 of the globally coupled law, from the heights that the heights pass has written.
#pragma once

#include "simulation/model_data.h"
#include "simulation/passes/kernel_cache.h"
#include "simulation/passes/recorder.h"
#include "simulation/passes/sizes.h"

namespace taxelsim {

class ElasticLayerPass {
 public:
  struct Variant {
    bool loads = false;        // some instance is driven by load
    bool keeps_slots = false;  // of a batch with several slots and friction
    bool with_depth = false;   // outputs penetration_depth
    bool with_shear = false;   // outputs tactile_shear_force of a sensor with friction
    bool with_jacobian = false;
    auto operator<=>(const Variant&) const = default;  // NOLINT(modernize-use-nullptr): clang-tidy 14 misreads it
  };

  // The model must have a layer. Throws Error(kInput) for a workgroup size that is not allowed, and as checkLayerFits().
  ElasticLayerPass(const ModelData& model, const ModelOptions& options);

  void record(Recorder recorder, const Variant& variant) const;

 private:
  using Kernel = gpu::PassKernel<ElasticLayerInterface>;
  Kernel makeKernel(const Variant& variant) const;

  const ModelData& model_;
  PassSizes sizes_;
  KernelCache<Variant, Kernel> kernels_;
};

}  // namespace taxelsim
