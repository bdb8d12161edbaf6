#include "taxelsim/simulator.h"

#include <array>
#include <cmath>
#include <optional>

#include "gpu/commands.h"
#include "simulation/batch_buffers.h"
#include "simulation/rows.h"
#include "taxelsim/error.h"

namespace taxelsim {
namespace {

// A quaternion read from text with six digits is this close to unit length.
constexpr double kQuaternionTolerance = 1e-3;

[[noreturn]] void refuse(const std::string& what) {
  throw Error(ErrorKind::kInput, what);
}

void checkLength(const char* name, std::size_t found, std::size_t expected) {
  if (found != expected) refuse(std::string(name) + ": " + std::to_string(found) + " values, expected " + std::to_string(expected));
}

double lengthOf(const Quaternion& q) {
  return std::sqrt(q[0] * q[0] + q[1] * q[1] + q[2] * q[2] + q[3] * q[3]);
}

// Refuses what one slot of an instance may not hold.
void checkSlot(int id, const Pose& X_SO, std::size_t instance, int num_objects) {
  if (id == kNoObject) return;
  const std::string where = " of instance " + std::to_string(instance);
  if (id < 0 || id >= num_objects) {
    refuse("object " + std::to_string(id) + where + " is not allowed: 0 to " + std::to_string(num_objects - 1) + ", or -1 for none");
  }
  const double length = lengthOf(X_SO.rotation);
  // Written so that NaN fails.
  if (!(std::abs(length - 1) <= kQuaternionTolerance)) {
    refuse("rotation" + where + ": a quaternion of length " + std::to_string(length) + " is not allowed: 1");
  }
  for (const double coordinate : X_SO.position) {
    if (!std::isfinite(coordinate)) refuse("position" + where + " is not finite");
  }
}

layout::PoseRecord packPose(int id, const Pose& X_SO) {
  if (id == kNoObject) return {{}, {}, {}, glm::vec4(kNoObject, 0, 0, 0)};
  const auto& [w, x, y, z] = X_SO.rotation;
  const double length = lengthOf(X_SO.rotation);
  const std::array<double, 9> rotation = rotationMatrix({w / length, x / length, y / length, z / length});
  return {row(rotation, X_SO.position, 0),
          row(rotation, X_SO.position, 1),
          row(rotation, X_SO.position, 2),
          {static_cast<float>(id), 0.0f, 0.0f, 0.0f}};
}

// Time since reset of one instance, and when its sensor delivers.
struct Clock {
  double time = 0;           // s, of the next step
  std::uint32_t frames = 0;  // delivered so far
  bool first_step = true;

  // Frame k is due at k / rate; a step that comes within a billionth of a period is in time.
  bool frameDue(double rate) const { return rate == 0 || time * rate >= static_cast<double>(frames) - 1e-9; }
  // Skips frames that fell between two steps.
  void deliver(double rate) { frames = rate == 0 ? frames + 1 : static_cast<std::uint32_t>(std::floor(time * rate + 1e-9)) + 1; }
};

}  // namespace

struct Simulator::Impl {
  Impl(const Model& of, const SimulatorOptions& with)
      : model(of), options(with), buffers((checkBatchFits(*of.impl(), with), *of.impl()), with) {
    clocks.resize(static_cast<std::size_t>(with.num_instances));
    const std::span<layout::PoseRecord> poses = buffers.poses.mappedAs<layout::PoseRecord>();
    for (layout::PoseRecord& pose : poses) pose = packPose(kNoObject, {});
    for (layout::InstanceRecord& instance : records()) instance.drive = {kPoseDriven, 1.0f, 0.0f, 0.0f};
    commands(false, of.sensor().readout.noise > 0);
    of.device().context().savePipelineCache();
  }

  void checkInstance(int instance) const {
    if (instance >= 0 && instance < options.num_instances) return;
    refuse("instance: " + std::to_string(instance) + " is not allowed: 0 to " + std::to_string(options.num_instances - 1));
  }

  std::span<layout::InstanceRecord> records() const { return buffers.instances.mappedAs<layout::InstanceRecord>(); }

  // The commands of one frame, recorded when first wanted. `loads`: some instance is driven by load; `random`: some instance draws noise or
  // gains.
  gpu::Commands& commands(bool loads, bool random);
  gpu::Commands record(bool loads, bool random);
  void startSearch();
  FrameView view() const;

