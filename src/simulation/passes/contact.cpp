#include "simulation/passes/contact.h"

#include <algorithm>
#include <string>

#include "shared/iterations.h"
#include "taxelsim/error.h"

namespace taxelsim {
namespace {

// Samples of a tile: more would leave a GPU's core too few workgroups.
constexpr std::uint32_t kMaxTileSamples = 6144;
// Largest shared memory of the pass in addition to the tile, in bytes: partial sums, planes and lists, for clusters of kGroupsPerBatch
// groups and kMaxRepeat tiles.
constexpr std::uint32_t kTileOverhead = 7424;
constexpr std::uint32_t kGroupsPerBatch = 32;
constexpr std::uint32_t kMinGroupsPerBatch = 16;
constexpr std::uint32_t kMaxGroupsPerBatch = 128;

// Bytes of shared memory per sample of a tile: shaders/depth/tile_heights.glsl, solid_cells.glsl.
constexpr std::uint32_t bytesPerSample(bool area, bool variation) {
  return (area ? 17 : 4) + (variation ? 16 : 0);
}

std::uint32_t sharedBytes(const ModelData& model, std::uint32_t groups, std::uint32_t repeat) {
  const std::uint32_t more_groups = std::max(groups, kGroupsPerBatch) - kGroupsPerBatch;
  const std::uint32_t more_tiles = std::max(repeat, kMaxRepeat) - kMaxRepeat;
  return bytesPerSample(model.area(), model.variation()) * model.contact_packed.max_tile_samples + kTileOverhead +
         4 * more_groups * (layout::kClustersPerGroup + 1) + 4 * more_tiles;
}

void checkFits(const ModelData& model, std::uint32_t groups, std::uint32_t repeat) {
  const std::uint32_t bytes = sharedBytes(model, groups, repeat);
  const std::uint32_t most = model.device.info().shared_memory;
  if (bytes <= most) return;
  throw Error(ErrorKind::kInput, "tuning: groups_per_batch " + std::to_string(groups) + " with contact_repeat " + std::to_string(repeat) +
                                     " is not allowed: takes up to " + std::to_string(bytes) + " bytes of shared memory, the device has " +
                                     std::to_string(most));
}

std::uint32_t chooseGroupsPerBatch(const ModelData& model) {
  std::uint32_t groups = kGroupsPerBatch;
  if (!model.profile.prefersFewBarriers()) return groups;
  // As many groups as a mesh has, if their lists and the tile fit into shared memory.
  while (groups < std::min(kMaxGroupsPerBatch, model.object_kinds.max_groups) &&
         sharedBytes(model, 2 * groups, 1) <= model.device.info().shared_memory) {
    groups *= 2;
  }
  return groups;
}

// Loop iterations that one invocation alone would take for a tile and objects of these kinds.
std::uint64_t iterationsOf(const ModelData& model, std::uint32_t kinds) {
  const bool has_torus = (kinds & (1u << layout::kKindTorus)) != 0;
  const std::uint64_t per_ray = has_torus ? layout::kIterationsPerSampleOfTorus : layout::kIterationsPerSample;
  const std::uint64_t num_triangles = (kinds & (1u << layout::kKindMesh)) != 0 ? model.object_kinds.max_triangles : 0;
  const std::uint64_t num_samples = model.contact_packed.max_tile_samples;
  if (model.area()) return layout::kIterationsPerTriangleOfCells * num_triangles + layout::kIterationsPerCell * num_samples;
  return layout::kIterationsPerTriangle * num_triangles + per_ray * num_samples;
}

// Without area sampling closed meshes are drawn as others.
std::uint32_t triangleSizes(const ObjectKinds& kinds, bool area) {
  return area ? kinds.triangle_sizes : (kinds.triangle_sizes | kinds.triangle_sizes >> 2) & 3u;
}

}  // namespace

std::uint32_t maxTileSamples(const DeviceInfo& info, bool area, bool variation) {
  return std::min(kMaxTileSamples, (info.shared_memory - kTileOverhead) / bytesPerSample(area, variation));
}

ContactPass::ContactPass(const ModelData& model, const ModelOptions& options, const Tuning& tuning) : model_(model) {
  const std::uint64_t iterations = iterationsOf(model, model.object_kinds.kinds);
  sizes_.workgroup = tunedWorkgroup(options.contact_workgroup, model.profile, iterations, "contact_workgroup");
  sizes_.lanes = model.contact_packed.contact_lanes;
  tuned_repeat_ = tuning.contact_repeat;
  sizes_.repeat = repeatFor(model.object_kinds.kinds);
  groups_per_batch_ =
      tunedSize(tuning.groups_per_batch, chooseGroupsPerBatch(model), kMinGroupsPerBatch, kMaxGroupsPerBatch, "tuning.groups_per_batch");
  if (tuning.groups_per_batch != 0 || tuning.contact_repeat != 0) {
    checkFits(model, groups_per_batch_, sizes_.repeat);
  }
}

std::uint32_t ContactPass::mostInSequence() const {
  return model_.packed.tiles.size() > 1 ? kMaxTileRepeat : kMaxRepeat;
}

std::uint32_t ContactPass::repeatFor(std::uint32_t kinds) const {
  return tunedRepeat(tuned_repeat_, model_.profile.itemsInSequence(iterationsOf(model_, kinds) / sizes_.workgroup, mostInSequence()),
                     "tuning.contact_repeat");
}

// Not in small batches, where the second dispatch takes more time than it saves.
bool ContactPass::leavesTiles(std::uint64_t num_instances) const {
  constexpr std::uint64_t kMinTiles = 256;
  return model_.leaves_tiles && tuned_repeat_ == 0 && sizes_.repeat < mostInSequence() &&
         num_instances * model_.contact_packed.tiles.size() >= kMinTiles;
}

std::uint32_t ContactPass::repeatOfLists(std::uint64_t num_instances) const {
  return leavesTiles(num_instances) ? mostInSequence() : sizes_.repeat;
}

// A load search in a tile takes all the iterations that a workgroup may. Lists count workgroups of repeatOfLists().
std::uint32_t ContactPass::repeatOf(const Variant& variant) const {
  if (variant.search == ContactInterface::kSearchInTile) return 1;
  if (variant.leaves_tiles) return mostInSequence();
  return variant.kinds == 0 || variant.list != layout::kNumLists ? sizes_.repeat : repeatFor(variant.kinds);
}

void ContactPass::record(Recorder recorder, Variant variant) const {
  const std::uint32_t kinds = variant.kinds != 0 ? variant.kinds : model_.object_kinds.kinds;
  variant.leaves_tiles =
      variant.search == ContactInterface::kNoSearch && (kinds & (1u << layout::kKindMesh)) != 0 && leavesTiles(recorder.num_instances);
  if (model_.layer) {
    recorder.bindings.redirect<block::ContactNormal, block::Heights>();
    recorder.bindings.redirect<block::TileResults, block::Windows>();
  }
  if (model_.hasMask()) recorder.bindings.redirect<block::SpreadScale, block::MaskScale>();
  recorder.bindings.redirect<block::PastState, block::State>();
  recorder.bindings.redirect<block::ResultFours, block::TileResults>();
  const Kernel& kernel = kernels_.get(variant, [&] { return makeKernel(variant); });
  if (variant.leaves_tiles) recorder.copyWorkRows(layout::kLeftTiles, layout::kLeftTiles, 2);
  if (variant.list == layout::kNumLists) {
    recorder.dispatch(kernel, numWorkgroups(recorder.num_instances * model_.contact_packed.tiles.size(), repeatOf(variant)));
  } else {
    recorder.dispatchOverList(kernel, variant.list);
  }
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
  const bool only_searches = model_.hasFriction() && variant.search == ContactInterface::kSearchOverTiles;
  const bool friction = model_.hasFriction() && !only_searches;
  const bool area = model_.area() && (!model_.layer || variant.cells);
  std::uint32_t kinds = variant.kinds != 0 ? variant.kinds : model_.object_kinds.kinds;
  if (variant.list == layout::kListCandidates) kinds = 1u << layout::kKindMesh;
  const ContactInterface constants{
      .TILE_SAMPLES = model_.contact_packed.max_tile_samples,
      .FLAT = model_.contact_packed.flat,
      .HAS_STATE = law.has_state && !only_searches,
      .SEARCH = variant.search,
      .THICKNESS = skin.thickness,
      .SCALED = model_.hasMask() ? model_.packed.one_grid : model_.packed.scalesSpread() && !taxels_follow && !model_.layer,
      .MANY_SLOTS = variant.many_slots,
      .OBJECT_KINDS = kinds,
      .TRIANGLE_SIZES = triangleSizes(model_.object_kinds, area),
      .OUTPUT_DEPTH = variant.with_depth,
      .NUM_FACES = model_.object_kinds.num_faces,
      .LAW_0 = law.parameters[0],
      .LAW_1 = law.parameters[1],
      .LAW_2 = law.parameters[2],
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
      .RELAXATION = model_.layer ? 0 : skin.relaxation.size(),
      .GROUPS_PER_BATCH = groups_per_batch_,
      .OUTPUT_JACOBIAN = variant.with_jacobian,
      .EARLY_EXIT = model_.profile.paths().untouched,
      .REACH = law.reach,
      .LIST = variant.list,
      .IS_LAST = law.taxel_passes.empty(),
      .AREA = area,
      .RANDOM_SKIN = variant.random_skin,
      .VARIATION = area && (model_.layer || friction || law.parameters[1] != 1),
      .KEEPS_SLOTS = variant.keeps_slots,
      .HAS_CELLS = model_.layer && model_.area(),
      .NUM_STATES = model_.numSampleStates(),
      .SELECTS_KINDS = kinds != model_.object_kinds.kinds && variant.list != layout::kListCandidates,
      .MOST_ITERATIONS = variant.leaves_tiles ? gpu::kMaxIterations : 0,
      .OUTPUT_WRENCH_CHANGE = variant.with_jacobian && variant.with_wrench,
  };
  const PassSizes sizes{sizes_.workgroup, sizes_.lanes, repeatOf(variant)};
  return {model_.context(), law.kernel, model_.profile.select(law.spirv, sizes.workgroup),
          commonConstants(model_.contact_sensor, model_.contact_packed, sizes), constants};
}

}  // namespace taxelsim
