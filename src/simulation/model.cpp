#include <algorithm>
#include <bit>
#include <cstdint>

#include "contact_winkler.spv.h"
#include "contact_winkler_subgroups.spv.h"
#include "image.spv.h"
#include "image_subgroups.spv.h"
#include "load.spv.h"
#include "simulation/model_impl.h"
#include "simulation/pack_objects.h"
#include "taxelsim/error.h"

namespace taxelsim {
namespace {

// Most samples of a tile, whatever the shared memory: more would leave a GPU's core too few workgroups.
constexpr std::uint32_t kMaxTileSamples = 6144;
// Shared memory of the contact pass beside the tile, at most: partial sums and lists.
constexpr std::uint32_t kTileOverhead = 4096;

std::uint32_t chooseWorkgroup(int wanted, const DeviceInfo& info, std::uint32_t on_gpu, const char* name) {
  if (wanted == 0) return info.type == DeviceType::kCpu ? 8 : on_gpu;
  if (wanted < 4 || wanted > 256 || !std::has_single_bit(static_cast<unsigned>(wanted))) {
    throw Error(ErrorKind::kInput, std::string(name) + ": " + std::to_string(wanted) + " is not allowed: a power of two, 4 to 256");
  }
  return static_cast<std::uint32_t>(wanted);
}

std::uint32_t bits(double value) { return std::bit_cast<std::uint32_t>(static_cast<float>(value)); }

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

Model::Impl::Impl(const Device& of, const ModelOptions& options)
    : device(of), sensor(options.sensor), objects(options.objects) {
  checkSensor(sensor);
  if (objects.empty()) throw Error(ErrorKind::kInput, "objects: none given; a model needs at least one");
  for (const Object& object : objects) {
    checkObject(object);
    bounds.push_back(std::holds_alternative<Mesh>(object.shape) ? boundsOf(object) : cutBounds(object));
  }
  const DeviceInfo& info = device.info();
  contact_workgroup = chooseWorkgroup(options.contact_workgroup, info, 64, "contact_workgroup");
  image_workgroup = chooseWorkgroup(options.image_workgroup, info, 32, "image_workgroup");
  num_taxels = static_cast<std::uint32_t>(numTaxels(sensor));
  packed = packSensor(sensor, std::min(kMaxTileSamples, (info.shared_memory - kTileOverhead) / 4));
  has_state = std::get<Winkler>(sensor.skin.law).normal_damping > 0;

  gpu::Context& context = device.context();
  const auto upload = [&]<typename T>(const char* name, const std::vector<T>& values) {
    gpu::Buffer buffer = gpu::makeStaticBuffer(context, name, std::span<const T>(values));
    static_bytes += buffer.size();
    if (buffer.size() > info.max_buffer) {
      throw Error(ErrorKind::kInput, std::string(name) + " take " + std::to_string(buffer.size()) + " bytes, the device's buffers hold " +
                                         std::to_string(info.max_buffer) + "; use simpler meshes or another device");
    }
    return buffer;
  };
  const PackedObjects packed_objects = packObjects(objects, sensor.patches.front().pitch[0] / sensor.samples_per_taxel);
  object_records = upload("objects", packed_objects.objects);
  groups = upload("groups", packed_objects.groups);
  clusters = upload("clusters", packed_objects.clusters);
  triangles = upload("triangles", packed_objects.triangles);
  sensor_record = upload("sensor", std::vector{packed.sensor});
  patches = upload("patches", packed.patches);
  tiles = upload("tiles", packed.tiles);
  taxels = upload("taxels", packed.taxels);
  spread_rows = upload("spread rows", packed.spread_rows);
  spread_scale = upload("spread scale", packed.spread_scale);
  for (const layout::ObjectRecord& record : packed_objects.objects) {
    kinds |= 1u << record.kind_groups.x;
    if (record.kind_groups.x == layout::kKindMesh) triangles_of |= record.kind_groups.w == 0 ? 1u : 2u;
  }
  contactKernel({});
  imageKernel(sensor.readout.noise > 0);
}

const gpu::Kernel& Model::Impl::contactKernel(const ContactVariant& variant) const {
  const std::lock_guard lock(kernels_mutex_);
  const auto found = contact_.find(variant);
  if (found != contact_.end()) return found->second;
  return contact_.emplace(variant, makeContactKernel(variant)).first->second;
}

const gpu::Kernel& Model::Impl::imageKernel(bool random) const {
  const std::lock_guard lock(kernels_mutex_);
  const auto found = image_.find(random);
  if (found != image_.end()) return found->second;
  return image_.emplace(random, makeImageKernel(random)).first->second;
}

const gpu::Kernel& Model::Impl::loadKernel() const {
  const std::lock_guard lock(kernels_mutex_);
  if (!load_) load_ = makeLoadKernel();
  return *load_;
}

// The list of shaders/lib/specialization.glsl.
std::vector<gpu::Constant> Model::Impl::commonConstants(std::uint32_t workgroup) const {
  const GridPatch& patch = sensor.patches.front();
  return {{0, workgroup},
          {1, packed.num_lanes},
          {2, num_taxels},
          {3, static_cast<std::uint32_t>(packed.tiles.size())},
          {4, static_cast<std::uint32_t>(sensor.samples_per_taxel)},
          {5, packed.one_patch ? static_cast<std::uint32_t>(patch.num_rows) : 0u},
          {6, packed.one_patch ? static_cast<std::uint32_t>(patch.num_cols) : 1u}};
}

gpu::Kernel Model::Impl::makeContactKernel(const ContactVariant& variant) const {
  const Winkler& law = std::get<Winkler>(sensor.skin.law);
  const bool scaled = std::any_of(packed.spread_scale.begin(), packed.spread_scale.end(), [](float scale) { return scale != 1; });
  std::vector<gpu::Constant> constants = commonConstants(contact_workgroup);
  constants.insert(constants.end(), {{7, packed.max_tile_samples},
                                     {8, packed.flat},
                                     {9, has_state},
                                     {10, variant.search},
                                     {11, bits(sensor.skin.thickness)},
                                     {12, bits(law.normal_contact_stiffness)},
                                     {13, bits(law.normal_exponent)},
                                     {14, bits(law.normal_damping)},
                                     {15, scaled},
                                     {16, variant.many_slots},
                                     {17, kinds},
                                     {18, triangles_of}});
  const bool subgroups = device.context().subgroupOperations();
  return {device.context(),
          {.name = "contact_winkler",
           .spirv = subgroups ? std::span<const std::uint32_t>(k_contact_winkler_subgroups_spirv) : k_contact_winkler_spirv,
           .buffers = {"Poses", "Instances", "Step", "Objects", "Groups", "Clusters", "Triangles", "Patches", "Tiles", "SpreadScale", "State",
                       "ContactNormal", "ContactDepth", "ContactShear", "TileResults", "Loads"},
           .constants = std::move(constants)}};
}

gpu::Kernel Model::Impl::makeImageKernel(bool random) const {
  const Readout& readout = sensor.readout;
  const GridPatch& patch = sensor.patches.front();
  const bool alike = std::all_of(packed.taxels.begin(), packed.taxels.end(), [&](const layout::TaxelRecord& taxel) {
    return taxel.readout.x == 1.0f && taxel.readout.y == static_cast<float>(readout.trigger);
  });
  std::vector<gpu::Constant> constants = commonConstants(image_workgroup);
  constants.insert(constants.end(), {{7, false},
                                     {8, static_cast<std::uint32_t>(sensor.psf.size)},
                                     {9, packed.num_entries},
                                     {10, bits(patch.pitch[0])},
                                     {11, bits(patch.pitch[1])},
                                     {12, alike},
                                     {13, static_cast<std::uint32_t>(readout.curve.size())},
                                     {14, bits(readout.curve.front())},
                                     {15, bits(readout.output_scale)},
                                     {16, bits(readout.trigger)},
                                     {17, bits(readout.saturation)},
                                     {18, bits(readout.noise)},
                                     {19, random}});
  const bool subgroups = device.context().subgroupOperations();
  return {device.context(),
          {.name = "image",
           .spirv = subgroups ? std::span<const std::uint32_t>(k_image_subgroups_spirv) : k_image_spirv,
           .buffers = {"Instances", "Step", "SensorBlock", "Taxels", "SpreadRows", "ContactNormal", "ContactShear", "TileResults", "Loads", "Image",
                       "SpreadNormal", "SpreadShear", "Features"},
           .constants = std::move(constants)}};
}

gpu::Kernel Model::Impl::makeLoadKernel() const {
  return {device.context(),
          {.name = "load",
           .spirv = k_load_spirv,
           .buffers = {"Instances", "Step", "TileResults", "Loads"},
           .constants = {{0, image_workgroup}, {1, static_cast<std::uint32_t>(packed.tiles.size())}, {2, kLoadEvaluations}}}};
}

Model::Model(const Device& device, const ModelOptions& options) : impl_(std::make_shared<Impl>(device, options)) {}

const Sensor& Model::sensor() const { return impl_->sensor; }
const std::vector<Object>& Model::objects() const { return impl_->objects; }
const Device& Model::device() const { return impl_->device; }

}  // namespace taxelsim
