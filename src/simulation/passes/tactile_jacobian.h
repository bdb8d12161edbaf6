// Tactile Jacobian, shaders/taxel_jacobian.comp, mask_jacobian.comp, rescale_jacobian.comp, wrench_jacobian.comp, spread_jacobian.comp,
// tactile_jacobian.comp: how forces, then features change with the sensor's twist. They follow the image pass. And force_gradient.comp,
// which contracts the changes of forces with the gradient of a loss.
#pragma once

#include <optional>

#include "simulation/model_data.h"
#include "simulation/passes/kernel_cache.h"
#include "simulation/passes/recorder.h"
#include "simulation/passes/sizes.h"

namespace taxelsim {

class TactileJacobianPasses {
 public:
  struct Variant {
    bool clean = false;                                // of the clean forces, into CleanTactileJacobian; else of the readout
    bool random = false;                               // some instance draws gains
    auto operator<=>(const Variant&) const = default;  // NOLINT(modernize-use-nullptr): clang-tidy 14 misreads it
  };

  TactileJacobianPasses(const ModelData& model, const ModelOptions& options) : model_(model), wanted_workgroup_(options.image_workgroup) {}

  // Changes of the forces of all taxels.
  void recordTaxels(Recorder& recorder) const;
  // Changes of the wrenches of all tiles, which the features of the clean forces need.
  void recordWrench(Recorder& recorder) const;
  // Changes of the forces after the point spread function; after recordTaxels().
  void recordSpread(Recorder& recorder) const;
  // Changes of the features; after recordTaxels().
  void recordFeatures(Recorder recorder, const Variant& variant) const;
  // Gradients by twists and gains, from the changes of forces of an earlier frame. Without gains, they are 1.
  void recordGradient(Recorder recorder, bool with_gains) const;

 private:
  struct TaxelKernels {
    std::optional<gpu::PassKernel<TaxelJacobianInterface>> taxels;  // none for a globally coupled law, whose pass writes the results
    // Of a law with a mask.
    std::optional<gpu::PassKernel<MaskJacobianInterface>> mask;
    std::optional<gpu::PassKernel<RescaleJacobianInterface>> rescale;
  };
  struct FeatureKernel {
    gpu::PassKernel<TactileJacobianInterface> kernel;
    std::uint32_t parts_per_workgroup = 1;
  };
  struct GradientKernel {
    gpu::PassKernel<ForceGradientInterface> kernel;
    std::uint32_t instances_per_workgroup = 1;
  };
  TaxelKernels makeTaxelKernels() const;
  FeatureKernel makeFeatureKernel(const Variant& variant) const;
  GradientKernel makeGradientKernel() const;

  const ModelData& model_;
  int wanted_workgroup_;  // 0: chosen here
  KernelCache<OnlyVariant, TaxelKernels> taxel_kernels_;
  KernelCache<OnlyVariant, gpu::PassKernel<WrenchJacobianInterface>> wrench_kernel_;
  KernelCache<OnlyVariant, gpu::PassKernel<SpreadJacobianInterface>> spread_kernel_;
  KernelCache<Variant, FeatureKernel> feature_kernels_;
  KernelCache<OnlyVariant, GradientKernel> gradient_kernel_;
};

}  // namespace taxelsim
