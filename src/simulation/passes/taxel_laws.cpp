#include "simulation/passes/taxel_laws.h"

namespace taxelsim {

void TaxelLawPasses::record(Recorder recorder, bool with_shear) const {
  const Kernels& kernels = kernels_.get(with_shear, [&] { return makeKernels(with_shear); });
  recorder.bindings.redirect<block::ForceFours, block::ContactNormal>();
  recorder.bindings.redirect<block::ResultFours, block::TileResults>();
  for (std::size_t k = 0; k < kernels.size(); ++k) {
    const std::uint64_t items = recorder.num_instances * itemsPerInstance(model_.law.taxel_passes[k]);
    recorder.dispatch(kernels[k], numWorkgroups(items, gpu::DriverProfile::kIndependentWorkgroup));
  }
}

std::uint64_t TaxelLawPasses::itemsPerInstance(const TaxelPass& pass) const {
  switch (pass.owner) {
    case TaxelPass::Owner::kTaxel:
      return model_.num_taxels;
    case TaxelPass::Owner::kTile:
      break;
  }
  return model_.packed.tiles.size();
}

TaxelLawPasses::Kernels TaxelLawPasses::makeKernels(bool with_shear) const {
  Kernels kernels;
  for (const TaxelPass& pass : model_.law.taxel_passes) {
    kernels.emplace_back(model_.context(), pass.kernel, model_.profile.select(pass.spirv, gpu::DriverProfile::kNoneWaits),
                         commonConstants(model_.sensor, model_.packed, {.workgroup = gpu::DriverProfile::kIndependentWorkgroup}),
                         TaxelLawInterface{.SCALED = model_.packed.scalesSpread(),
                                           .LAW_0 = model_.law.taxel_parameters[0],
                                           .LAW_1 = model_.law.taxel_parameters[1],
                                           .SHEAR = with_shear,
                                           .FRICTION_COEFFICIENT = model_.sensor.skin.friction.friction_coefficient});
  }
  return kernels;
}

}  // namespace taxelsim
