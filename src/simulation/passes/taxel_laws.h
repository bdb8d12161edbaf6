// Passes over taxels of the laws that have some, between contact and image: shaders/mass_spring_damper.comp, proximity.comp.
#pragma once

#include <vector>

#include "simulation/model_data.h"
#include "simulation/passes/kernel_cache.h"
#include "simulation/passes/recorder.h"
#include "simulation/passes/sizes.h"

namespace taxelsim {

class TaxelLawPasses {
 public:
  explicit TaxelLawPasses(const ModelData& model) : model_(model) {}

  // All passes of the law in order; none for some laws.
  void record(Recorder recorder, bool with_shear) const;

 private:
  using Kernels = std::vector<gpu::PassKernel<TaxelLawInterface>>;
  Kernels makeKernels(bool with_shear) const;
  std::uint64_t itemsPerInstance(const TaxelPass& pass) const;

  const ModelData& model_;
  KernelCache<bool, Kernels> kernels_;  // by with_shear
};

}  // namespace taxelsim
