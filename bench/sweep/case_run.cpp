#include "sweep/case_run.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstdio>
#include <memory>
#include <string_view>

#include "report.h"
#include "sweep/trial.h"
#include "taxelsim/error.h"

namespace taxelsim::bench {
namespace {

constexpr std::string_view kOutOfMemory = "out of memory";
constexpr std::string_view kDeviceLost = "the device was lost";

double deviceSeconds(const FrameTime& time) {
  return std::isnan(time.device) ? time.wall : time.device;
}

// A trial with the largest batch, up to the requested one, that fits on the device.
std::unique_ptr<Trial> largestTrial(const Device& device, const SweepCase& work, const Batch& batch, CaseResult& result) {
  for (;; result.num_instances /= 2) {
    try {
      return std::make_unique<Trial>(device, work, batch, result.num_instances, std::nullopt);
    } catch (const Error& error) {
      if (!std::string_view(error.what()).starts_with(kOutOfMemory) || result.num_instances == 1) throw;
      result.cut = error.what();
    }
  }
}

void sizeBatch(const Device& device, const SweepCase& work, const CaseOptions& options, CaseResult& result) {
  const int wanted = options.most_instances > 0 ? std::min(options.most_instances, work.num_instances) : work.num_instances;
  const std::uint64_t most = Trial::mostInstances(device, work);
  if (most == 0) throw Error(ErrorKind::kInput, work.name + ": not one instance fits into the device");
  result.num_instances = wanted;
  if (most >= static_cast<std::uint64_t>(wanted)) return;
  result.num_instances = static_cast<int>(std::bit_floor(most));
  result.cut = "the device's memory and buffers hold " + std::to_string(most) + " instances of " + std::to_string(wanted);
}

OutputHashes hashesOf(const SweepCase& work, const Batch& batch, const Outputs& outputs) {
  std::vector<std::uint32_t> inputs;
  const auto add = [&](double value) { inputs.push_back(std::bit_cast<std::uint32_t>(static_cast<float>(value))); };
  if (const Mesh* mesh = std::get_if<Mesh>(&work.object.shape)) {
    for (const auto& vertex : mesh->vertices) std::for_each(vertex.begin(), vertex.end(), add);
  }
  for (std::size_t i = 0; i < kChecked; ++i) {
    std::for_each(batch.X_SO[i].position.begin(), batch.X_SO[i].position.end(), add);
    std::for_each(batch.X_SO[i].rotation.begin(), batch.X_SO[i].rotation.end(), add);
  }
  return {.inputs = hashOf(inputs),
          .tactile_image = hashOf(outputs.tactile_image),
          .floats = hashOfFloats(outputs),
          .instances = hashesOfImages(outputs)};
}

std::string timeText(const CaseResult& result, const FrameTime& time) {
  char text[128];
  const double scale = 1e6 / result.num_instances;
  std::snprintf(text, sizeof text, "%.4g us a frame (contact %.4g, image %.4g, wall %.4g)", deviceSeconds(time) * scale,
                time.contact * scale, time.image * scale, time.wall * scale);
  return text;
}

// Times both ends of the descent in turns, so that thermal throttling affects both.
void runTurns(const DeviceInfo& device, Trial& chosen, Trial& best, int repetitions, CaseResult& result) {
  warmUp(device, [&] { chosen.frame(); });
  std::vector<FrameTime> chosen_times, best_times;
  std::vector<double> gains;
  for (int r = -2; r < repetitions; ++r) {
    const FrameTime of_chosen = chosen.frame(), of_best = best.frame();
    if (r < 0) continue;
    chosen_times.push_back(of_chosen);
    best_times.push_back(of_best);
    gains.push_back(deviceSeconds(of_chosen) / deviceSeconds(of_best));
  }
  result.chosen_time = medianOf(chosen_times);
  result.best_time = medianOf(best_times);
  result.gain = summarise(gains).median;
}

}  // namespace

double taxelsPerSecond(const SweepCase& work, const CaseResult& result, const FrameTime& time) {
  return static_cast<double>(numTaxels(work.sensor)) * result.num_instances / deviceSeconds(time);
}

double microsecondsPerFrame(const CaseResult& result, const FrameTime& time) {
  return deviceSeconds(time) / result.num_instances * 1e6;
}

CaseResult runCase(const Device& device, const SweepCase& work, const CaseOptions& options, const Progress& progress) {
  CaseResult result;
  sizeBatch(device, work, options, result);
  const Batch batch = batchOf(work, result.num_instances);
  std::unique_ptr<Trial> trial = largestTrial(device, work, batch, result);
  if (!result.cut.empty()) progress(std::to_string(result.num_instances) + " instances only: " + result.cut);
  result.chosen = result.best = trial->setting();
  const Outputs expected_checked = copyOf(trial->checked(), kChecked);
  result.hashes = hashesOf(work, batch, expected_checked);
  result.chosen_time = result.best_time = timeOf(device.info(), *trial, options.repetitions);
  const Outputs expected = copyOf(trial->timed(), result.num_instances);
  for (const auto& [name, values] : expected.floats) {
    if (name == "ground_truth.total_force")
      result.without_force = static_cast<int>(std::count_if(values.begin(), values.end(), [](float force) { return !(force > 0); }));
  }
  if (2 * result.without_force > result.num_instances) {
    throw Error(ErrorKind::kDevice, work.name + ": " + std::to_string(result.without_force) + " of " +
                                        std::to_string(result.num_instances) + " frames are without force: nothing was simulated");
  }
  progress("as chosen: " + timeText(result, result.chosen_time));

  const auto measure = [&](const Setting& setting) -> std::optional<FrameTime> {
    Tried tried{.setting = setting, .time = {}, .refused = {}, .difference = {}};
    try {
      trial.reset();  // frees the memory of the previous batch
      trial = std::make_unique<Trial>(device, work, batch, result.num_instances, setting);
      tried.difference = firstDifference(expected_checked, trial->checked());
      tried.time = timeOf(device.info(), *trial, options.repetitions);
      if (tried.difference.empty()) tried.difference = firstDifference(expected, trial->timed());
    } catch (const Error& error) {
      if (std::string_view(error.what()).starts_with(kDeviceLost)) throw;
      tried.refused = error.what();
    }
    std::string outcome = tried.refused.empty() ? timeText(result, tried.time) : "refused: " + tried.refused;
    if (!tried.difference.empty()) outcome += "; DIFFERS in " + tried.difference;
    progress(differenceText(setting, result.chosen) + ": " + outcome);
    result.tried.push_back(tried);
    return tried.refused.empty() && tried.difference.empty() ? std::optional(tried.time) : std::nullopt;
  };
  Descent descent = options.descent;
  // Groups exist for clusters only.
  if (!work.has_clusters) std::erase(descent.over, static_cast<std::size_t>(kGroupsPerBatch));
  result.best = descend(result.chosen, result.chosen_time, descent, measure);
  if (result.best == result.chosen) return result;
  try {
    trial.reset();
    Trial chosen(device, work, batch, result.num_instances, result.chosen), best(device, work, batch, result.num_instances, result.best);
    runTurns(device.info(), chosen, best, options.repetitions, result);
  } catch (const Error& error) {
    if (!std::string_view(error.what()).starts_with(kOutOfMemory)) throw;
    for (const Tried& tried : result.tried) {
      if (tried.setting == result.best) result.best_time = tried.time;
    }
    result.gain = deviceSeconds(result.chosen_time) / deviceSeconds(result.best_time);
    progress("no room for two batches: the gain is from the descent, not from turns");
  }
  if (result.gain < 1 + options.descent.least_gain) {
    progress("in turns no faster than as chosen: " + differenceText(result.best, result.chosen));
    result.best = result.chosen;
    result.best_time = result.chosen_time;
    result.gain = 1;
    return result;
  }
  progress("best: " + differenceText(result.best, result.chosen) + ": " + timeText(result, result.best_time));
  return result;
}

}  // namespace taxelsim::bench
