// Heights pass, shaders/heights.comp: stage 1 for the law `elastic_layer`, from poses of objects.
#pragma once

#include <cstdint>

#include "simulation/model_data.h"
#include "simulation/passes/kernel_cache.h"
#include "simulation/passes/recorder.h"
#include "simulation/passes/tile_plan.h"

namespace taxelsim {

class HeightsPass {
 public:
  struct Variant {
    bool loads = false;                                // some instance is driven by load
    bool many_slots = false;                           // several objects may be near an instance
    bool keeps_slots = false;                          // of a batch with several slots and friction
    std::uint32_t list = layout::kNumLists;            // instances that it processes, kList...; kNumLists: all
    bool cells = false;                                // with area sampling, the second run, over all: writes node_cells
    auto operator<=>(const Variant&) const = default;  // NOLINT(modernize-use-nullptr): clang-tidy 14 misreads it
  };

  HeightsPass(const ModelData& model, const TilePlan& tiles) : model_(model), tiles_(tiles) {}

  void record(Recorder& recorder, const Variant& variant) const;

 private:
  using Kernel = gpu::PassKernel<HeightsInterface>;
  PassSizes sizesOf(const Variant& variant) const;
  Kernel makeKernel(const Variant& variant) const;

  const ModelData& model_;
  const TilePlan& tiles_;
  KernelCache<Variant, Kernel> kernels_;
};

}  // namespace taxelsim
