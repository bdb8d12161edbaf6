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
  ContactFeaturePasses(const ModelData& model, const ModelOptions& options) : model_(model), wanted_workgroup_(options.image_workgroup) {}

  // `clean`: from the clean forces, into CleanContactFeatures; else from the image. Both run the same kernels.
  void record(Recorder recorder, bool clean, int max_regions) const;

 private:
  struct Kernels {
    gpu::PassKernel<ContactRegionsInterface> regions;
    gpu::PassKernel<ContactFeaturesInterface> features;
    std::uint32_t regions_per_workgroup = 1, features_per_workgroup = 1;  // instances
  };
  Kernels makeKernels(int max_regions) const;
  gpu::PassKernel<ContactRegionsInterface> makeRegions(int max_regions, const TeamSizes& sizes) const;
  gpu::PassKernel<ContactFeaturesInterface> makeFeatures(int max_regions, const TeamSizes& sizes) const;

  const ModelData& model_;
  int wanted_workgroup_;  // 0: chosen here
  KernelCache<int, Kernels> kernels_;
};

}  // namespace taxelsim
