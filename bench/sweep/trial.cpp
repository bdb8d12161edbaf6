#include "sweep/trial.h"

#include <algorithm>
#include <chrono>
#include <span>

#include "report.h"

namespace taxelsim::bench {
namespace {

constexpr double kDt = 1e-3;  // s
constexpr std::uint64_t kPoseSeed = 1;

using Clock = std::chrono::steady_clock;

double secondsSince(Clock::time_point start) {
  return std::chrono::duration<double>(Clock::now() - start).count();
}

Model modelOf(const Device& device, const SweepCase& work, const std::optional<Setting>& setting) {
  const ModelOptions options{.sensor = work.sensor, .objects = {work.object}};
  return setting ? modelWith(device, options, *setting) : Model(device, options);
}

// Counts and features, as in bench/peers; with forces for the checked batch.
SimulatorOptions optionsOf(int num_instances, bool with_forces) {
  return {.num_instances = num_instances,
          .outputs = {.tactile_normal_force = with_forces, .tactile_shear_force = false, .penetration_depth = false},
          .device_clock = !with_forces};
}

void place(Simulator& simulator, const Batch& batch) {
  const auto n = static_cast<std::size_t>(simulator.numInstances());
  simulator.setObjects(std::span(batch.ids).first(n), std::span(batch.X_SO).first(n));
}

}  // namespace

Batch batchOf(const SweepCase& work, int num_instances) {
  const int count = std::max(num_instances, kChecked);
  return {.ids = std::vector<int>(static_cast<std::size_t>(count), 0), .X_SO = randomPoses(work.object, work.spread, count, kPoseSeed)};
}

Trial::Trial(const Device& device, const SweepCase& work, const Batch& batch, int num_instances, const std::optional<Setting>& setting) {
  const Model model = modelOf(device, work, setting);
  setting_ = settingOf(model);
  timed_.emplace(model, optionsOf(num_instances, false));
  checked_.emplace(model, optionsOf(kChecked, true));
  place(*timed_, batch);
  place(*checked_, batch);
}

std::uint64_t Trial::mostInstances(const Device& device, const SweepCase& work) {
  return Simulator::plan(modelOf(device, work, std::nullopt), optionsOf(1, false)).max_instances;
}

FrameTime Trial::frame() {
  const auto start = Clock::now();
  timed_->step(kDt);
  timed_->read();
  const double wall = secondsSince(start);
  const StepTiming timing = timed_->timing();
  return {.contact = timing.contact, .image = timing.image, .device = timing.total, .wall = wall};
}

FrameView Trial::checked() {
  checked_->step(kDt);
  return checked_->read();
}

FrameTime timeOf(const DeviceInfo& device, Trial& trial, int repetitions) {
  for (int k = 0; k < 2; ++k) trial.frame();
  warmUp(device, [&] { trial.frame(); });
  std::vector<FrameTime> times;
  for (int r = 0; r < repetitions; ++r) times.push_back(trial.frame());
  return medianOf(times);
}

FrameTime medianOf(const std::vector<FrameTime>& times) {
  const auto median = [&](double FrameTime::*part) {
    std::vector<double> seconds;
    for (const FrameTime& time : times) seconds.push_back(time.*part);
    return summarise(seconds).median;
  };
  return {.contact = median(&FrameTime::contact),
          .image = median(&FrameTime::image),
          .device = median(&FrameTime::device),
          .wall = median(&FrameTime::wall)};
}

}  // namespace taxelsim::bench
