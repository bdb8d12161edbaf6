#include "simulation/passes/heights.h"

#include "heights_variants.h"

namespace taxelsim {

void HeightsPass::record(Recorder& recorder, const DepthVariant& variant) const {
  const Kernel& kernel = kernels_.get(variant, [&] { return makeKernel(variant); });
  tiles_.dispatch(recorder, kernel, variant.list, tiles_.sizesOf(variant).repeat);
}

HeightsPass::Kernel HeightsPass::makeKernel(const DepthVariant& variant) const {
  const PassSizes sizes = tiles_.sizesOf(variant);
  return {model_.context(), "heights", model_.profile.select(k_heights_variants, sizes.workgroup),
          commonConstants(model_.contact_sensor, model_.contact_packed, sizes),
          HeightsInterface{.depth = tiles_.depthInterface(variant, variant.area), .REACH = model_.law.reach, .HAS_CELLS = model_.area()}};
}

}  // namespace taxelsim
