#include "simulation/passes/tile_plan.h"

#include <algorithm>
#include <string>

#include "shared/batch.h"
#include "shared/model.h"
#include "taxelsim/error.h"

namespace taxelsim {
namespace {

// Samples of a tile: more would leave a GPU's core too few workgroups.
constexpr std::uint32_t kMaxTileSamples = 6144;
// Largest shared memory of a pass in addition to the tile, in bytes: partial sums, planes and lists, for clusters of kGroupsPerBatch
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

TilePlan::TilePlan(const ModelData& model, const ModelOptions& options, const Tuning& tuning) : model_(model) {
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

std::uint32_t TilePlan::mostInSequence() const {
  return model_.packed.tiles.size() > 1 ? kMaxTileRepeat : kMaxRepeat;
}

std::uint32_t TilePlan::repeatFor(std::uint32_t kinds) const {
  return tunedRepeat(tuned_repeat_, model_.profile.itemsInSequence(iterationsOf(model_, kinds) / sizes_.workgroup, mostInSequence()),
                     "tuning.contact_repeat");
}

// Not in small batches, where the second dispatch takes more time than it saves.
bool TilePlan::leavesTiles(std::uint64_t num_instances) const {
  constexpr std::uint64_t kMinTiles = 256;
  return model_.leaves_tiles && tuned_repeat_ == 0 && sizes_.repeat < mostInSequence() &&
         num_instances * model_.contact_packed.tiles.size() >= kMinTiles;
}

std::uint32_t TilePlan::repeatOfLists(std::uint64_t num_instances) const {
  return leavesTiles(num_instances) ? mostInSequence() : sizes_.repeat;
}

// Lists count workgroups of repeatOfLists(). A load search in a tile takes all the iterations that a workgroup may.
PassSizes TilePlan::sizesOf(const DepthVariant& variant, bool leaves_tiles) const {
  PassSizes sizes = sizes_;
  if (variant.kinds != 0 && variant.list == layout::kNumLists) sizes.repeat = repeatFor(variant.kinds);
  if (leaves_tiles) sizes.repeat = mostInSequence();
  if (variant.search == DepthInterface::kSearchInTile) sizes.repeat = 1;
  return sizes;
}

std::uint32_t TilePlan::kindsOf(const DepthVariant& variant) const {
  if (variant.list == layout::kListCandidates) return 1u << layout::kKindMesh;
  return variant.kinds != 0 ? variant.kinds : model_.object_kinds.kinds;
}

DepthInterface TilePlan::depthInterface(const DepthVariant& variant, bool variation) const {
  return {.TILE_SAMPLES = model_.contact_packed.max_tile_samples,
          .FLAT = model_.contact_packed.flat,
          .SEARCH = variant.search,
          .THICKNESS = model_.sensor.skin.thickness,
          .MANY_SLOTS = variant.many_slots,
          .OBJECT_KINDS = kindsOf(variant),
          .TRIANGLE_SIZES = triangleSizes(model_.object_kinds, variant.area),
          .NUM_FACES = model_.object_kinds.num_faces,
          .GROUPS_PER_BATCH = groups_per_batch_,
          .LIST = variant.list,
          .AREA = variant.area,
          .VARIATION = variation,
          .KEEPS_SLOTS = variant.keeps_slots};
}

}  // namespace taxelsim