  Model model;
  SimulatorOptions options;
  BatchBuffers buffers;
  std::vector<Clock> clocks;
  std::array<std::optional<gpu::Commands>, 4> recorded;
  gpu::Commands* running = nullptr;
  StepTiming timing;
};

gpu::Commands& Simulator::Impl::commands(bool loads, bool random) {
  std::optional<gpu::Commands>& list = recorded[(loads ? 1u : 0u) + (random ? 2u : 0u)];
  if (!list) list = record(loads, random);
  return *list;
}

// The one place where the passes are put in order.
gpu::Commands Simulator::Impl::record(bool with_loads, bool random) {
  const Model::Impl& m = *model.impl();
  const auto n = static_cast<std::uint32_t>(options.num_instances);
  const auto num_tiles = static_cast<std::uint32_t>(m.packed.tiles.size());
  const bool over_tiles = with_loads && !m.packed.searches_in_tile;
  const Model::Impl::ContactVariant variant{.search = over_tiles   ? kSearchOverTiles
                                                      : with_loads ? kSearchInTile
                                                                   : kNoSearch,
                                            .many_slots = options.num_slots > 1,
                                            .with_depth = options.outputs.penetration_depth};
  const gpu::Kernel& contact = m.contactKernel(variant);
  const std::uint32_t contact_repeat = m.contactRepeat(variant);
  const BatchBuffers& b = buffers;
  gpu::Commands commands(m.device.context(), "a frame", 3);
  commands.barrier(gpu::Access::kHostWrite, gpu::Access::kKernel);
  commands.timestamp(0);
  const std::uint32_t evaluations = over_tiles ? kLoadEvaluations + 2 : 1;  // two more: one closes the search, one is told
  for (std::uint32_t evaluation = 0; evaluation < evaluations; ++evaluation) {
    commands.dispatch(
        contact, (n * num_tiles + contact_repeat - 1) / contact_repeat,
        {&b.poses, &b.instances, &b.step, &m.object_records, &m.groups, &m.clusters, &m.triangles, &m.patches, &m.tiles, &m.spread_scale,
         &b.state, &b.contact_normal, &b.contact_depth.device, &b.tile_results, &b.loads, &b.problems.device, &m.faces});
    commands.barrier(gpu::Access::kKernel, gpu::Access::kKernel);
    if (!over_tiles) continue;
    commands.dispatch(m.loadKernel(), (n + m.image_workgroup - 1) / m.image_workgroup, {&b.instances, &b.step, &b.tile_results, &b.loads});
    commands.barrier(gpu::Access::kKernel, gpu::Access::kKernel);
  }
  commands.timestamp(1);
  commands.dispatch(
      m.imageKernel({.random = random, .with_normal = options.outputs.tactile_normal_force}),
      (n + m.imagesPerWorkgroup() - 1) / m.imagesPerWorkgroup(),
      {&b.instances, &b.step, &m.sensor_record, &m.taxels, &m.spread_rows, &b.contact_normal, &b.contact_shear, &b.tile_results, &b.loads,
       &b.image.device, &b.spread_normal.device, &b.spread_shear.device, &b.features.device, &b.problems.device});
  commands.timestamp(2);
  commands.barrier(gpu::Access::kKernel, gpu::Access::kCopy);
  for (ReadableBuffer* buffer : buffers.readable(options.outputs)) {
    if (buffer->copied()) commands.copy(buffer->device, buffer->readback, buffer->device.size());
  }
  commands.barrier(gpu::Access::kCopy, gpu::Access::kHostRead);
  commands.barrier(gpu::Access::kKernel, gpu::Access::kHostRead);
  commands.end();
  return commands;
}

// Brackets of the load search: between all objects just clear of the sensor and all of them past its skin.
void Simulator::Impl::startSearch() {
  const Model::Impl& m = *model.impl();
  constexpr float kClearance = 1e-6f;  // m
  const std::span<const layout::PoseRecord> poses = buffers.poses.mappedAs<layout::PoseRecord>();
  const std::span<layout::LoadRecord> loads = buffers.loads.mappedAs<layout::LoadRecord>();
  const auto slots = static_cast<std::size_t>(options.num_slots);
  for (std::size_t i = 0; i < loads.size(); ++i) {
    loads[i] = {{0.0f, 0.0f, 0.0f, layout::kLoadSearching}, {0.0f, 0.0f, 0.0f, 0.0f}};
    if ((records()[i].keys.w & layout::kFlagLoadDriven) == 0) continue;
    float low = std::numeric_limits<float>::infinity();
    float high = -low;
    for (std::size_t slot = 0; slot < slots; ++slot) {
      const layout::PoseRecord& pose = poses[i * slots + slot];
      if (pose.object.x < 0) continue;
      const Bounds& bounds = m.bounds[static_cast<std::size_t>(pose.object.x)];
      float center = pose.row2.w;
      float half = 0;
      for (int axis = 0; axis < 3; ++axis) {
        center += pose.row2[axis] * static_cast<float>(bounds.min[axis] + bounds.max[axis]) / 2;
        half += std::abs(pose.row2[axis]) * static_cast<float>(bounds.max[axis] - bounds.min[axis]) / 2;
      }
      low = std::min(low, center - half);
      high = std::max(high, center + half);
    }
    if (low > high) continue;  // nothing to press with: the first evaluation finds no force at any offset
    const float up = m.packed.highest - low + kClearance;
    const float down = m.packed.lowest - static_cast<float>(m.sensor.skin.thickness) * 2 - high;
    loads[i].bracket = {0.5f * (up + down), down, up, layout::kLoadSearching};
    loads[i].forces.x = std::numeric_limits<float>::max();
  }
}

FrameView Simulator::Impl::view() const {
  const auto n = static_cast<std::size_t>(options.num_instances);
  const std::span<const float> features = buffers.features.read<float>();
  const auto block = [&](std::uint32_t first, std::size_t components = 1) { return features.subspan(first * n, components * n); };
  const auto fill = [&](FeatureView& view, std::uint32_t start) {
    view.total_force = block(start + layout::kFeatureTotalForce);
    view.peak_force = block(start + layout::kFeaturePeakForce);
    view.center_of_pressure = block(start + layout::kFeatureCenterOfPressure, 3);
    view.second_moments = block(start + layout::kFeatureSecondMoments, 3);
    view.eigenvalues = block(start + layout::kFeatureEigenvalues, 2);
    view.edge_angle = block(start + layout::kFeatureEdgeAngle);
    view.edge_confidence = block(start + layout::kFeatureEdgeConfidence);
    view.contact_area = block(start + layout::kFeatureContactArea);
  };
  FrameView frame;
  fill(frame, 0);
  fill(frame.ground_truth, layout::kNumImageFeatures);
  const std::size_t taxels = model.impl()->num_taxels;
  frame.tactile_image = buffers.image.read<std::uint32_t>().first(n * taxels);
  frame.saturated = block(layout::kFeatureSaturated);
  GroundTruthView& truth = frame.ground_truth;
  if (options.outputs.tactile_normal_force) truth.tactile_normal_force = buffers.spread_normal.read<float>().first(n * taxels);
  if (options.outputs.tactile_shear_force) truth.tactile_shear_force = buffers.spread_shear.read<float>().first(2 * n * taxels);
  if (options.outputs.penetration_depth) truth.penetration_depth = buffers.contact_depth.read<float>().first(n * taxels);
  truth.contact_wrench = block(layout::kFeatureContactWrench, 6);
  truth.over_penetration = block(layout::kFeatureOverPenetration);
  truth.load_offset = block(layout::kFeatureLoadOffset);
  truth.load_reached = block(layout::kFeatureLoadReached);
  return frame;
}

Simulator::Simulator(const Model& model, const SimulatorOptions& options) : impl_(std::make_unique<Impl>(model, options)) {}
Simulator::~Simulator() = default;
Simulator::Simulator(Simulator&&) noexcept = default;
Simulator& Simulator::operator=(Simulator&&) noexcept = default;

MemoryPlan Simulator::plan(const Model& model, const SimulatorOptions& options) {
  return planBatch(*model.impl(), options);
}

int Simulator::numInstances() const {
  return impl_->options.num_instances;
}
const Model& Simulator::model() const {
  return impl_->model;
}

void Simulator::setObjects(std::span<const int> ids, std::span<const Pose> X_SO) {
  const auto slots = static_cast<std::size_t>(impl_->options.num_slots);
  const auto n = static_cast<std::size_t>(impl_->options.num_instances);
  checkLength("ids", ids.size(), n * slots);
  checkLength("X_SO", X_SO.size(), n * slots);
  // All are checked before any is taken, so that a refusal changes nothing.
  const auto num_objects = static_cast<int>(impl_->model.objects().size());
  for (std::size_t i = 0; i < ids.size(); ++i) checkSlot(ids[i], X_SO[i], i / slots, num_objects);
  layout::PoseRecord* records = impl_->buffers.poses.mappedAs<layout::PoseRecord>().data();
  for (std::size_t i = 0; i < ids.size(); ++i) records[i] = packPose(ids[i], X_SO[i]);
}

void Simulator::setObjects(int instance, std::span<const int> ids, std::span<const Pose> X_SO) {
  const auto slots = static_cast<std::size_t>(impl_->options.num_slots);
  impl_->checkInstance(instance);
  checkLength("ids", ids.size(), slots);
  checkLength("X_SO", X_SO.size(), slots);
  const auto i = static_cast<std::size_t>(instance);
  const auto num_objects = static_cast<int>(impl_->model.objects().size());
  for (std::size_t slot = 0; slot < slots; ++slot) checkSlot(ids[slot], X_SO[slot], i, num_objects);
  layout::PoseRecord* records = impl_->buffers.poses.mappedAs<layout::PoseRecord>().data() + i * slots;
  for (std::size_t slot = 0; slot < slots; ++slot) records[slot] = packPose(ids[slot], X_SO[slot]);
}

void Simulator::setLoads(std::span<const float> loads) {
  checkLength("loads", loads.size(), static_cast<std::size_t>(impl_->options.num_instances));
  for (std::size_t i = 0; i < loads.size(); ++i) setLoad(static_cast<int>(i), loads[i]);
}

void Simulator::setLoad(int instance, float load) {
  impl_->checkInstance(instance);
  if (load < 0 || std::isinf(load))
    refuse("load of instance " + std::to_string(instance) + ": " + std::to_string(load) + " is not allowed: N, >= 0");
  impl_->records()[static_cast<std::size_t>(instance)].drive.x = load;
}

void Simulator::reset(int instance, std::uint64_t episode, const ReadoutVariation& variation) {
  impl_->checkInstance(instance);
  const auto finite_from = [](float value, float low) { return value >= low && !std::isinf(value); };
  if (!finite_from(variation.gain, 0) || !finite_from(variation.gain_spread, 0) || !finite_from(variation.noise, 0)) {
    refuse("variation of instance " + std::to_string(instance) + ": gain, gain_spread and noise must be finite and >= 0");
  }
  layout::InstanceRecord& record = impl_->records()[static_cast<std::size_t>(instance)];
  record.drive = {record.drive.x, variation.gain, variation.gain_spread, variation.noise};
  record.keys.x = static_cast<std::uint32_t>(episode);
  record.keys.y = static_cast<std::uint32_t>(episode >> 32);
  impl_->clocks[static_cast<std::size_t>(instance)] = {};
}

void Simulator::step(double dt) {
  if (!(dt > 0) || std::isinf(dt)) refuse("dt: " + std::to_string(dt) + " is not allowed: s, > 0");
  Impl& impl = *impl_;
  const Model::Impl& m = *impl.model.impl();
  const std::uint64_t seed = impl.options.seed;
  impl.buffers.step.mappedAs<layout::StepRecord>()[0] = {
      {static_cast<std::uint32_t>(impl.options.num_instances), static_cast<std::uint32_t>(impl.options.num_slots),
       static_cast<std::uint32_t>(seed), static_cast<std::uint32_t>(seed >> 32)},
      {static_cast<float>(dt), static_cast<float>(1 / dt), 0.0f, 0.0f}};
  bool any_load = false;
  bool any_random = impl.model.sensor().readout.noise > 0;
  const double rate = impl.model.sensor().frame_rate;
  const std::span<layout::InstanceRecord> records = impl.records();
  for (std::size_t i = 0; i < impl.clocks.size(); ++i) {
    Clock& clock = impl.clocks[i];
    std::uint32_t flags = 0;
    if (clock.first_step) flags |= layout::kFlagFirstStep;
    if (!std::isnan(records[i].drive.x)) flags |= layout::kFlagLoadDriven;
    any_load = any_load || (flags & layout::kFlagLoadDriven) != 0;
    any_random = any_random || records[i].drive.z > 0 || records[i].drive.w > 0;
    records[i].keys.z = clock.frames;
    if (clock.frameDue(rate)) {
      flags |= layout::kFlagNewFrame;
      clock.deliver(rate);
    }
    records[i].keys.w = flags;
    clock.first_step = false;
    clock.time += dt;
  }
  if (any_load && !m.packed.searches_in_tile) impl.startSearch();
  impl.running = &impl.commands(any_load, any_random);
  impl.running->submit();
}

FrameView Simulator::read() {
  Impl& impl = *impl_;
  if (impl.running != nullptr) {
    impl.running->wait();
    impl.timing = {impl.running->seconds(0, 1), impl.running->seconds(1, 2), impl.running->seconds(0, 2)};
    impl.running = nullptr;
    if (impl.buffers.problems.read<std::uint32_t>()[0] != 0) {
      throw Error(ErrorKind::kDevice,
                  "the driver cut loops of a kernel short (software Vulkan stops after 65,535 turns), so this frame is incomplete; "
                  "use simpler meshes, fewer samples, or a larger contact_workgroup");
    }
  }
  return impl.view();
}

StepTiming Simulator::timing() const {
  return impl_->timing;
}

}  // namespace taxelsim
