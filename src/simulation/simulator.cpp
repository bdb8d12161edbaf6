#include "taxelsim/simulator.h"

#include <algorithm>
#include <array>
#include <atomic>
#include <cmath>
#include <optional>
#include <stdexcept>
#include <utility>

#include "base/constants.h"
#include "base/field_checks.h"
#include "base/length_check.h"
#include "base/philox.h"
#include "base/text.h"
#include "shared/batch.h"
#include "shared/features.h"
#include "simulation/batch_plan.h"
#include "simulation/frame_view.h"
#include "simulation/host_threads.h"
#include "simulation/model_access.h"
#include "simulation/pack/pack_contacts.h"
#include "simulation/simulator_access.h"
#include "simulation/simulator_impl.h"
#include "taxelsim/error.h"

namespace taxelsim {
namespace {

[[noreturn]] void refuseCall(const std::string& what) {
  throw Error(ErrorKind::kInput, what);
}

double lengthOf(const Quaternion& q) {
  return std::sqrt(q[0] * q[0] + q[1] * q[1] + q[2] * q[2] + q[3] * q[3]);
}

// Written so that NaN fails.
bool isUnitLength(double length) {
  return std::abs(length - 1) <= kQuaternionTolerance;
}

bool isAllowedSlot(int id, const Pose& X_SO, int num_objects) {
  if (id == kNoObject) return true;
  const auto& [x, y, z] = X_SO.position;
  return id >= 0 && id < num_objects && isUnitLength(lengthOf(X_SO.rotation)) && std::isfinite(x) && std::isfinite(y) && std::isfinite(z);
}

// Throws Error(kInput) for an object or a pose that a slot may not have.
void checkSlot(int id, const Pose& X_SO, std::size_t instance, int num_objects) {
  if (isAllowedSlot(id, X_SO, num_objects)) return;
  const auto where = [instance] { return " of instance " + std::to_string(instance); };
  if (id < 0 || id >= num_objects) {
    refuseCall("object " + std::to_string(id) + where() + " is not allowed: 0 to " + std::to_string(num_objects - 1) + ", or -1 for none");
  }
  const double length = lengthOf(X_SO.rotation);
  if (!isUnitLength(length)) refuseCall("rotation" + where() + ": a quaternion of length " + std::to_string(length) + " is not allowed: 1");
  refuseCall("position" + where() + " is not finite");
}

// 1 - exp(-dt / time): the step of a first-order system towards its input.
float firstOrderStep(double dt, double time) {
  return time > 0 ? static_cast<float>(-std::expm1(-dt / time)) : 1.0f;
}

}  // namespace

Simulator::Impl::Impl(const Model& shared_model, const BatchOptions& batch_options)
    : model(shared_model),
      options((checkBatchFits(implOf(shared_model).data, batch_options), batch_options)),
      buffers(shapeOf(data(), options)),
      keeps_candidates(shapeOf(data(), options).keeps_candidates),
      near(data(), takesContacts() ? 0 : static_cast<std::size_t>(options.num_instances), static_cast<std::size_t>(options.num_slots)),
      team(options.host_threads > 0 ? options.host_threads : hostThreads(shared_model.device().info().type, options.num_instances)) {
  clocks.resize(static_cast<std::size_t>(options.num_instances));
  loads.assign(clocks.size(), kPoseDriven);
  episodes.resize(clocks.size());
  flags.resize(clocks.size());
  delays.resize(clocks.size());
  are_random.resize(clocks.size());
  for (std::size_t i = 0; i < clocks.size(); ++i) vary(i, 0, {}, {});
  traffic = {};
  if (options.export_memory && data().context().exports().timelines) timeline.emplace(data().context());
  if (data().hasFriction() && !takesContacts()) motions.emplace(clocks.size(), static_cast<std::size_t>(options.num_slots));
  viewOf(data(), options, buffers.outputs(), integer_features);  // allocates the arrays of integer features, so that read() does not
}

void Simulator::Impl::checkInstance(int instance) const {
  if (instance >= 0 && instance < options.num_instances) return;
  refuseCall("instance: " + std::to_string(instance) + " is not allowed: 0 to " + std::to_string(options.num_instances - 1));
}

void Simulator::Impl::checkTakesObjects() const {
  checkTakesCalls();
  if (takesContacts()) refuseCall("this simulator takes contacts (max_contacts > 0), neither objects nor loads");
}

void Simulator::Impl::checkTakesCalls() const {
  if (places) refuseCall("this simulator takes its inputs from memory that another interface writes, not from calls");
}

void Simulator::Impl::checkTakesContacts() const {
  checkTakesCalls();
  if (!takesContacts()) refuseCall("this simulator takes no contacts: max_contacts is 0");
}

void Simulator::Impl::place(std::size_t instance, std::size_t slot, int id, const Pose& X_SO) {
  near.place(instance, slot, id, X_SO);
  if (options.loop) placed.push_back(instance);
  if (motions) motions->place(instance * static_cast<std::size_t>(options.num_slots) + slot, id, X_SO);
}

gpu::Commands& Simulator::Impl::commands(const FrameKind& kind) {
  std::optional<gpu::Commands>& list = recorded[(kind.loads ? 1u : 0u) + (kind.random ? 2u : 0u) + (kind.many_near ? 4u : 0u) +
                                                8u * static_cast<unsigned>(kind.candidates) + (kind.places ? 32u : 0u) + 64u * half];
  if (!list) list = recordFrame(implOf(model), {data(), options, keeps_candidates}, buffers, kind, near.skinBase(), half);
  return *list;
}

void Simulator::Impl::checkLoops() const {
  if (buffers.output<block::Problems>()[0] == 0) return;
  throw Error(ErrorKind::kDevice,
              "the driver cut loops of a kernel short (software Vulkan stops after 65,535 iterations), so this frame is incomplete; "
              "use simpler meshes, fewer samples or contacts, or a larger contact_workgroup or image_workgroup");
}

bool Simulator::Impl::anyRandom() const {
  return model.sensor().readout.noise > 0 || num_random > 0;
}

void Simulator::Impl::vary(std::size_t instance, std::uint64_t episode, const ReadoutVariation& variation, const SkinVariation& skin) {
  const Readout& readout = model.sensor().readout;
  float gain = variation.gain;
  if (readout.press_gain_spread > 0) {
    const double drawn = gaussian({.seed = options.seed, .episode = episode, .purpose = Purpose::kPressGain});
    gain *= static_cast<float>(std::exp(readout.press_gain_spread * drawn));
  }
  float spread = variation.gain_spread;
  if (readout.gain_spread > 0) spread = static_cast<float>(std::hypot(readout.gain_spread, variation.gain_spread));
  episodes[instance] = episode;
  delays[instance] = skin.delay;
  num_random -= are_random[instance];
  are_random[instance] = spread > 0 || variation.noise > 0;
  num_random += are_random[instance];
  layout::InstanceRecord record{};
  record.drive = {loads[instance], gain, spread, variation.noise};
  record.skin = {skin.stiffness, skin.friction, skin.trigger, skin.hysteresis};
  record.spread = {skin.psf_width * skin.psf_width, skin.delay, skin.trigger_spread, 0.0f};
  for (std::size_t k = 0; k < (options.export_memory ? 2u : 1u); ++k) buffers.input<block::Instances>(k)[instance] = record;
  traffic.bytes_to_device += sizeof(record);
}

float Simulator::Impl::longestDelay() const {
  return options.vary_skin ? *std::max_element(delays.begin(), delays.end()) : 1;
}

layout::StepRecord Simulator::Impl::stepRecord(double dt, const Selection& selection) {
  const Readout& readout = model.sensor().readout;
  constexpr double kRounding = 5e-10;  // for a delay of exactly kMaxDelaySteps steps; less than the tolerance of StepHistory
  const double longest = readout.delay * longestDelay();
  if (longest > kMaxDelaySteps * dt * (1 + kRounding)) {
    refuseCall("readout.delay: " + numberText(longest) + " is not allowed: s, at most " + std::to_string(kMaxDelaySteps) + " steps of " +
               numberText(dt) + " s (" + numberText(kMaxDelaySteps * dt) + " s); shorten it or take longer steps");
  }
  layout::StepRecord record{};
  record.batch = {static_cast<std::uint32_t>(options.num_instances),
                  static_cast<std::uint32_t>(takesContacts() ? options.max_contacts : options.num_slots),
                  static_cast<std::uint32_t>(options.seed), static_cast<std::uint32_t>(options.seed >> 32)};
  record.time = {static_cast<float>(dt), static_cast<float>(1 / dt), firstOrderStep(dt, readout.low_pass_time),
                 static_cast<float>(readout.random_walk * std::sqrt(dt))};
  for (std::size_t m = 0; m < readout.creep.size(); ++m) record.creep[static_cast<int>(m)] = firstOrderStep(dt, readout.creep[m].time);
  const std::array<float, 4> law = transitionOf(model.sensor().skin.law, dt);
  record.law = {law[0], law[1], law[2], law[3]};
  record.contacts.x = static_cast<float>(options.contact_band);
  packRelaxation(model.sensor().skin.relaxation, dt, record);
  if (selection.isAll()) {
    history.add(dt);
    record.delay = {num_steps++ % kMaxDelaySteps, history.stepsBack(readout.delay), 0u, 0u};
  } else {
    // First frames of episodes, which no delayed force precedes. They take the slot of the last step of all instances, so that the next
    // such step follows both these frames and those of the instances that are held.
    StepHistory first = history;
    first.add(dt);
    record.delay = {(num_steps + kMaxDelaySteps - 1) % kMaxDelaySteps, first.stepsBack(readout.delay), 0u, 0u};
  }
  return record;
}

Simulator::Simulator(const Model& model, const SimulatorOptions& options)
    : Simulator(std::make_unique<Impl>(model, BatchOptions{options})) {}
Simulator::Simulator(std::unique_ptr<Impl> impl) : impl_(std::move(impl)) {}
Simulator::~Simulator() = default;
Simulator::Simulator(Simulator&&) noexcept = default;
Simulator& Simulator::operator=(Simulator&&) noexcept = default;

Simulator SimulatorAccess::make(const Model& model, const BatchOptions& options) {
  return Simulator(std::make_unique<Simulator::Impl>(model, options));
}

ThreadTeam& SimulatorAccess::team(Simulator& simulator) {
  return simulator.impl_->team;
}

MemoryPlan Simulator::plan(const Model& model, const SimulatorOptions& options) {
  return planBatch(implOf(model).data, {options});
}

int Simulator::numInstances() const {
  return impl_->options.num_instances;
}
const Model& Simulator::model() const {
  return impl_->model;
}

void Simulator::setObjects(std::span<const int> ids, std::span<const Pose> X_SO) {
  impl_->checkTakesObjects();
  const auto slots = static_cast<std::size_t>(impl_->options.num_slots);
  const auto n = static_cast<std::size_t>(impl_->options.num_instances);
  checkLength("ids", ids.size(), n * slots);
  checkLength("X_SO", X_SO.size(), n * slots);
  // All are checked before any is written, so that an error changes nothing.
  const auto num_objects = static_cast<int>(impl_->model.objects().size());
  std::atomic<bool> all_allowed = true;
  impl_->team.run(static_cast<int>(n), [&](int first, int last) {
    for (std::size_t k = static_cast<std::size_t>(first) * slots; k < static_cast<std::size_t>(last) * slots; ++k) {
      if (!isAllowedSlot(ids[k], X_SO[k], num_objects)) all_allowed = false;
    }
  });
  for (std::size_t k = 0; k < n * slots && !all_allowed; ++k) checkSlot(ids[k], X_SO[k], k / slots, num_objects);
  impl_->team.run(static_cast<int>(n), [&](int first, int last) {
    impl_->near.placeAll(ids, X_SO, static_cast<std::size_t>(first), static_cast<std::size_t>(last));
  });
  if (impl_->motions) {
    for (std::size_t k = 0; k < ids.size(); ++k) impl_->motions->place(k, ids[k], X_SO[k]);
  }
}

void Simulator::setObjects(int instance, std::span<const int> ids, std::span<const Pose> X_SO) {
  impl_->checkTakesObjects();
  const auto slots = static_cast<std::size_t>(impl_->options.num_slots);
  impl_->checkInstance(instance);
  checkLength("ids", ids.size(), slots);
  checkLength("X_SO", X_SO.size(), slots);
  const auto i = static_cast<std::size_t>(instance);
  const auto num_objects = static_cast<int>(impl_->model.objects().size());
  for (std::size_t slot = 0; slot < slots; ++slot) checkSlot(ids[slot], X_SO[slot], i, num_objects);
  for (std::size_t slot = 0; slot < slots; ++slot) impl_->place(i, slot, ids[slot], X_SO[slot]);
}

void Simulator::setLoads(std::span<const float> loads) {
  checkLength("loads", loads.size(), static_cast<std::size_t>(impl_->options.num_instances));
  for (std::size_t i = 0; i < loads.size(); ++i) setLoad(static_cast<int>(i), loads[i]);
}

void Simulator::setLoad(int instance, float load) {
  impl_->checkTakesObjects();
  impl_->checkInstance(instance);
  if (!std::isnan(load) && std::holds_alternative<Proximity>(impl_->model.sensor().skin.law)) {
    refuseCall("load of instance " + std::to_string(instance) +
               ": the contact law proximity has no forces, so it cannot be driven by load");
  }
  if (load < 0 || std::isinf(load))
    refuseCall("load of instance " + std::to_string(instance) + ": " + std::to_string(load) + " is not allowed: N, >= 0");
  if (impl_->data().layer && !std::isnan(load) && !impl_->data().packed.searches_in_tile) {
    refuseCall("load of instance " + std::to_string(instance) + ": " + std::to_string(load) +
               " is not allowed: none, where a skin with a globally coupled law does not face along z of the sensor frame");
  }
  impl_->ownInputs();
  impl_->loads[static_cast<std::size_t>(instance)] = load;
  impl_->buffers.input<block::Instances>(impl_->half)[static_cast<std::size_t>(instance)].drive.x = load;
  impl_->traffic.bytes_to_device += sizeof(load);
}

void Simulator::Impl::takeContacts(std::size_t instance, std::span<const ContactPoint> contacts) {
  ownInputs();
  const auto room = static_cast<std::size_t>(options.max_contacts);
  const std::span<layout::ContactRecord> packed = buffers.input<block::Contacts>().subspan(instance * room, room);
  for (std::size_t k = 0; k < contacts.size(); ++k) packed[k] = packContact(contacts[k]);
  buffers.input<block::NumContacts>()[instance] = static_cast<std::uint32_t>(contacts.size());
  traffic.bytes_to_device += contacts.size() * sizeof(layout::ContactRecord) + sizeof(std::uint32_t);
}

void Simulator::setContacts(std::span<const ContactPoint> contacts, std::span<const int> offsets) {
  impl_->checkTakesContacts();
  const auto n = static_cast<std::size_t>(impl_->options.num_instances);
  checkLength("offsets", offsets.size(), n + 1);
  checkOffsets(offsets, contacts.size());
  const auto of_instance = [&](std::size_t i) {
    return contacts.subspan(static_cast<std::size_t>(offsets[i]), static_cast<std::size_t>(offsets[i + 1] - offsets[i]));
  };
  for (std::size_t i = 0; i < n; ++i) checkContacts(of_instance(i), i, impl_->options.max_contacts);
  for (std::size_t i = 0; i < n; ++i) impl_->takeContacts(i, of_instance(i));
}

void Simulator::setContacts(int instance, std::span<const ContactPoint> contacts) {
  impl_->checkTakesContacts();
  impl_->checkInstance(instance);
  checkContacts(contacts, static_cast<std::size_t>(instance), impl_->options.max_contacts);
  impl_->takeContacts(static_cast<std::size_t>(instance), contacts);
}

void Simulator::reset(int instance, std::uint64_t episode, const ReadoutVariation& variation, const SkinVariation& skin) {
  impl_->checkInstance(instance);
  const auto finite_from = [](float value, float low) { return value >= low && !std::isinf(value); };
  if (!finite_from(variation.gain, 0) || !finite_from(variation.gain_spread, 0) || !finite_from(variation.noise, 0)) {
    refuseCall("variation of instance " + std::to_string(instance) + ": gain, gain_spread and noise must be finite and >= 0");
  }
  if (!(skin == SkinVariation{})) {
    if (!impl_->options.vary_skin) refuseCall("skin of instance " + std::to_string(instance) + ": a variation needs the option vary_skin");
    checkBelow("skin of instance " + std::to_string(instance), [&] { checkVariation(impl_->model.sensor(), skin); });
  }
  impl_->ownInputs();
  impl_->vary(static_cast<std::size_t>(instance), episode, variation, skin);
  impl_->clocks[static_cast<std::size_t>(instance)] = {};
  if (impl_->motions) impl_->motions->forget(static_cast<std::size_t>(instance));
}

std::vector<FrameKind> Simulator::Impl::kinds(bool with_loads) const {
  const bool random = anyRandom();
  std::vector<FrameKind> kinds{{.random = random}};
  if (with_loads) kinds.push_back({.loads = true, .random = random});
  if (keeps_candidates) {
    for (const auto candidates : {FrameKind::Candidates::kKept, FrameKind::Candidates::kUsed})
      kinds.push_back({.random = random, .candidates = candidates});
  }
  if (options.num_slots > 1) {
    for (std::size_t k = 0; k < (with_loads ? 2u : 1u); ++k) {
      kinds.push_back({.loads = kinds[k].loads, .random = random, .many_near = true});
    }
  }
  for (FrameKind& kind : kinds) kind.places = places;
  return kinds;
}

void Simulator::prepare(bool loads) {
  impl_->takes_loads = loads;
  const std::vector<FrameKind> kinds = impl_->kinds(loads);
  for (const FrameKind& kind : kinds) impl_->commands(kind);  // the kernels of all are compiled at once
  if (impl_->options.outputs.vjp) impl_->gradientCommands(false).finish();
  for (const FrameKind& kind : kinds) impl_->commands(kind).finish();
}

void Simulator::Impl::finish(std::size_t frame_half) {
  const Running frame = std::exchange(running[frame_half], {});
  if (frame.commands == nullptr) return;
  frame.commands->wait();
  const std::span<const glm::uvec4> work = buffers.output<block::Work>();
  const std::uint32_t num_coherent = frame.keeping ? work[layout::kListCandidates].w : 0;
  const auto seconds = [&](std::uint32_t from, std::uint32_t to) { return frame.commands->seconds(from, to); };
  timing = {seconds(0, 1), seconds(1, 2), seconds(0, 2), static_cast<int>(num_coherent)};
  if (frame.keeping) {
    any_candidates = work[layout::kNumLists].x > 0;
    candidate_schedule.found(any_candidates);
  }
  checkLoops();
  has_frame = true;
  checkInputs(frame_half);
}

FrameView Simulator::read() {
  impl_->finish();
  return viewOf(impl_->data(), impl_->options, impl_->buffers.outputs(), impl_->integer_features);
}

StepTiming Simulator::timing() const {
  return impl_->timing;
}

DeviceTraffic Simulator::traffic() const {
  return impl_->traffic;
}

}  // namespace taxelsim
