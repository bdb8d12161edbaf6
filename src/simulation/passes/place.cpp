#include "simulation/passes/place.h"

#include "base/constants.h"
#include "place.spv.h"
#include "simulation/passes/load_search.h"
#include "simulation/passes/sizes.h"
#include "taxelsim/contact_point.h"

namespace taxelsim {

void PlacePass::record(Recorder& recorder, const Variant& variant, const layout::SkinBase& base) const {
  recorder.commands.fillZero(recorder.bindings.buffer<block::InputProblems>());
  recorder.commands.barrier(gpu::Access::kCopy, gpu::Access::kKernel);
  recorder.dispatch(kernels_.get(variant, [&] { return makeKernel(variant, base); }),
                    numWorkgroups(recorder.num_instances, gpu::DriverProfile::kIndependentWorkgroup));
}

gpu::PassKernel<PlaceInterface> PlacePass::makeKernel(const Variant& variant, const layout::SkinBase& base) const {
  const LoadReach reach = loadReach(model_);
  return {model_.context(), "place", k_place_spirv,
          commonConstants(model_.sensor, model_.packed, {.workgroup = gpu::DriverProfile::kIndependentWorkgroup}),
          PlaceInterface{.SLOTS = variant.num_slots,
                         .NUM_OBJECTS = static_cast<std::uint32_t>(model_.objects.size()),
                         .LOADS = variant.loads,
                         .FRICTION = model_.hasFriction(),
                         .BASE_X = base.normal_lowest.x,
                         .BASE_Y = base.normal_lowest.y,
                         .BASE_Z = base.normal_lowest.z,
                         .BASE_LOWEST = base.normal_lowest.w,
                         .BASE_ORIGIN = base.origin.x,
                         .OVER_TILES = variant.loads && !model_.layer && !model_.packed.searches_in_tile,
                         .HIGHEST = reach.highest,
                         .LOWEST = reach.lowest,
                         .CLEARANCE = reach.clearance,
                         .FIRST_STEP = reach.first_step,
                         .CONTACTS = variant.max_contacts,
                         .LENGTH_TOLERANCE = kQuaternionTolerance,
                         .MOST_COORDINATE = kMaxContactCoordinate,
                         .MOST_FORCE = kMaxContactForce}};
}

}  // namespace taxelsim
