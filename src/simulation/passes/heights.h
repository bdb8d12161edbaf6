// Heights pass, shaders/heights.comp: stage 1 for the law `elastic_layer`, from poses of objects.
#pragma once

#include "simulation/model_data.h"
#include "simulation/passes/kernel_cache.h"
#include "simulation/passes/recorder.h"
#include "simulation/passes/tile_plan.h"

namespace taxelsim {

class HeightsPass {
 public:
  HeightsPass(const ModelData& model, const TilePlan& tiles) : model_(model), tiles_(tiles) {}

  // Writes heights and windows; with variant.area, in a second run over all instances, node_cells and the windows of both.
  void record(Recorder& recorder, const DepthVariant& variant) const;

 private:
  using Kernel = gpu::PassKernel<HeightsInterface>;
  Kernel makeKernel(const DepthVariant& variant) const;

  const ModelData& model_;
  const TilePlan& tiles_;
  KernelCache<DepthVariant, Kernel> kernels_;
};

}  // namespace taxelsim
