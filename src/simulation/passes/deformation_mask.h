// Pass of the law deformation_mask between contact and image, shaders/deformation_mask.comp.
#pragma once

#include "simulation/model_data.h"
#include "simulation/passes/kernel_cache.h"
#include "simulation/passes/recorder.h"
#include "simulation/passes/sizes.h"

namespace taxelsim {

class DeformationMaskPass {
 public:
  // Throws Error(kInput) for a workgroup size that is not allowed.
  DeformationMaskPass(const ModelData& model, const ModelOptions& options);

  // `with_response`: keeps the forces before they are scaled, for the tactile Jacobian.
  void record(Recorder recorder, bool with_response) const;

 private:
  using Kernel = gpu::PassKernel<DeformationMaskInterface>;
  Kernel makeKernel(bool with_response) const;

  const ModelData& model_;
  TeamSizes sizes_;
  KernelCache<bool, Kernel> kernels_;  // by with_response
};

}  // namespace taxelsim
