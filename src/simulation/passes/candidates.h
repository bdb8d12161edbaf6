// Candidates, shaders/keep_candidates.comp and find_candidates.comp: which triangles the contact pass tests for an object that moves
// slowly. They precede the contact pass.
#pragma once

#include "simulation/model_data.h"
#include "simulation/passes/kernel_cache.h"
#include "simulation/passes/recorder.h"
#include "simulation/passes/tile_plan.h"

namespace taxelsim {

class CandidatePasses {
 public:
  CandidatePasses(const ModelData& model, const TilePlan& tiles) : model_(model), tiles_(tiles) {}

  // Afterwards the lists of block Work say which instances the contact pass processes with candidates and which without.
  void record(Recorder& recorder, bool with_jacobian) const;

 private:
  struct Variant {
    bool with_jacobian;
    std::uint32_t listed_per_workgroup;                // instances of the contact pass
    auto operator<=>(const Variant&) const = default;  // NOLINT(modernize-use-nullptr): clang-tidy 14 misreads it
  };
  struct Kernels {
    gpu::PassKernel<KeepCandidatesInterface> keep;
    gpu::PassKernel<FindCandidatesInterface> find;
  };
  Kernels makeKernels(const Variant& variant) const;

  const ModelData& model_;
  const TilePlan& tiles_;
  KernelCache<Variant, Kernels> kernels_;
};

}  // namespace taxelsim
