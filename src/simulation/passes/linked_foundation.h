// Two-parameter foundation on several patches, shaders/linked_foundation.comp: stage 2 of the law Pasternak, from the heights that the
// contact pass has written.
#pragma once

#include "simulation/model_data.h"
#include "simulation/passes/kernel_cache.h"
#include "simulation/passes/recorder.h"
#include "simulation/passes/sizes.h"

namespace taxelsim {

class LinkedFoundationPass {
 public:
  struct Variant {
    bool loads = false;                                // in a load search
    bool with_depth = false;                           // outputs penetration_depth
    auto operator<=>(const Variant&) const = default;  // NOLINT(modernize-use-nullptr): clang-tidy 14 misreads it
  };

  // The model must be linked. Throws Error(kInput) for a workgroup size that is not allowed.
  LinkedFoundationPass(const ModelData& model, const ModelOptions& options);

  void record(Recorder& recorder, const Variant& variant) const;

 private:
  using Kernel = gpu::PassKernel<LinkedFoundationInterface>;
  Kernel makeKernel(const Variant& variant) const;

  const ModelData& model_;
  PassSizes sizes_;
  KernelCache<Variant, Kernel> kernels_;
};

}  // namespace taxelsim
