#include "simulation/passes/three_axis.h"

#include "simulation/passes/sizes.h"
#include "three_axis_variants.h"

namespace taxelsim {

void ThreeAxisPass::record(Recorder& recorder, bool random) const {
  const auto& kernel = kernels_.get(random, [&] { return makeKernel(random); });
  recorder.dispatch(kernel, numWorkgroups(recorder.num_instances * model_.num_taxels, gpu::DriverProfile::kIndependentWorkgroup));
}

gpu::PassKernel<ThreeAxisInterface> ThreeAxisPass::makeKernel(bool random) const {
  const ThreeAxisReadout& axes = *model_.sensor.readout.three_axis;
  const auto& [x, y, z] = axes.gain;
  return {model_.context(), "three_axis", model_.profile.select(k_three_axis_variants, gpu::DriverProfile::kNoneWaits),
          commonConstants(model_.sensor, model_.packed, {.workgroup = gpu::DriverProfile::kIndependentWorkgroup}),
          ThreeAxisInterface{.RANDOM = random,
                             .GAIN_XX = x[0],
                             .GAIN_XY = x[1],
                             .GAIN_XZ = x[2],
                             .GAIN_YX = y[0],
                             .GAIN_YY = y[1],
                             .GAIN_YZ = y[2],
                             .GAIN_ZX = z[0],
                             .GAIN_ZY = z[1],
                             .GAIN_ZZ = z[2],
                             .NOISE_X = axes.noise[0],
                             .NOISE_Y = axes.noise[1],
                             .NOISE_Z = axes.noise[2],
                             .STRENGTH_X = axes.hysteresis_strength[0],
                             .STRENGTH_Y = axes.hysteresis_strength[1],
                             .STRENGTH_Z = axes.hysteresis_strength[2],
                             .WIDTH_X = axes.hysteresis_width[0],
                             .WIDTH_Y = axes.hysteresis_width[1],
                             .WIDTH_Z = axes.hysteresis_width[2],
                             .SATURATION = static_cast<double>(axes.saturation)}};
}

}  // namespace taxelsim
