#include "simulation/passes/candidates.h"

#include "find_candidates_variants.h"
#include "keep_candidates_variants.h"
#include "shared/batch.h"

namespace taxelsim {

void CandidatePasses::record(Recorder& recorder, bool with_jacobian) const {
  const Variant variant{with_jacobian, tiles_.repeatOfLists(recorder.num_instances)};
  const Kernels& kernels = kernels_.get(variant, [&] { return makeKernels(variant); });
  gpu::Commands& commands = recorder.commands;
  recorder.copyWorkRows(0, 0, layout::kNumLists + 1);
  recorder.dispatch(kernels.keep, numWorkgroups(recorder.num_instances, gpu::DriverProfile::kIndependentWorkgroup));
  commands.barrier(gpu::Access::kKernel, gpu::Access::kIndirect);
  recorder.dispatchOverList(kernels.find, layout::kListFindCandidates);
  commands.barrier(gpu::Access::kKernel, gpu::Access::kIndirect);
}

CandidatePasses::Kernels CandidatePasses::makeKernels(const Variant& variant) const {
  const PassSizes& sizes = tiles_.sizes();
  const auto common = [&](std::uint32_t workgroup) {
    return commonConstants(model_.contact_sensor, model_.contact_packed, {workgroup, sizes.lanes, sizes.repeat});
  };
  return {.keep = {model_.context(), "keep_candidates", model_.profile.select(k_keep_candidates_variants, gpu::DriverProfile::kNoneWaits),
                   common(gpu::DriverProfile::kIndependentWorkgroup),
                   KeepCandidatesInterface{.FLAT = model_.contact_packed.flat,
                                           .OUTPUT_JACOBIAN = variant.with_jacobian,
                                           .REACH = model_.law.reach,
                                           .LISTED_PER_WORKGROUP = variant.listed_per_workgroup,
                                           .AREA = model_.area(),
                                           .FOUND_PER_WORKGROUP = sizes.repeat}},
          .find = {model_.context(), "find_candidates", model_.profile.select(k_find_candidates_variants, sizes.workgroup),
                   common(sizes.workgroup),
                   FindCandidatesInterface{.FLAT = model_.contact_packed.flat,
                                           .OUTPUT_JACOBIAN = variant.with_jacobian,
                                           .REACH = model_.law.reach,
                                           .GROUPS_PER_BATCH = tiles_.groupsPerBatch(),
                                           .AREA = model_.area(),
                                           .LISTED_PER_WORKGROUP = variant.listed_per_workgroup}}};
}

}  // namespace taxelsim
