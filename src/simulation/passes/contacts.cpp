#include "simulation/passes/contacts.h"

#include "contacts_variants.h"

namespace taxelsim {

void ContactsPass::record(Recorder& recorder, int max_contacts) const {
  const TeamSizes& sizes = image_.sizes();
  const std::uint64_t iterations =
      model_.num_taxels / sizes.team + model_.packed.tiles.size() + static_cast<std::uint64_t>(max_contacts) * model_.sensor.patches.size();
  const std::uint32_t repeat = model_.profile.itemsInSequence(iterations, kMaxRepeat);
  recorder.dispatch(kernels_.get(repeat, [&] { return makeKernel(repeat); }),
                    numWorkgroups(recorder.num_instances, sizes.pass.workgroup / sizes.team * repeat));
}

ContactsPass::Kernel ContactsPass::makeKernel(std::uint32_t repeat) const {
  constexpr std::uint32_t kNoLanes = 1;  // no sum crosses invocations
  return {model_.context(), "contacts", model_.profile.select(k_contacts_variants, gpu::DriverProfile::kNoneWaits),
          commonConstants(model_.sensor, model_.packed, {image_.sizes().pass.workgroup, kNoLanes, repeat}),
          ContactsInterface{.NUM_PATCHES = model_.sensor.patches.size(),
                            .FLAT = model_.packed.flat,
                            .THICKNESS = model_.sensor.skin.thickness,
                            .SCALED = model_.packed.scalesSpread(),
                            .TEAM = image_.sizes().team}};
}

}  // namespace taxelsim
