#include "simulation/model_data.h"

#include <algorithm>
#include <limits>
#include <utility>

#include "gpu/device_access.h"
#include "shared/batch.h"
#include "simulation/passes/tile_plan.h"
#include "taxelsim/error.h"

namespace taxelsim {
namespace {

SampleGrid sampleGrid(const Sensor& sensor, const PackedSensor& packed) {
  double finest = std::numeric_limits<double>::infinity();
  for (const GridPatch& patch : sensor.patches) finest = std::min({finest, patch.pitch[0], patch.pitch[1]});
  std::uint32_t longest = 0;
  for (const layout::TileRecord& tile : packed.tiles) longest = std::max({longest, tile.size.x, tile.size.y});
  const auto per_taxel = static_cast<std::uint32_t>(sensor.samples_per_taxel);
  return {finest / per_taxel, longest * per_taxel};
}

// An object's bounds in O with infinite ones cut, for the bracket of the load search.
layout::LoadBoundsRecord loadBounds(const Object& object) {
  const double reach = std::holds_alternative<Mesh>(object.shape) ? std::numeric_limits<double>::infinity() : 1;  // m
  const Bounds bounds = boundsOf(object);
  layout::LoadBoundsRecord record{};
  for (int axis = 0; axis < 3; ++axis) {
    const double low = std::max(bounds.min[axis], -reach), high = std::min(bounds.max[axis], reach);
    record.center[axis] = static_cast<float>(low + high) / 2;
    record.half_size[axis] = static_cast<float>(high - low) / 2;
  }
  return record;
}

ObjectKinds kindsOf(const std::vector<Object>& objects, const PackedObjects& packed) {
  ObjectKinds kinds;
  kinds.num_faces = packed.num_faces;
  for (const Object& object : objects) {
    if (const Mesh* mesh = std::get_if<Mesh>(&object.shape))
      kinds.max_triangles = std::max<std::uint64_t>(kinds.max_triangles, mesh->triangles.size());
  }
  for (const layout::ObjectRecord& record : packed.objects) {
    kinds.kinds |= 1u << record.kind_groups.x;
    if (record.kind_groups.x != layout::kKindMesh) continue;
    kinds.max_groups = std::max(kinds.max_groups, record.kind_groups.z);
    const std::uint32_t flags = record.kind_groups.w;
    // Boxes and tori have triangles for area sampling.
    constexpr std::uint64_t kTrianglesPerGroup = 2ull * layout::kClustersPerGroup * layout::kQuadsPerCluster;
    if ((flags & layout::kClosed) != 0) kinds.max_triangles = std::max(kinds.max_triangles, record.kind_groups.z * kTrianglesPerGroup);
    kinds.triangle_sizes |= ((flags & layout::kLargeTriangles) != 0 ? 2u : 1u) << ((flags & layout::kClosed) != 0 ? 2 : 0);
  }
  return kinds;
}

// Meshes, polyhedra and solids: what the contact pass needs for one of them makes it slower for the others.
std::vector<std::uint32_t> passesOf(std::uint32_t kinds) {
  constexpr std::uint32_t kMeshes = 1u << layout::kKindMesh, kPolyhedra = 1u << layout::kKindPolyhedron;
  std::vector<std::uint32_t> passes{kinds & kMeshes, kinds & kPolyhedra, kinds & ~(kMeshes | kPolyhedra)};
  std::erase(passes, 0u);
  return passes;
}

void uploadObjects(const PackedObjects& packed, ModelBuffers& buffers) {
  buffers.upload<block::Objects>("objects", packed.objects);
  buffers.upload<block::Groups>("groups", packed.groups);
  buffers.upload<block::Clusters>("clusters", packed.clusters);
  buffers.upload<block::Quads>("triangles", packed.quads);
  buffers.upload<block::Faces>("faces", packed.faces);
}

void uploadSensor(const ModelData& model, ModelBuffers& buffers) {
  const PackedSensor& packed = model.packed;
  buffers.upload<block::SensorBlock>("sensor", {packed.sensor});
  buffers.upload<block::Patches>("patches", model.contact_packed.patches);
  buffers.upload<block::Tiles>("tiles", model.contact_packed.tiles);
  buffers.upload<block::Taxels>("taxels", packed.taxels);
  buffers.upload<block::SpreadRows>("spread rows", packed.spread_rows);
  buffers.upload<block::SpreadScale>("spread scale", packed.spread_scale);
  buffers.upload<block::Mask>("mask", model.mask.empty() ? std::vector<glm::vec2>(2) : model.mask);
  const bool scales_mask = model.hasMask() && packed.one_grid;
  buffers.upload<block::MaskScale>("mask scale", scales_mask ? packMaskScale(model.sensor) : std::vector<float>(1));
  buffers.upload<block::Planes>("planes", model.packed_contact.planes);
  buffers.upload<block::Neighbours>("neighbours", model.packed_contact.neighbours);
  std::vector<float> triggers;
  for (const layout::TaxelRecord& taxel : packed.taxels) triggers.push_back(taxel.readout.y);
  triggers.resize((triggers.size() + 3) / 4 * 4);
  buffers.upload<block::Triggers>("triggers", triggers);
  buffers.upload<block::FeatureSource>("feature source", {0});
  buffers.upload<block::CleanFeatureSource>("feature source of clean forces", {1});
  if (model.layer) buffers.upload<block::Influence>("influence", model.layer->influence);
}

}  // namespace

void ModelBuffers::upload(std::size_t block_index, const char* name, std::span<const std::byte> bytes) {
  gpu::Buffer buffer = gpu::makeStaticBuffer(gpu::contextOf(device_), name, bytes);
  const std::uint64_t max_buffer = device_.info().max_buffer;
  if (buffer.size() > max_buffer) {
    throw Error(ErrorKind::kInput, std::string(name) + " take " + std::to_string(buffer.size()) + " bytes, the device's buffers hold " +
                                       std::to_string(max_buffer) + "; use simpler meshes or another device");
  }
  bytes_ += buffer.size();
  buffers_[block_index] = std::move(buffer);
}

void ModelBuffers::bindTo(gpu::Bindings& bindings) const {
  for (std::size_t index = 0; index < buffers_.size(); ++index) {
    if (buffers_[index].size() > 0) bindings.bind(index, buffers_[index]);
  }
}

ModelData::ModelData(const Device& opened, const ModelOptions& options)
    : device(opened),
      profile(opened.info(), gpu::contextOf(opened).wideNumbers(), gpu::fastPaths()),
      sensor((checkSensor(options.sensor), options.sensor)),
      objects(options.objects),
      buffers(opened) {
  for (const Object& object : objects) {
    checkObject(object);
    load_bounds.push_back(loadBounds(object));
  }
  const std::uint32_t tile_samples = maxTileSamples(device.info(), area(), variation());
  if (std::holds_alternative<ElasticLayer>(sensor.skin.law)) layer = packLayer(sensor);
  // An elastic layer is cut into tiles only where its heights are found.
  packed = packSensor(sensor, layer ? std::numeric_limits<std::uint32_t>::max() : tile_samples);
  contact_sensor = layer ? layer->node_sensor : sensor;
  contact_packed = layer ? packSensor(contact_sensor, tile_samples) : packed;
  law = packLaw(sensor.skin, layer ? layer->reach : 0);
  packed_contact = packContactFeatures(sensor);
  num_taxels = static_cast<std::uint32_t>(numTaxels(sensor));
  if (hasMask()) mask = packMask(sensor);

  const Shapes shapes = area() ? Shapes::kOutward : profile.paths().polyhedra ? Shapes::kPolyhedra : Shapes::kMeshes;
  PackedObjects packed_objects = packObjects(objects, sampleGrid(contact_sensor, contact_packed), shapes);
  object_kinds = kindsOf(objects, packed_objects);
  if (profile.paths().kinds) object_kinds.passes = passesOf(object_kinds.kinds);
  uploadObjects(packed_objects, buffers);
  object_records = std::move(packed_objects.objects);
  uploadSensor(*this, buffers);
  buffers.upload<block::LoadBounds>("bounds of objects", load_bounds);
  keeps_candidates = profile.paths().candidates && object_kinds.max_groups >= layout::kMinGroups && contact_packed.one_grid &&
                     contact_packed.tiles.size() == 1;
  leaves_tiles = profile.paths().sequences && profile.limitsIterations() && object_kinds.max_triangles > 0 && !layer;
  if (keeps_candidates || leaves_tiles) {
    std::vector<glm::uvec4> empty(layout::kNumWorkRows + 1, glm::uvec4(0, 1, 1, 0));
    empty[layout::kNumLists] = empty[layout::kSecondDispatch] = glm::uvec4(0);
    empty.back() = glm::uvec4(1, 0, 0, 0);  // of the second dispatch
    buffers.upload<block::EmptyWork>("empty work lists", empty);
  }
}

gpu::Context& ModelData::context() const {
  return gpu::contextOf(device);
}

std::uint32_t ModelData::numSampleStates() const {
  if (layer) return 0;
  const auto terms = static_cast<std::uint32_t>(sensor.skin.relaxation.size());
  const std::uint32_t points = variation() ? 2 : 1;  // of a sample, shaders/skin/law.glsl
  return (terms > 0 ? 1 + terms : 0) + (hasFriction() ? 2 * points : 0) + (law.has_state ? 1 : 0);
}

}  // namespace taxelsim
