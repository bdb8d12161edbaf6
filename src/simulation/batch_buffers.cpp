#include "simulation/batch_buffers.h"

#include <algorithm>

#include "gpu/device_access.h"
#include "shared/batch.h"
#include "shared/candidates.h"
#include "shared/elastic_layer.h"
#include "shared/features.h"
#include "taxelsim/error.h"

namespace taxelsim {
namespace {

// Bytes of one instance in every array.
struct InstanceBytes {
  InstanceBytes(const Model::Impl& model, const SimulatorOptions& options, bool keeps_candidates) {
    const std::uint64_t taxels = model.num_taxels;
    const std::uint64_t num_tiles = model.packed.tiles.size();
    const bool takes_contacts = options.max_contacts > 0;
    poses = takes_contacts ? 0 : sizeof(layout::PoseRecord) * static_cast<std::uint64_t>(options.num_slots);
    contacts = sizeof(layout::ContactRecord) * static_cast<std::uint64_t>(options.max_contacts);
    num_contacts = takes_contacts ? 4 : 0;
    state = model.law.has_state && !takes_contacts ? 4 * num_tiles * model.packed.max_tile_samples : 0;
    const std::uint64_t per_sample = model.relaxes() ? 1 + model.sensor.skin.relaxation.size() : 0;  // strain, overstresses
    if (model.relaxes() && !model.layer && !takes_contacts) {
      state = 4 * num_tiles * (layout::kRelaxationHeader + per_sample * model.packed.max_tile_samples);
    }
    taxel_scalar = 4 * taxels;
    law_state = model.law.taxel_passes.empty() ? 0 : 8 * taxels;
    if (model.packed.one_grid && model.sensor.frame_rate == 0) image_windows = sizeof(glm::uvec4);
    taxel_states = model.packed.num_states * taxel_scalar;
    depth = options.outputs.penetration_depth ? 4 * taxels : 0;
    shear = options.outputs.tactile_shear_force ? 8 * taxels : 0;
    if (model.hasFriction() && !takes_contacts) {
      motions = sizeof(layout::MotionRecord) * static_cast<std::uint64_t>(options.num_slots);
      const std::uint64_t samples =
          model.layer ? static_cast<std::uint64_t>(numTaxels(model.contact_sensor)) : num_tiles * model.packed.max_tile_samples;
      friction = 8 * (num_tiles * layout::kFrictionHeader + samples);
      contact_shear = shear;
    }
    if (keeps_candidates) {
      candidates = sizeof(layout::CandidateRecord);
      candidate_quads = 4ull * layout::kMaxCandidates;
      work_instances = 4 * layout::kNumLists;
    }
    tiles = sizeof(layout::TileResult) * num_tiles;
    if (options.outputs.contact_features || options.outputs.clean_contact_features) {
      const std::uint64_t per_set = 4 * (1 + layout::kNumContactFeatures * numContactRows(model.packed_contact, options.max_regions));
      if (options.outputs.contact_features) contact_features = per_set;
      if (options.outputs.clean_contact_features) clean_contact_features = per_set;
      forces = taxel_regions = taxel_scalar;
      region_sums = options.max_regions > 0 ? taxel_scalar : 0;
      regions = 4 * static_cast<std::uint64_t>(options.max_regions);
    }
    if (wantsJacobian(options.outputs)) {
      const std::uint64_t per_set = 4ull * layout::kNumJacobian * numContactRows(model.packed_contact, 0);
      if (options.outputs.tactile_jacobian) jacobian = per_set;
      if (options.outputs.clean_tactile_jacobian) clean_jacobian = per_set + 4 * layout::kNumWrenchJacobian;
      contact_cells = model.layer ? 0 : sizeof(layout::CellRecord) * taxels;
      tile_changes = model.layer ? 0 : 4 * num_tiles * model.packed.contact_lanes * layout::kTileChanges;
      taxel_jacobian = 6 * taxel_scalar;
      masked_jacobian = model.masksForces() ? taxel_jacobian : 0;
      wrench_jacobian = 4 * num_tiles * layout::kNumWrenchJacobian;
    }
    if (model.layer && !takes_contacts) {
      heights = 4 * static_cast<std::uint64_t>(numTaxels(model.contact_sensor));
      windows = sizeof(layout::TileResult) * model.contact_packed.tiles.size();
      layer = 4 * (layout::kNumLayerArrays + per_sample) * model.layer->influence.size() / 2;
    }
  }

