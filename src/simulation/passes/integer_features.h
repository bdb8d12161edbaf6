// Integers and flags for importers of the device's memory, shaders/integer_features.comp.
#pragma once

#include "simulation/integer_features.h"
#include "simulation/model_data.h"
#include "simulation/passes/kernel_cache.h"
#include "simulation/passes/recorder.h"

namespace taxelsim {

class IntegerFeaturesPass {
 public:
  explicit IntegerFeaturesPass(const ModelData& model) : model_(model) {}

  // The passes that compute the features of `source` have been recorded.
  void record(Recorder recorder, IntegerSource source) const;

 private:
  gpu::PassKernel<IntegerFeaturesInterface> makeKernel(IntegerSource source) const;

  const ModelData& model_;
  KernelCache<IntegerSource, gpu::PassKernel<IntegerFeaturesInterface>> kernels_;
};

}  // namespace taxelsim
