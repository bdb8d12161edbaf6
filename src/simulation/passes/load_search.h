// Load search over all tiles of a sensor, shaders/load.comp: after each evaluation by the contact pass, the next offset of every instance.
#pragma once

#include <span>

#include "simulation/model_data.h"
#include "simulation/passes/kernel_cache.h"
#include "simulation/passes/recorder.h"
#include "simulation/passes/sizes.h"

namespace taxelsim {

class LoadSearchPass {
 public:
  // Evaluations after which a search ends: at most kMaxEvaluations of the search, one that closes it, and one at the offset found.
  static constexpr std::uint32_t kMaxEvaluations = 48;
  static constexpr std::uint32_t kNumFrameEvaluations = kMaxEvaluations + 2;

  LoadSearchPass(const ModelData& model, std::uint32_t workgroup) : model_(model), workgroup_(workgroup) {}

  void record(Recorder& recorder) const;

 private:
  gpu::PassKernel<LoadInterface> makeKernel() const;

  const ModelData& model_;
  std::uint32_t workgroup_;
  KernelCache<OnlyVariant, gpu::PassKernel<LoadInterface>> kernel_;
};

// Where a search over tiles begins and ends, m.
struct LoadReach {
  float highest, lowest;  // heights of the sensor's samples in S; the lowest less twice the skin's thickness
  float clearance;
  float first_step;  // below first touch, at most half of the way
};
LoadReach loadReach(const ModelData& model);

// Brackets of a search over tiles, from all objects just clear of the sensor to all of them past its skin. `poses`: (num_instances x
// those of the step). `flags` (num_instances): of InstanceRecord.
void startLoadSearch(const ModelData& model, std::span<const std::uint32_t> flags, std::span<const layout::PoseRecord> poses,
                     std::span<layout::LoadRecord> loads);

}  // namespace taxelsim