  std::uint64_t poses, contacts, num_contacts, state, taxel_scalar, law_state, taxel_states, depth, shear, tiles;
  std::uint64_t candidates = 0, candidate_quads = 0, work_instances = 0;
  std::uint64_t motions = 0, friction = 0, contact_shear = 0;
  std::uint64_t image_windows = 0, heights = 0, windows = 0, layer = 0;
  std::uint64_t forces = 0, taxel_regions = 0, region_sums = 0, regions = 0, contact_features = 0, clean_contact_features = 0;
  std::uint64_t contact_cells = 0, tile_changes = 0, taxel_jacobian = 0, masked_jacobian = 0, wrench_jacobian = 0;
  std::uint64_t jacobian = 0, clean_jacobian = 0;
  std::uint64_t instances = sizeof(layout::InstanceRecord);
  std::uint64_t loads = sizeof(layout::LoadRecord);
  std::uint64_t features = 4 * layout::kNumFeatures;

  // contact_normal, spread_normal and the image have a scalar per taxel.
  std::uint64_t total() const {
    return poses + candidates + candidate_quads + work_instances + motions + contacts + num_contacts + state + friction + law_state +
           taxel_states + 3 * taxel_scalar + depth + shear + contact_shear + tiles + image_windows + heights + windows + layer + instances +
           loads + features + forces + taxel_regions + region_sums + regions + contact_features + clean_contact_features + contact_cells +
           tile_changes + taxel_jacobian + masked_jacobian + wrench_jacobian + jacobian + clean_jacobian;
  }
  std::uint64_t readBack() const {
    return 2 * taxel_scalar + depth + shear + features + contact_features + clean_contact_features + jacobian + clean_jacobian;
  }
  std::uint64_t largest() const {
    return std::max({poses,
                     candidate_quads,
                     motions,
                     contacts,
                     state,
                     friction,
                     law_state,
                     taxel_states,
                     taxel_scalar,
                     shear,
                     tiles,
                     heights,
                     image_windows,
                     windows,
                     layer,
                     instances,
                     features,
                     contact_features,
                     clean_contact_features,
                     contact_cells,
                     tile_changes,
                     taxel_jacobian,
                     wrench_jacobian,
                     jacobian,
                     clean_jacobian});
  }
};

// Part of the device's memory that a batch may take; the rest is the driver's and other programs'.
constexpr double kMemoryShare = 0.9;

std::uint64_t bytesPerInstance(const Model::Impl& model, const InstanceBytes& bytes) {
  return bytes.total() + (model.device.info().type == DeviceType::kDiscrete ? bytes.readBack() : 0);
}

// Instances of so many bytes that the device holds.
std::uint64_t roomFor(const Model::Impl& model, const InstanceBytes& bytes) {
  const DeviceInfo& info = model.device.info();
  const auto memory = static_cast<std::uint64_t>(static_cast<double>(info.memory) * kMemoryShare);
  const std::uint64_t fixed = model.static_bytes + sizeof(layout::StepRecord);
  const std::uint64_t by_memory = memory > fixed ? (memory - fixed) / bytesPerInstance(model, bytes) : 0;
  // Workgroup numbers are 32-bit.
  const std::uint64_t by_number = 0xFFFFFFFFu / std::max<std::uint64_t>(1, model.contact_packed.tiles.size());
  return std::min({by_memory, info.max_buffer / bytes.largest(), by_number, std::uint64_t{0x7FFFFFFF}});
}

void checkRegions(const SimulatorOptions& options) {
  const auto refuse = [&](const std::string& allowed) {
    throw Error(ErrorKind::kInput, "max_regions: " + std::to_string(options.max_regions) + " is not allowed: " + allowed);
  };
  if (options.max_regions < 0 || options.max_regions > kMaxRegions) refuse("0 to " + std::to_string(kMaxRegions));
  const bool with_features = options.outputs.contact_features || options.outputs.clean_contact_features;
  if (options.max_regions > 0 && !with_features) refuse("0 where no outputs.contact_features or clean_contact_features are asked for");
}

void checkJacobian(const SimulatorOptions& options) {
  const char* name = options.outputs.tactile_jacobian ? "outputs.tactile_jacobian" : "outputs.clean_tactile_jacobian";
  if (!wantsJacobian(options.outputs)) return;
  const auto refuse = [&](const char* why) { throw Error(ErrorKind::kInput, std::string(name) + ": true is not allowed " + why); };
  if (options.max_contacts > 0) refuse("where max_contacts > 0: contacts do not tell how forces follow a motion");
}

// Objects or contacts: where the forces of the batch come from.
void checkSource(const Model::Impl& model, const SimulatorOptions& options) {
  constexpr double kMaxContactBand = 1;  // m
  const auto refuse = [](const std::string& what) { throw Error(ErrorKind::kInput, what); };
  if (options.max_contacts < 0 || options.max_contacts > kMaxContacts) {
    refuse("max_contacts: " + std::to_string(options.max_contacts) + " is not allowed: 0 to " + std::to_string(kMaxContacts));
  }
  // Written so that NaN fails.
  if (!(options.contact_band >= 0 && options.contact_band <= kMaxContactBand)) {
    refuse("contact_band: " + std::to_string(options.contact_band) + " is not allowed: 0 to 1 m");
  }
  if (options.max_contacts == 0 && model.objects.empty()) {
    refuse("objects: none given; a model needs at least one, unless its simulators take contacts (max_contacts)");
  }
  if (options.max_contacts > 0 && options.outputs.penetration_depth) {
    refuse("outputs.penetration_depth: true is not allowed where max_contacts > 0: contacts do not tell it");
  }
}

}  // namespace

bool keepsCandidates(const Model::Impl& model, const SimulatorOptions& options) {
  return model.keeps_candidates && options.num_slots == 1 && options.max_contacts == 0 &&
         static_cast<std::uint64_t>(options.num_instances) <= roomFor(model, InstanceBytes(model, options, true));
}

MemoryPlan planBatch(const Model::Impl& model, const SimulatorOptions& options) {
  MemoryPlan plan;
  plan.bytes_per_instance = bytesPerInstance(model, InstanceBytes(model, options, keepsCandidates(model, options)));
  plan.bytes_fixed = model.static_bytes + sizeof(layout::StepRecord);
  plan.max_instances = roomFor(model, InstanceBytes(model, options, false));
  return plan;
}

void checkBatchFits(const Model::Impl& model, const SimulatorOptions& options) {
  if (options.num_instances < 1) {
    throw Error(ErrorKind::kInput, "num_instances: " + std::to_string(options.num_instances) + " is not allowed: at least 1");
  }
  if (options.num_slots < 1 || options.num_slots > kMaxSlots) {
    throw Error(ErrorKind::kInput,
                "num_slots: " + std::to_string(options.num_slots) + " is not allowed: 1 to " + std::to_string(kMaxSlots));
  }
  checkSource(model, options);
  checkRegions(options);
  checkJacobian(options);
  const MemoryPlan plan = planBatch(model, options);
  if (static_cast<std::uint64_t>(options.num_instances) <= plan.max_instances) return;
  throw Error(ErrorKind::kInput, "a batch of " + std::to_string(options.num_instances) + " instances of " +
                                     std::to_string(plan.bytes_per_instance) + " bytes does not fit into device \"" +
                                     model.device.info().name + "\": at most " + std::to_string(plan.max_instances) + " do");
}

BatchBuffers::BatchBuffers(const Model::Impl& model, const SimulatorOptions& options) {
  const InstanceBytes bytes(model, options, keepsCandidates(model, options));
  gpu::Context& context = gpu::contextOf(model.device);
  const auto n = static_cast<std::uint64_t>(options.num_instances);
  const auto make = [&](const char* name, std::uint64_t per_instance, gpu::Domain domain) {
    return gpu::Buffer(context, name, n * per_instance, domain);
  };
  const auto make_readable = [&](const char* name, std::uint64_t per_instance) {
    ReadableBuffer buffer{make(name, per_instance, gpu::Domain::kDevice), {}};
    if (buffer.copied()) buffer.readback = make((std::string(name) + " readback").c_str(), per_instance, gpu::Domain::kReadback);
    return buffer;
  };
  poses = make("poses", bytes.poses, gpu::Domain::kUpload);
  motions = make("motions", bytes.motions, gpu::Domain::kUpload);
  instances = make("instances", bytes.instances, gpu::Domain::kUpload);
  loads = make("loads", bytes.loads, gpu::Domain::kUpload);
  contacts = make("contacts", bytes.contacts, gpu::Domain::kUpload);
  num_contacts = make("num_contacts", bytes.num_contacts, gpu::Domain::kUpload);
  step = gpu::Buffer(context, "step", sizeof(layout::StepRecord), gpu::Domain::kUpload);
  candidates = make("candidates", bytes.candidates, gpu::Domain::kDevice);
  candidate_quads = make("candidate quads", bytes.candidate_quads, gpu::Domain::kDevice);
  work_instances = make("work lists", bytes.work_instances, gpu::Domain::kDevice);
  state = make("contact state", bytes.state, gpu::Domain::kDevice);
  law_state = make("law state", bytes.law_state, gpu::Domain::kDevice);
  friction_state = make("friction state", bytes.friction, gpu::Domain::kDevice);
  contact_normal = make("contact_normal", bytes.taxel_scalar, gpu::Domain::kDevice);
  contact_shear = make("contact_shear", bytes.contact_shear, gpu::Domain::kDevice);
  taxel_states = make("taxel states", bytes.taxel_states, gpu::Domain::kDevice);
  tile_results = make("tile_results", bytes.tiles, gpu::Domain::kDevice);
  heights = make("heights", bytes.heights, gpu::Domain::kDevice);
  image_windows = make("image windows", bytes.image_windows, gpu::Domain::kDevice);
  windows = make("windows", bytes.windows, gpu::Domain::kDevice);
  layer = make("layer", bytes.layer, gpu::Domain::kDevice);
  forces = make("forces", bytes.forces, gpu::Domain::kDevice);
  taxel_regions = make("taxel regions", bytes.taxel_regions, gpu::Domain::kDevice);
  region_sums = make("region sums", bytes.region_sums, gpu::Domain::kDevice);
  regions = make("regions", bytes.regions, gpu::Domain::kDevice);
  contact_cells = make("contact cells", bytes.contact_cells, gpu::Domain::kDevice);
  tile_changes = make("tile changes", bytes.tile_changes, gpu::Domain::kDevice);
  taxel_jacobian = make("taxel Jacobian", bytes.taxel_jacobian, gpu::Domain::kDevice);
  masked_jacobian = make("masked Jacobian", bytes.masked_jacobian, gpu::Domain::kDevice);
  wrench_jacobian = make("wrench Jacobian", bytes.wrench_jacobian, gpu::Domain::kDevice);
  contact_depth = make_readable("penetration_depth", bytes.depth);
  image = make_readable("tactile_image", bytes.taxel_scalar);
  spread_normal = make_readable("tactile_normal_force", bytes.taxel_scalar);
  spread_shear = make_readable("tactile_shear_force", bytes.shear);
  features = make_readable("features", bytes.features);
  contact_features = make_readable("contact_features", bytes.contact_features);
  clean_contact_features = make_readable("clean_contact_features", bytes.clean_contact_features);
  jacobian = make_readable("tactile_jacobian", bytes.jacobian);
  clean_jacobian = make_readable("clean_tactile_jacobian", bytes.clean_jacobian);
  const auto make_fixed = [&](const std::string& name, std::uint64_t size) {
    ReadableBuffer buffer{gpu::Buffer(context, name, size, gpu::Domain::kDevice), {}};
    if (buffer.copied()) buffer.readback = gpu::Buffer(context, name + " readback", size, gpu::Domain::kReadback);
    return buffer;
  };
  problems = make_fixed("problems", 4);
  work = make_fixed("work", sizeof(glm::uvec4) * (layout::kNumLists + 1));
}

std::vector<ReadableBuffer*> BatchBuffers::readable(const OutputOptions& outputs) {
  std::vector<ReadableBuffer*> list{&image, &features, &problems, &work};
  if (outputs.tactile_normal_force) list.push_back(&spread_normal);
  if (outputs.tactile_shear_force) list.push_back(&spread_shear);
  if (outputs.penetration_depth) list.push_back(&contact_depth);
  if (outputs.contact_features) list.push_back(&contact_features);
  if (outputs.clean_contact_features) list.push_back(&clean_contact_features);
  if (outputs.tactile_jacobian) list.push_back(&jacobian);
  if (outputs.clean_tactile_jacobian) list.push_back(&clean_jacobian);
  return list;
}

}  // namespace taxelsim
