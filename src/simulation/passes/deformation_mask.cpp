#include "simulation/passes/deformation_mask.h"

#include "deformation_mask_variants.h"

namespace taxelsim {

DeformationMaskPass::DeformationMaskPass(const ModelData& model, const ModelOptions& options) : model_(model) {
  const std::uint64_t iterations = std::uint64_t{model.num_taxels} * model.numMaskSources();
  const std::uint32_t lanes = model.packed.image_lanes;
  sizes_ = teamSizes(options.image_workgroup, model.profile, iterations, lanes, lanes);
  if (sizes_.team == 1) sizes_.pass.workgroup = gpu::DriverProfile::kIndependentWorkgroup;
  sizes_.pass.repeat = 1;
}

void DeformationMaskPass::record(Recorder recorder, bool with_response) const {
  recorder.bindings.redirect<block::ForceFours, block::ContactNormal>();
  recorder.dispatch(kernels_.get(with_response, [&] { return makeKernel(with_response); }),
                    numWorkgroups(recorder.num_instances, sizes_.itemsPerWorkgroup()));
}

DeformationMaskPass::Kernel DeformationMaskPass::makeKernel(bool with_response) const {
  return {model_.context(), "deformation_mask", model_.profile.select(k_deformation_mask_variants, gpu::DriverProfile::kNoneWaits),
          commonConstants(model_.sensor, model_.packed, sizes_.pass),
          DeformationMaskInterface{.SCALED = model_.packed.scalesSpread(),
                                   .LAW_0 = model_.law.taxel_parameters[0],
                                   .MASK_SOURCES = model_.numMaskSources(),
                                   .TEAM = sizes_.team,
                                   .PARTIALS = sizes_.numPartials(1),
                                   .OUTPUT_RESPONSE = with_response}};
}

}  // namespace taxelsim
