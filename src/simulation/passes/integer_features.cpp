#include "simulation/passes/integer_features.h"

#include "integer_features.spv.h"
#include "simulation/passes/sizes.h"

namespace taxelsim {

void IntegerFeaturesPass::record(Recorder recorder, IntegerSource source) const {
  const std::size_t words = recorder.bindings.buffer<block::IntegerFeatures>().size() / sizeof(block::IntegerFeatures::Element);
  if (source == kContactSource) recorder.bindings.redirect<block::Features, block::ContactFeatures>();
  if (source == kCleanContactSource) recorder.bindings.redirect<block::Features, block::CleanContactFeatures>();
  recorder.dispatch(kernels_.get(source, [&] { return makeKernel(source); }),
                    numWorkgroups(words, gpu::DriverProfile::kIndependentWorkgroup));
}

gpu::PassKernel<IntegerFeaturesInterface> IntegerFeaturesPass::makeKernel(IntegerSource source) const {
  return {model_.context(), "integer_features", k_integer_features_spirv,
          commonConstants(model_.sensor, model_.packed, {.workgroup = gpu::DriverProfile::kIndependentWorkgroup}),
          IntegerFeaturesInterface{.SOURCE = static_cast<std::uint32_t>(source)}};
}

}  // namespace taxelsim
