#include "simulation/passes/load_search.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "load_variants.h"

namespace taxelsim {
namespace {

// With area sampling: how far below the place where bounds touch the search begins, and its steps until the object touches, m.
float firstStep(const ModelData& model) {
  return static_cast<float>(model.sensor.skin.thickness) / 8;
}

}  // namespace

void LoadSearchPass::record(Recorder& recorder) const {
  recorder.dispatch(kernel_.get({}, [&] { return makeKernel(); }), numWorkgroups(recorder.num_instances, workgroup_));
}

gpu::PassKernel<LoadInterface> LoadSearchPass::makeKernel() const {
  return {model_.context(), "load", model_.profile.select(k_load_variants, gpu::DriverProfile::kNoneWaits),
          commonConstants(model_.sensor, model_.packed, {.workgroup = workgroup_}),
          LoadInterface{.EVALUATIONS = kMaxEvaluations, .NEWTON = model_.area(), .FIRST_STEP = firstStep(model_)}};
}

LoadReach loadReach(const ModelData& model) {
  constexpr float kClearance = 1e-6f;  // m
  const auto thickness = static_cast<float>(model.sensor.skin.thickness);
  // Far below, area sampling is slow.
  return {model.packed.highest, model.packed.lowest - thickness * 2, kClearance,
          model.area() ? firstStep(model) : std::numeric_limits<float>::max()};
}

void startLoadSearch(const ModelData& model, std::span<const std::uint32_t> flags, std::span<const layout::PoseRecord> poses,
                     std::span<layout::LoadRecord> loads) {
  const LoadReach reach = loadReach(model);
  const std::size_t num_slots = poses.size() / loads.size();
  for (std::size_t i = 0; i < loads.size(); ++i) {
    if ((flags[i] & layout::kFlagHeld) != 0) continue;
    loads[i] = {{0.0f, 0.0f, 0.0f, layout::kLoadSearching}, {0.0f, 0.0f, 0.0f, 0.0f}};
    if ((flags[i] & layout::kFlagLoadDriven) == 0) continue;
    float low = std::numeric_limits<float>::infinity();
    float high = -low;
    for (const layout::PoseRecord& pose : poses.subspan(i * num_slots, num_slots)) {
      if (pose.object.x < 0) continue;
      const layout::LoadBoundsRecord& bounds = model.load_bounds[static_cast<std::size_t>(pose.object.x)];
      float center = pose.row2.w;
      float half = 0;
      for (int axis = 0; axis < 3; ++axis) {
        center += pose.row2[axis] * bounds.center[axis];
        half += std::abs(pose.row2[axis]) * bounds.half_size[axis];
      }
      low = std::min(low, center - half);
      high = std::max(high, center + half);
    }
    if (low > high) continue;  // no object: the first evaluation finds no force at any offset
    const float up = reach.highest - low + reach.clearance;
    const float down = reach.lowest - high;
    const float first = std::max(up - reach.first_step, 0.5f * (up + down));
    loads[i].bracket = {first, down, up, layout::kLoadSearching};
    loads[i].forces.x = std::numeric_limits<float>::max();
  }
}

}  // namespace taxelsim
