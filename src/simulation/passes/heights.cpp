#include "simulation/passes/heights.h"

#include "heights_variants.h"

namespace taxelsim {
namespace {

std::uint32_t searchOf(const HeightsPass::Variant& variant) {
  return variant.loads ? DepthConstants::kSearchInTile : DepthConstants::kNoSearch;
}

}  // namespace

void HeightsPass::record(Recorder& recorder, const Variant& variant) const {
  const Kernel& kernel = kernels_.get(variant, [&] { return makeKernel(variant); });
  tiles_.dispatch(recorder, kernel, variant.list, sizesOf(variant).repeat);
}

PassSizes HeightsPass::sizesOf(const Variant& variant) const {
  return tiles_.sizesOf(searchOf(variant), variant.list, tiles_.kindsOf(variant.list, 0), false);
}

HeightsPass::Kernel HeightsPass::makeKernel(const Variant& variant) const {
  const HeightsInterface constants{
      .depth = tiles_.depthConstants({.search = searchOf(variant),
                                      .list = variant.list,
                                      .kinds = tiles_.kindsOf(variant.list, 0),
                                      .many_slots = variant.many_slots,
                                      .keeps_slots = variant.keeps_slots,
                                      .area = variant.cells,
                                      .variation = variant.cells}),
      .REACH = model_.law.reach,
      .HAS_CELLS = model_.area(),
  };
  const PassSizes sizes = sizesOf(variant);
  return {model_.context(), "heights", model_.profile.select(k_heights_variants, sizes.workgroup),
          commonConstants(model_.contact_sensor, model_.contact_packed, sizes), constants};
}

}  // namespace taxelsim
