// Contact features, shaders/contact_regions.comp and contact_features.comp: connected regions, then features of sensor, patches and
// regions. They follow the image pass.
#pragma once

#include "simulation/model_data.h"
#include "simulation/passes/kernel_cache.h"
#include "simulation/passes/recorder.h"
#include "simulation/passes/sizes.h"

namespace taxelsim {

class ContactFeaturePasses {
 public:
  struct Variant {
    bool clean = false;  // from the clean forces, into CleanContactFeatures; else from the image
    int max_regions = 0;
    auto operator<=>(const Variant&) const = default;  // NOLINT(modernize-use-nullptr): clang-tidy 14 misreads it
  };

  ContactFeaturePasses(const ModelData& model, const ModelOptions& options) : model_(model), wanted_workgroup_(options.image_workgroup) {}

  void record(Recorder recorder, const Variant& variant) const;

 private:
  struct Kernels {
    gpu::PassKernel<ContactRegionsInterface> regions;
    gpu::PassKernel<ContactFeaturesInterface> features;
    std::uint32_t regions_per_workgroup = 1, features_per_workgroup = 1;  // instances
  };
  Kernels makeKernels(const Variant& variant) const;
  gpu::PassKernel<ContactRegionsInterface> makeRegions(const Variant& variant, const TeamSizes& sizes) const;
  gpu::PassKernel<ContactFeaturesInterface> makeFeatures(const Variant& variant, const TeamSizes& sizes) const;

  const ModelData& model_;
  int wanted_workgroup_;  // 0: chosen here
  KernelCache<Variant, Kernels> kernels_;
};

}  // namespace taxelsim
