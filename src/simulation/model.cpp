#include <algorithm>
#include <bit>
#include <cstdint>
#include <limits>
#include <span>

#include "contacts.spv.h"
#include "elastic_layer.spv.h"
#include "elastic_layer_lockstep.spv.h"
#include "elastic_layer_pairs.spv.h"
#include "elastic_layer_pairs_lockstep.spv.h"
#include "find_candidates.spv.h"
#include "find_candidates_lockstep.spv.h"
#include "gpu/device_access.h"
#include "image.spv.h"
#include "keep_candidates.spv.h"
#include "load.spv.h"
#include "sensor/curve.h"
#include "shared/candidates.h"
#include "shared/elastic_layer.h"
#include "shared/objects.h"
#include "shared/sensor.h"
#include "simulation/model_access.h"
#include "simulation/model_impl.h"
#include "simulation/pack/pack_objects.h"
#include "simulation/workgroups.h"
#include "taxelsim/error.h"

namespace taxelsim {
namespace {

// Turns that one invocation alone would take for an elastic layer: two products of all strips with all others in some of the iterations,
// the window being a part of them, and one of the dents of a skin that relaxes.
std::uint64_t layerWork(const Sensor& sensor, const PackedLayer& layer) {
  const std::uint64_t strips = layer.influence.size() / (2 * layout::kStrip);
  const auto iterations = static_cast<std::uint64_t>(std::get<ElasticLayer>(sensor.skin.law).iterations);
  return strips * strips * ((sensor.skin.relaxation.empty() ? 10 : 20) + iterations) / 10;
}

// Partial sums of the pass over an elastic layer. A GPU's workgroup has one for each invocation; on a software driver every sum is read by
// every invocation and a fetch is dear, so there are no more than a vector has lanes, unless there is more work than for so many.
std::uint32_t layerLanes(const DeviceInfo& info, std::uint64_t work) {
  constexpr std::uint64_t kFewest = 8, kMost = 256;
  if (info.type != DeviceType::kCpu) return 64;
  return static_cast<std::uint32_t>(std::clamp(std::bit_ceil(work / kMaxTurns), kFewest, kMost));
}

// Turns per taxel that stage 4 and imperfections add to the image pass: elements, terms, and the rounds of each draw.
std::uint64_t turnsOfTime(const Readout& readout) {
  constexpr std::uint64_t kRounds = 10;
  const auto draws = static_cast<std::uint64_t>((readout.bias > 0) + (readout.random_walk > 0) + (readout.dead_taxel_probability > 0));
  return readout.hysteresis_strength.size() + readout.creep.size() + kRounds * draws;
}

SampleGrid sampleGrid(const Sensor& sensor, const PackedSensor& packed) {
  double finest = std::numeric_limits<double>::infinity();
  for (const GridPatch& patch : sensor.patches) finest = std::min({finest, patch.pitch[0], patch.pitch[1]});
  std::uint32_t longest = 0;
  for (const layout::TileRecord& tile : packed.tiles) longest = std::max({longest, tile.size.x, tile.size.y});
  const auto per_taxel = static_cast<std::uint32_t>(sensor.samples_per_taxel);
  return {finest / per_taxel, longest * per_taxel};
}

// An object's bounds in O with the endless ones cut, for the bracket of the load search.
Bounds cutBounds(const Object& object) {
  constexpr double kReach = 1;  // m
  Bounds bounds = boundsOf(object);
  for (std::size_t axis = 0; axis < 3; ++axis) {
    bounds.min[axis] = std::max(bounds.min[axis], -kReach);
    bounds.max[axis] = std::min(bounds.max[axis], kReach);
  }
  return bounds;
}

}  // namespace

Model::Impl::Impl(const Device& of, const ModelOptions& options, const Tuning& tuning)
    : device(of), sensor(options.sensor), objects(options.objects) {
  checkSensor(sensor);
  for (const Object& object : objects) {
    checkObject(object);
    bounds.push_back(std::holds_alternative<Mesh>(object.shape) ? boundsOf(object) : cutBounds(object));
  }
  const DeviceInfo& info = device.info();
  num_taxels = static_cast<std::uint32_t>(numTaxels(sensor));
  const std::uint32_t tile_samples = mostTileSamples(info);
  if (std::holds_alternative<ElasticLayer>(sensor.skin.law)) layer = packLayer(sensor);
  // An elastic layer is cut into tiles only where its heights are found.
  packed = packSensor(sensor, layer ? std::numeric_limits<std::uint32_t>::max() : tile_samples);
  contact_sensor = layer ? layer->node_sensor : sensor;
  contact_packed = layer ? packSensor(contact_sensor, tile_samples) : packed;
  packed_contact = packContactFeatures(sensor);
  law = packLaw(sensor.skin, layer ? layer->reach : 0);

  std::uint64_t most_triangles = 0;
  for (const Object& object : objects) {
    if (const Mesh* mesh = std::get_if<Mesh>(&object.shape))
      most_triangles = std::max<std::uint64_t>(most_triangles, mesh->triangles.size());
  }
  const bool has_torus =
      std::any_of(objects.begin(), objects.end(), [](const Object& o) { return std::holds_alternative<Torus>(o.shape); });
  constexpr std::uint64_t kTurnsOfTorus = 48;  // per sample, of at most 96
  const std::uint64_t contact_work = 2 * most_triangles + contact_packed.max_tile_samples * (has_torus ? kTurnsOfTorus : 3);
  contact_workgroup = chooseWorkgroup(options.contact_workgroup, info, 64, contact_work, "contact_workgroup");
  if (layer) {
    layer_workgroup = chooseWorkgroup(options.contact_workgroup, info, 64, layerWork(sensor, *layer), "contact_workgroup");
  }
  const std::uint64_t sources = packed.one_grid ? static_cast<std::uint64_t>(sensor.psf.size * sensor.psf.size) : packed.num_entries;
  const std::uint64_t image_work = num_taxels * (sources + (isStraight(sensor.readout) ? 8 : 64) + turnsOfTime(sensor.readout));
  image_workgroup_wanted = options.image_workgroup;
  image_workgroup = chooseWorkgroup(options.image_workgroup, info, 64, image_work, "image_workgroup");
  // On a software driver every invocation has an instance of its own, unless that would be too many turns for it.
  const bool alone = faster.alone && info.type == DeviceType::kCpu && options.image_workgroup == 0 && image_work <= kMaxTurns;
  image_team =
      tunedSize(tuning.image_team, alone ? 1 : std::min(image_workgroup, packed.image_lanes), 1, image_workgroup, "tuning.image_team");
  image_partials = imagePartials(image_workgroup, image_team, packed.image_lanes);
  if (tuning.image_team != 0) checkImageFits(info, image_workgroup, image_team, image_partials);
  const std::uint32_t most_repeat = packed.tiles.size() > 1 ? kMaxTileRepeat : kMaxRepeat;
  contact_repeat =
      tunedRepeat(tuning.contact_repeat, chooseRepeat(info, contact_work / contact_workgroup, most_repeat), "tuning.contact_repeat");
  image_repeat = tunedRepeat(tuning.image_repeat, chooseRepeat(info, image_work / image_team), "tuning.image_repeat");

  gpu::Context& context = gpu::contextOf(device);
  const auto upload = [&]<typename T>(const char* name, const std::vector<T>& values) {
    gpu::Buffer buffer = gpu::makeStaticBuffer(context, name, std::span<const T>(values));
    static_bytes += buffer.size();
    if (buffer.size() > info.max_buffer) {
      throw Error(ErrorKind::kInput, std::string(name) + " take " + std::to_string(buffer.size()) + " bytes, the device's buffers hold " +
                                         std::to_string(info.max_buffer) + "; use simpler meshes or another device");
    }
    return buffer;
  };
  const PackedObjects packed_objects = packObjects(objects, sampleGrid(contact_sensor, contact_packed), faster.polyhedra);
  object_records = upload("objects", packed_objects.objects);
  groups = upload("groups", packed_objects.groups);
  clusters = upload("clusters", packed_objects.clusters);
  quads = upload("triangles", packed_objects.quads);
  faces = upload("faces", packed_objects.faces);
  num_faces = packed_objects.num_faces;
  sensor_record = upload("sensor", std::vector{packed.sensor});
  patches = upload("patches", contact_packed.patches);
  tiles = upload("tiles", contact_packed.tiles);
  taxels = upload("taxels", packed.taxels);
  spread_rows = upload("spread rows", packed.spread_rows);
  spread_scale = upload("spread scale", packed.spread_scale);
  mask = upload("mask", std::holds_alternative<DeformationMask>(sensor.skin.law) ? packMask(sensor) : std::vector<glm::vec2>(1));
  planes = upload("planes", packed_contact.planes);
  neighbours = upload("neighbours", packed_contact.neighbours);
  if (layer) influence = upload("influence", layer->influence);
  std::uint32_t most_groups = 0;
  for (const layout::ObjectRecord& record : packed_objects.objects) {
    kinds |= 1u << record.kind_groups.x;
    if (record.kind_groups.x == layout::kKindMesh) most_groups = std::max(most_groups, record.kind_groups.z);
    if (record.kind_groups.x == layout::kKindMesh) triangles_of |= (record.kind_groups.w & layout::kLargeTriangles) == 0 ? 1u : 2u;
  }
  const std::uint32_t most_samples = contact_packed.max_tile_samples;
  groups_per_batch = tunedSize(tuning.groups_per_batch, chooseGroupsPerBatch(info, most_samples, most_groups), kFewestGroupsPerBatch,
                               kMostGroupsPerBatch, "tuning.groups_per_batch");
  if (tuning.groups_per_batch != 0 || tuning.contact_repeat != 0) {
    checkContactFits(info, most_samples, groups_per_batch, contact_repeat);
  }
  keeps_candidates = faster.candidates && most_groups >= layout::kMinGroups && contact_packed.one_grid && contact_packed.tiles.size() == 1;
  if (keeps_candidates) {
    std::vector<glm::uvec4> start(layout::kNumLists + 1, glm::uvec4(0, 1, 1, 0));
    start.back() = glm::uvec4(0);
    no_work = upload("no work", start);
  }
}

const gpu::Kernel& Model::Impl::contactKernel(const ContactVariant& variant) const {
  const std::lock_guard lock(kernels_mutex_);
  const auto found = contact_.find(variant);
  if (found != contact_.end()) return found->second;
  return contact_.emplace(variant, makeContactKernel(variant)).first->second;
}

const Model::Impl::CandidatePasses& Model::Impl::candidatePasses(bool with_jacobian) const {
  const std::lock_guard lock(kernels_mutex_);
  const auto found = candidates_.find(with_jacobian);
  if (found != candidates_.end()) return found->second;
  return candidates_.emplace(with_jacobian, makeCandidatePasses(with_jacobian)).first->second;
}

const gpu::Kernel& Model::Impl::imageKernel(const ImageVariant& variant) const {
  const std::lock_guard lock(kernels_mutex_);
  const auto found = image_.find(variant);
  if (found != image_.end()) return found->second;
  return image_.emplace(variant, makeImageKernel(variant)).first->second;
}

std::uint32_t Model::Impl::contactsRepeat(int max_contacts) const {
  const std::uint64_t contact_turns = static_cast<std::uint64_t>(max_contacts) * sensor.patches.size();
  return chooseRepeat(device.info(), num_taxels / image_team + packed.tiles.size() + contact_turns);
}

const gpu::Kernel& Model::Impl::contactsKernel(std::uint32_t repeat) const {
  const std::lock_guard lock(kernels_mutex_);
  const auto found = contacts_.find(repeat);
  if (found != contacts_.end()) return found->second;
  return contacts_.emplace(repeat, makeContactsKernel(repeat)).first->second;
}

const gpu::Kernel& Model::Impl::loadKernel() const {
  const std::lock_guard lock(kernels_mutex_);
  if (!load_) load_ = makeLoadKernel();
  return *load_;
}

const gpu::Kernel& Model::Impl::layerKernel(const LayerVariant& variant) const {
  const std::lock_guard lock(kernels_mutex_);
  const auto found = layer_.find(variant);
  if (found != layer_.end()) return found->second;
  return layer_.emplace(variant, makeLayerKernel(variant)).first->second;
}

// The constants of shaders/common/specialization.glsl, then those of one pass, numbered in order.
std::vector<gpu::Constant> Model::Impl::constants(const Sensor& sensor, const PackedSensor& packed, const Sizes& sizes,
                                                  const std::vector<std::uint32_t>& of_the_pass) {
  const GridPatch& patch = sensor.patches.front();
  std::vector<std::uint32_t> values{sizes.workgroup,
                                    sizes.lanes,
                                    static_cast<std::uint32_t>(numTaxels(sensor)),
                                    static_cast<std::uint32_t>(packed.tiles.size()),
                                    static_cast<std::uint32_t>(sensor.samples_per_taxel),
                                    packed.one_grid ? static_cast<std::uint32_t>(patch.num_rows) : 0u,
                                    packed.one_grid ? static_cast<std::uint32_t>(patch.num_cols) : 1u,
                                    sizes.repeats,
                                    static_cast<std::uint32_t>(sensor.psf.size),
                                    bits(patch.pitch[0]),
                                    bits(patch.pitch[1])};
  values.insert(values.end(), of_the_pass.begin(), of_the_pass.end());
  std::vector<gpu::Constant> numbered;
  for (const std::uint32_t value : values) numbered.push_back({static_cast<std::uint32_t>(numbered.size()), value});
  return numbered;
}

std::span<const std::uint32_t> Model::Impl::spirvFor(const Spirv& spirv, std::uint32_t workgroup) const {
  return faster.lockstep && isOneVector(device.info(), workgroup) ? spirv.lockstep : spirv.any;
}

gpu::Kernel Model::Impl::makeContactKernel(const ContactVariant& variant) const {
  const bool taxels_follow = std::any_of(law.taxel_passes.begin(), law.taxel_passes.end(),
                                         [](const TaxelPass& pass) { return pass.owner != TaxelPass::Owner::kTile; });
  // Under friction or relaxation a search over tiles leaves the state of the samples alone: one more evaluation ends it.
  const Friction& skin_friction = sensor.skin.friction;
  const bool only_searches = hasFriction() && variant.search == kSearchOverTiles;
  const bool friction = hasFriction() && !only_searches;
  const bool has_state = law.has_state && !only_searches;
  std::vector<std::uint32_t> of_the_pass{contact_packed.max_tile_samples,
                                         contact_packed.flat,
                                         has_state,
                                         variant.search,
                                         bits(sensor.skin.thickness),
                                         packed.scalesSpread() && !taxels_follow && !layer,
                                         variant.many_slots,
                                         variant.list == layout::kListCandidates ? 1u << layout::kKindMesh : kinds,
                                         triangles_of,
                                         variant.with_depth,
                                         num_faces};
  for (const float parameter : law.parameters) of_the_pass.push_back(bits(parameter));
  of_the_pass.insert(of_the_pass.end(), {friction, bits(skin_friction.tangential_stiffness), bits(skin_friction.friction_coefficient),
                                         friction && variant.with_shear, friction && law.has_bristles});
  for (const float parameter : law.bristles) of_the_pass.push_back(bits(parameter));
  of_the_pass.push_back(layer ? 0 : static_cast<std::uint32_t>(sensor.skin.relaxation.size()));
  of_the_pass.insert(of_the_pass.end(),
                     {groups_per_batch, variant.with_jacobian, faster.untouched, bits(law.reach), variant.list, law.taxel_passes.empty()});
  return {gpu::contextOf(device),
          {.name = law.kernel,
           .spirv = spirvFor(law.spirv, contact_workgroup),
           .buffers = {"Poses",       "Instances",  "Step",           "Objects", "Groups",        "Clusters",     "Quads",
                       "Patches",     "Tiles",      "SpreadScale",    "State",   "ContactNormal", "ContactDepth", "TileResults",
                       "Loads",       "Problems",   "Faces",          "Motions", "FrictionState", "ContactShear", "ContactCells",
                       "TileChanges", "Candidates", "CandidateQuads", "Work",    "WorkInstances"},
           .constants = constants(contact_sensor, contact_packed, {contact_workgroup, contact_packed.contact_lanes, contactRepeat(variant)},
                                  of_the_pass)}};
}

Model::Impl::CandidatePasses Model::Impl::makeCandidatePasses(bool with_jacobian) const {
  const auto made = [&](const char* name, std::span<const std::uint32_t> spirv, const std::vector<std::string>& buffers,
                        std::uint32_t workgroup, const std::vector<std::uint32_t>& more) {
    std::vector<std::uint32_t> of_the_pass{contact_packed.flat, with_jacobian, bits(law.reach)};
    of_the_pass.insert(of_the_pass.end(), more.begin(), more.end());
    return gpu::Kernel(
        gpu::contextOf(device),
        {.name = name,
         .spirv = spirv,
         .buffers = buffers,
         .constants = constants(contact_sensor, contact_packed, {workgroup, contact_packed.contact_lanes, contact_repeat}, of_the_pass)});
  };
  return {.keep = made("keep_candidates", k_keep_candidates_spirv,
                       {"Poses", "Step", "Objects", "Patches", "Tiles", "Candidates", "Work", "WorkInstances"}, kTaxelWorkgroup,
                       {contact_repeat}),
          .find = made("find_candidates", spirvFor({k_find_candidates_spirv, k_find_candidates_lockstep_spirv}, contact_workgroup),
                       {"Poses", "Step", "Objects", "Groups", "Clusters", "Quads", "Patches", "Tiles", "Candidates", "CandidateQuads",
                        "Work", "WorkInstances", "Problems"},
                       contact_workgroup, {groups_per_batch})};
}

gpu::Kernel Model::Impl::makeContactsKernel(std::uint32_t repeat) const {
  constexpr std::uint32_t kNoLanes = 1;  // its sums are of one invocation each
  return {gpu::contextOf(device),
          {.name = "contacts",
           .spirv = k_contacts_spirv,
           .buffers = {"Step", "Contacts", "NumContacts", "Patches", "SpreadScale", "ContactNormal", "TileResults", "Features", "Problems"},
           .constants = constants(sensor, packed, {image_workgroup, kNoLanes, repeat},
                                  {static_cast<std::uint32_t>(sensor.patches.size()), packed.flat, bits(sensor.skin.thickness),
                                   packed.scalesSpread(), image_team})}};
}

gpu::Kernel Model::Impl::makeImageKernel(const ImageVariant& variant) const {
  const Readout& readout = sensor.readout;
  const bool alike = std::all_of(packed.taxels.begin(), packed.taxels.end(), [&](const layout::TaxelRecord& taxel) {
    return taxel.readout.x == 1.0f && taxel.readout.y == static_cast<float>(readout.trigger);
  });
  return {gpu::contextOf(device),
          {.name = "image",
           .spirv = k_image_spirv,
           .buffers = {"Instances", "Step", "SensorBlock", "Taxels", "SpreadRows", "ContactNormal", "ContactShear", "TileResults", "Loads",
                       "Image", "SpreadNormal", "SpreadShear", "Features", "Problems", "TaxelStates", "ImageWindows"},
           .constants = constants(sensor, packed, {image_workgroup, packed.image_lanes, image_repeat},
                                  {variant.with_shear,
                                   packed.num_entries,
                                   variant.with_normal,
                                   alike,
                                   static_cast<std::uint32_t>(readout.curve.size()),
                                   bits(slopeAtZero(readout)),
                                   bits(readout.output_scale),
                                   bits(readout.trigger),
                                   bits(readout.saturation),
                                   bits(readout.noise),
                                   variant.random,
                                   image_team,
                                   image_partials,
                                   static_cast<std::uint32_t>(readout.hysteresis_strength.size()),
                                   static_cast<std::uint32_t>(readout.creep.size()),
                                   readout.low_pass_time > 0,
                                   readout.delay > 0,
                                   readout.random_walk > 0,
                                   bits(readout.bias),
                                   bits(readout.dead_taxel_probability),
                                   variant.whole_array,
                                   packed.turns_shear,
                                   bits(readout.curve_limit),
                                   static_cast<std::uint32_t>(readout.curve_points.size()),
                                   faster.untouched && sensor.frame_rate == 0})}};
}

const std::vector<gpu::Kernel>& Model::Impl::taxelKernels(bool with_shear) const {
  const std::lock_guard lock(kernels_mutex_);
  std::vector<gpu::Kernel>& kernels = taxel_[with_shear];
  while (kernels.size() < law.taxel_passes.size()) kernels.push_back(makeTaxelKernel(law.taxel_passes[kernels.size()], with_shear));
  return kernels;
}

std::uint32_t Model::Impl::taxelGroups(const TaxelPass& pass, std::uint32_t num_instances) const {
  const std::uint64_t per_instance = pass.owner == TaxelPass::Owner::kTaxel  ? num_taxels
                                     : pass.owner == TaxelPass::Owner::kTile ? packed.tiles.size()
                                                                             : 1;
  return static_cast<std::uint32_t>((num_instances * per_instance + kTaxelWorkgroup - 1) / kTaxelWorkgroup);
}

gpu::Kernel Model::Impl::makeTaxelKernel(const TaxelPass& pass, bool with_shear) const {
  return {gpu::contextOf(device),
          {.name = pass.kernel,
           .spirv = pass.spirv,
           .buffers = {"Instances", "Step", "SpreadScale", "Mask", "ContactNormal", "LawState", "TileResults", "Taxels", "Problems",
                       "ContactShear"},
           .constants = constants(sensor, packed, {kTaxelWorkgroup, 1, 1},
                                  {packed.scalesSpread(), bits(law.taxel_parameters[0]), bits(law.taxel_parameters[1]), with_shear,
                                   bits(sensor.skin.friction.friction_coefficient)})}};
}

gpu::Kernel Model::Impl::makeLoadKernel() const {
  return {gpu::contextOf(device),
          {.name = "load",
           .spirv = k_load_spirv,
           .buffers = {"Instances", "Step", "TileResults", "Loads"},
           .constants = constants(sensor, packed, {image_workgroup, 1, 1}, {kLoadEvaluations})}};
}

gpu::Kernel Model::Impl::makeLayerKernel(const LayerVariant& variant) const {
  const bool pairs = faster.pairs && device.info().type == DeviceType::kCpu && gpu::contextOf(device).hasInt64();
  const auto& elastic = std::get<ElasticLayer>(sensor.skin.law);
  const Friction& friction = sensor.skin.friction;
  const LayerNodes& nodes = layer->nodes;
  const auto count = [](int number) { return static_cast<std::uint32_t>(number); };
  return {gpu::contextOf(device),
          {.name = "elastic_layer",
           .spirv = spirvFor(pairs ? Spirv{k_elastic_layer_pairs_spirv, k_elastic_layer_pairs_lockstep_spirv}
                                   : Spirv{k_elastic_layer_spirv, k_elastic_layer_lockstep_spirv},
                             layer_workgroup),
           .buffers = {"Instances", "Step", "SensorBlock", "Heights", "Windows", "Influence", "SpreadScale", "Layer", "ContactNormal",
                       "ContactDepth", "TileResults", "Loads", "Features", "Problems", "Motions", "FrictionState", "ContactShear",
                       "TaxelJacobian", "WrenchJacobian"},
           .constants =
               constants(sensor, packed, {layer_workgroup, layerLanes(device.info(), layerWork(sensor, *layer)), 1},
                         {count(nodes.num_rows), count(nodes.num_cols), count(nodes.margin_rows), count(nodes.margin_cols),
                          bits(sensor.skin.thickness), bits(layer->reach), bits(layer->node_force), count(elastic.iterations),
                          bits(elastic.tolerance), count(static_cast<int>(contact_packed.tiles.size())), variant.loads, variant.with_depth,
                          variant.many_slots, hasFriction(), bits(friction.tangential_stiffness), bits(friction.friction_coefficient),
                          variant.with_shear, count(static_cast<int>(sensor.skin.relaxation.size())), variant.with_jacobian})}};
}

Model::Model(const Device& device, const ModelOptions& options) : impl_(std::make_shared<Impl>(device, options, Tuning{})) {}

Model ModelAccess::make(const Device& device, const ModelOptions& options, const Tuning& tuning) {
  return Model(std::make_shared<Model::Impl>(device, options, tuning));
}

const Sensor& Model::sensor() const {
  return impl_->sensor;
}
const std::vector<Object>& Model::objects() const {
  return impl_->objects;
}
const Device& Model::device() const {
  return impl_->device;
}

}  // namespace taxelsim
