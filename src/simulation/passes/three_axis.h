// Readout of three-axis taxels, shaders/three_axis.comp: forces after the spread -> signed counts of three axes.
#pragma once

#include "simulation/model_data.h"
#include "simulation/passes/interfaces.h"
#include "simulation/passes/kernel_cache.h"
#include "simulation/passes/recorder.h"

namespace taxelsim {

class ThreeAxisPass {
 public:
  explicit ThreeAxisPass(const ModelData& model) : model_(model) {}

  // The sensor has Readout::three_axis; the image pass has written normal and shear forces. `random`: some instance draws noise or gains.
  void record(Recorder& recorder, bool random) const;

 private:
  gpu::PassKernel<ThreeAxisInterface> makeKernel(bool random) const;

  const ModelData& model_;
  KernelCache<bool, gpu::PassKernel<ThreeAxisInterface>> kernels_;
};

}  // namespace taxelsim
