#include <algorithm>
#include <bit>
#include <cstdint>

#include "contact_winkler.spv.h"
#include "image.spv.h"
#include "load.spv.h"
#include "simulation/model_impl.h"
#include "simulation/pack_objects.h"
#include "taxelsim/error.h"

namespace taxelsim {
namespace {

// Most samples of a tile, whatever the shared memory: more would leave a GPU's core too few workgroups.
constexpr std::uint32_t kMaxTileSamples = 6144;
// Shared memory of the contact pass beside the tile, at most: partial sums and lists.
constexpr std::uint32_t kTileOverhead = 3072;

std::uint32_t chooseWorkgroup(int wanted, const DeviceInfo& info, std::uint32_t on_gpu, const char* name) {
  if (wanted == 0) return info.type == DeviceType::kCpu ? 8 : on_gpu;
  if (wanted < 4 || wanted > 256 || !std::has_single_bit(static_cast<unsigned>(wanted))) {
    throw Error(ErrorKind::kInput, std::string(name) + ": " + std::to_string(wanted) + " is not allowed: a power of two, 4 to 256");
  }
  return static_cast<std::uint32_t>(wanted);
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
  const PackedObjects packed_objects = packObjects(objects);
  object_records = upload("objects", packed_objects.objects);
  groups = upload("groups", packed_objects.groups);
  clusters = upload("clusters", packed_objects.clusters);
  triangles = upload("triangles", packed_objects.triangles);
  sensor_record = upload("sensor", std::vector{packed.sensor});
  patches = upload("patches", packed.patches);
  tiles = upload("tiles", packed.tiles);
  taxels = upload("taxels", packed.taxels);
  spread_entries = upload("spread entries", packed.spread_entries);
  contact = makeContactKernel();
  image = makeImageKernel();
  if (!packed.searches_in_tile) load = makeLoadKernel();
  context.savePipelineCache();
}

gpu::Kernel Model::Impl::makeContactKernel() const {
  return {device.context(),
          {.name = "contact_winkler",
           .spirv = k_contact_winkler_spirv,
           .buffers = {"Poses", "Instances", "Step", "Objects", "Groups", "Clusters", "Triangles", "SensorBlock", "Patches", "Tiles", "State",
                       "ContactNormal", "ContactDepth", "ContactShear", "TileResults", "Loads"},
           .constants = {{0, contact_workgroup},
                         {1, static_cast<std::uint32_t>(sensor.samples_per_taxel)},
                         {2, packed.max_tile_samples},
                         {3, packed.num_lanes},
                         {4, has_state ? 1u : 0u},
                         {5, packed.searches_in_tile ? 0u : 1u}}}};
}

gpu::Kernel Model::Impl::makeImageKernel() const {
  return {device.context(),
          {.name = "image",
           .spirv = k_image_spirv,
           .buffers = {"Instances", "Step", "SensorBlock", "Patches", "Tiles", "Taxels", "SpreadEntries", "ContactNormal", "ContactShear",
                       "TileResults", "Loads", "Image", "SpreadNormal", "SpreadShear", "Features"},
           .constants = {{0, image_workgroup},
                         {1, packed.num_lanes},
                         {2, 0},
                         {3, static_cast<std::uint32_t>(sensor.psf.size / 2)},
                         {4, packed.one_patch ? 1u : 0u},
                         {5, static_cast<std::uint32_t>(sensor.samples_per_taxel)}}}};
}

gpu::Kernel Model::Impl::makeLoadKernel() const {
  return {device.context(),
          {.name = "load",
           .spirv = k_load_spirv,
           .buffers = {"Instances", "Step", "SensorBlock", "Patches", "Tiles", "TileResults", "Loads"},
           .constants = {{0, image_workgroup}, {1, kLoadEvaluations}}}};
}

Model::Model(const Device& device, const ModelOptions& options) : impl_(std::make_shared<Impl>(device, options)) {}

const Sensor& Model::sensor() const { return impl_->sensor; }
const std::vector<Object>& Model::objects() const { return impl_->objects; }
const Device& Model::device() const { return impl_->device; }

}  // namespace taxelsim
