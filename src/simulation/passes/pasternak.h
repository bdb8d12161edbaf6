// Two-parameter foundation, shaders/pasternak.comp: stage 2 of the law Pasternak, from the heights that the contact pass has written.
#pragma once

#include "simulation/model_data.h"
#include "simulation/passes/kernel_cache.h"
#include "simulation/passes/recorder.h"
#include "simulation/passes/sizes.h"

namespace taxelsim {

class PasternakPass {
 public:
  struct Variant {
    bool loads = false;                                // some instance is driven by load
    bool with_depth = false;                           // outputs penetration_depth
    auto operator<=>(const Variant&) const = default;  // NOLINT(modernize-use-nullptr): clang-tidy 14 misreads it
  };

  // The sensor's law must be Pasternak. Throws Error(kInput) for a workgroup size that is not allowed.
  PasternakPass(const ModelData& model, const ModelOptions& options);

  void record(Recorder recorder, const Variant& variant) const;

 private:
  using Kernel = gpu::PassKernel<PasternakInterface>;
  Kernel makeKernel(const Variant& variant) const;

  // Instances are at least as many.
  std::uint32_t numWorkgroups(std::uint64_t num_instances, const Variant& variant) const;

  const ModelData& model_;
  PassSizes sizes_;       // without loads
  PassSizes load_sizes_;  // with loads: other workgroups, the same sums
  KernelCache<Variant, Kernel> kernels_;
};

}  // namespace taxelsim
