#include "simulation/passes/contact.h"

#include <algorithm>

#include "contact_variants.h"

namespace taxelsim {

void ContactPass::record(Recorder recorder, Variant variant) const {
  const DepthVariant& depth = variant.depth;
  variant.leaves_tiles = depth.search == DepthInterface::kNoSearch && (tiles_.kindsOf(depth) & (1u << layout::kKindMesh)) != 0 &&
                         tiles_.leavesTiles(recorder.num_instances);
  if (model_.hasMask()) recorder.bindings.redirect<block::SpreadScale, block::MaskScale>();
  recorder.bindings.redirect<block::PastState, block::State>();
  recorder.bindings.redirect<block::ResultFours, block::TileResults>();
  const Kernel& kernel = kernels_.get(variant, [&] { return makeKernel(variant); });
  if (variant.leaves_tiles) recorder.copyWorkRows(layout::kLeftTiles, layout::kLeftTiles, 2);
  tiles_.dispatch(recorder, kernel, depth.list, tiles_.sizesOf(depth, variant.leaves_tiles).repeat);
  if (!variant.leaves_tiles) return;
  recorder.commands.barrier(gpu::Access::kKernel, gpu::Access::kIndirect);
  recorder.copyWorkRows(layout::kNumWorkRows, layout::kSecondDispatch, 1);
  recorder.dispatchOverList(kernel, layout::kLeftTiles);
}

ContactPass::Kernel ContactPass::makeKernel(const Variant& variant) const {
  const Skin& skin = model_.sensor.skin;
  const PackedLaw& law = model_.law;
  // Taxel passes that compute forces apply the scale of the spread themselves.
  const bool taxels_follow = std::any_of(law.taxel_passes.begin(), law.taxel_passes.end(),
                                         [](const TaxelPass& pass) { return pass.owner != TaxelPass::Owner::kTile; });
  // A search over tiles leaves the state of the samples alone under friction or relaxation; its last evaluation, kSearchEnded, updates it.
  const bool only_searches = model_.hasFriction() && variant.depth.search == DepthInterface::kSearchOverTiles;
  const bool friction = model_.hasFriction() && !only_searches;
  DepthVariant depth = variant.depth;
  depth.keeps_slots = depth.keeps_slots && friction;
  const ContactInterface constants{
      .depth = tiles_.depthInterface(depth, depth.area && (friction || law.parameters[1] != 1)),
      .HAS_STATE = law.has_state && !only_searches,
      .SCALED = model_.hasMask() ? model_.packed.one_grid : model_.packed.scalesSpread() && !taxels_follow,
      .OUTPUT_DEPTH = variant.with_depth,
      .STIFFNESS = law.parameters[0],
      .EXPONENT = law.parameters[1],
      .DAMPING = law.parameters[2],
      .FRICTION = friction,
      .TANGENTIAL_STIFFNESS = skin.friction.tangential_stiffness,
      .FRICTION_COEFFICIENT = skin.friction.friction_coefficient,
      .OUTPUT_SHEAR = friction && variant.with_shear,
      .BRISTLES = friction && law.has_bristles,
      .BRISTLE_STIFFNESS = law.bristles[0],
      .BRISTLE_DAMPING = law.bristles[1],
      .VISCOUS_FRICTION = law.bristles[2],
      .STATIC_FRICTION = law.bristles[3],
      .COULOMB_FRICTION = law.bristles[4],
      .STRIBECK_VELOCITY = law.bristles[5],
      .RELAXATION = skin.relaxation.size(),
      .OUTPUT_JACOBIAN = variant.with_jacobian,
      .EARLY_EXIT = model_.profile.paths().untouched,
      .IS_LAST = law.taxel_passes.empty(),
      .RANDOM_SKIN = variant.random_skin,
      .NUM_STATES = model_.numSampleStates(),
      .SELECTS_KINDS = tiles_.kindsOf(depth) != model_.object_kinds.kinds && depth.list != layout::kListCandidates,
      .MOST_ITERATIONS = variant.leaves_tiles ? gpu::kMaxIterations : 0,
      .OUTPUT_WRENCH_CHANGE = variant.with_jacobian && variant.with_wrench,
  };
  const PassSizes sizes = tiles_.sizesOf(depth, variant.leaves_tiles);
  return {model_.context(), "contact", model_.profile.select(k_contact_variants, sizes.workgroup),
          commonConstants(model_.contact_sensor, model_.contact_packed, sizes), constants};
}

}  // namespace taxelsim
