// Cost of a frame by contact law, with shear, readout stages, contact features and the tactile Jacobian, relative to `winkler` on the same
// poses, and of any two of these options together; and the least time that the bytes and operations of each take (option_limits.h). One
// process, in turns, so that other load on the machine affects all cases.
#include <CLI/CLI.hpp>
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "bench_objects.h"
#include "frame_counts.h"
#include "law_cases.h"
#include "option_limits.h"
#include "report.h"
#include "taxelsim/error.h"
#include "taxelsim/simulator.h"

namespace taxelsim::bench {
namespace {

constexpr std::uint64_t kPoseSeed = 1;
constexpr int kWarmUps = 2;
constexpr int kMostCounted = 512;  // instances whose frames are counted for the limits; all poses have one distribution
constexpr double kStride = 1e-5;   // m, along x, back and forth between frames: a slow slide that exercises the states

struct Options {
  std::string sensor = TAXELSIM_BENCH "/sensors/wts0614.yaml";
  std::string json, device, only;
  int num_instances = 512;
  int repetitions = 11;
  bool pairs = false;
  double bandwidth = MachineRates{}.bandwidth / 1e9, arithmetic = MachineRates{}.arithmetic / 1e9;  // GB/s, GFLOP/s
};

MachineRates ratesOf(const Options& options) {
  return {.bandwidth = options.bandwidth * 1e9, .arithmetic = options.arithmetic * 1e9};
}

std::vector<Pose> slid(std::vector<Pose> X_SO) {
  for (Pose& pose : X_SO) pose.position[0] += kStride;
  return X_SO;
}

// A batch under one law.
class Run {
 public:
  Run(const Device& device, const LawCase& work, Sensor sensor, const Object& object, const std::vector<Pose>& X_SO)
      : name_(work.name), cold_(work.cold), sensor_(std::move(sensor)), ids_(X_SO.size(), 0), here_(X_SO), there_(slid(X_SO)) {
    work.change(sensor_);
    const Model model(device, {.sensor = sensor_, .objects = {object}});
    options_ = {.num_instances = static_cast<int>(X_SO.size()),
                .outputs = {.tactile_normal_force = false,
                            .tactile_shear_force = false,
                            .penetration_depth = false,
                            .contact_features = work.max_regions >= 0,
                            .tactile_jacobian = work.jacobian},
                .max_regions = std::max(work.max_regions, 0)};
    simulator_.emplace(model, options_);
  }

  // Computes a frame; returns the seconds from poses to features.
  double frame() {
    std::swap(here_, there_);
    if (cold_) {
      for (std::size_t i = 0; i < ids_.size(); ++i) simulator_->reset(static_cast<int>(i), i);
    }
    const Stopwatch watch;
    simulator_->setObjects(ids_, here_);
    simulator_->step(kLawCaseStep);
    const FrameView frame = simulator_->read();
    const double seconds = watch.seconds();
    for (const float force : frame.ground_truth.total_force) blank_ += !(force > 0);
    for (const float residual : frame.ground_truth.contact_residual) {
      largest_residual_ = std::max(largest_residual_, static_cast<double>(residual));
    }
    const auto mean = [&](const auto& counts) {
      double sum = 0;
      for (const auto count : counts) sum += count;
      return sum / static_cast<double>(ids_.size());
    };
    measured_.iterations = mean(frame.ground_truth.contact_iterations);
    measured_.regions = mean(frame.contact.num_regions);
    measured_.reporting_taxels =
        static_cast<double>(frame.tactile_image.size() -
                            static_cast<std::size_t>(std::count(frame.tactile_image.begin(), frame.tactile_image.end(), 0u))) /
        static_cast<double>(ids_.size());
    return seconds;
  }

  // Bytes and operations of its frames.
  std::vector<StageWork> work(const FrameCounts& counts) const {
    return frameWork(sensor_, options_.outputs, options_.max_regions, counts);
  }

  // Nothing where FrameCounter counts nothing.
  std::optional<FrameCounts> counts(FrameCounter& counter) const {
    std::optional<FrameCounts> counts = counter.count(sensor_);
    if (!counts) return {};
    counts->iterations = measured_.iterations;
    counts->regions = measured_.regions;
    counts->reporting_taxels = measured_.reporting_taxels;
    return counts;
  }

  const std::string& name() const { return name_; }
  std::size_t blank() const { return blank_; }
  double largestResidual() const { return largest_residual_; }
  double iterations() const { return measured_.iterations; }

 private:
  std::string name_;
  bool cold_;
  Sensor sensor_;
  SimulatorOptions options_;
  std::vector<int> ids_;
  std::vector<Pose> here_, there_;
  std::optional<Simulator> simulator_;
  std::size_t blank_ = 0;  // frames without force: an error
  double largest_residual_ = 0;
  FrameCounts measured_;  // of the last frame
};

// The poses of some instances in both of their frames.
std::vector<Pose> countedPoses(const std::vector<Pose>& X_SO) {
  std::vector<Pose> poses(X_SO.begin(), X_SO.begin() + std::min<std::ptrdiff_t>(kMostCounted, std::ssize(X_SO)));
  for (const Pose& pose : slid(poses)) poses.push_back(pose);
  return poses;
}

// Adds the limit of a case's frames to its results; prints it. `per_frame`: s.
void addLimit(const Run& run, FrameCounter& counter, double per_frame, const MachineRates& rates, nlohmann::ordered_json& result) {
  const std::optional<FrameCounts> counts = run.counts(counter);
  if (!counts) return;
  const std::vector<StageWork> stages = run.work(*counts);
  const double limit = limitOf(stages, rates);
  const bool by_bytes = isBoundByBytes(stages, rates);
  std::printf(", limit %7.3f us of %-10s limit / time %5.1f %%", limit * 1e6, by_bytes ? "bytes," : "operations,", 100 * limit / per_frame);
  result["limit_seconds_per_frame"] = limit;
  result["limit_over_time"] = limit / per_frame;
  result["work_per_frame"] = toJson(stages);
  result["counts_per_frame"] = toJson(*counts);
}

nlohmann::ordered_json runObject(const Device& device, const Sensor& sensor, const Object& object, const PoseSpread& spread,
                                 const Options& options) {
  const std::vector<Pose> X_SO = randomPoses(object, spread, options.num_instances, kPoseSeed);
  std::vector<Run> runs;
  for (const LawCase& work : lawCases()) {
    if (runs.empty() || options.only.empty() || work.name == options.only) runs.emplace_back(device, work, sensor, object, X_SO);
  }
  warmUp(device.info(), [&] { runs[0].frame(); });
  std::vector<std::vector<double>> seconds(runs.size()), ratios(runs.size());
  for (int r = -kWarmUps; r < options.repetitions; ++r) {
    for (std::size_t k = 0; k < runs.size(); ++k) {
      const double taken = runs[k].frame();
      if (r < 0) continue;
      seconds[k].push_back(taken);
      ratios[k].push_back(taken / seconds[0].back());
    }
  }
  std::printf("%s\n", object.name.c_str());
  FrameCounter counter(device, object, countedPoses(X_SO));
  nlohmann::ordered_json results = nlohmann::ordered_json::array();
  for (std::size_t k = 0; k < runs.size(); ++k) {
    if (runs[k].blank() > 0)
      throw Error(ErrorKind::kDevice, runs[k].name() + ": " + std::to_string(runs[k].blank()) + " frames without force");
    const double per_frame = summarise(seconds[k]).median / options.num_instances;
    std::printf("  %-54s %8.2f us a frame, %8.0f frames/s, %6.2f times winkler", runs[k].name().c_str(), per_frame * 1e6, 1 / per_frame,
                summarise(ratios[k]).median);
    nlohmann::ordered_json result{{"case", runs[k].name()}, {"seconds", toJson(seconds[k])}, {"times_winkler", toJson(ratios[k])}};
    addLimit(runs[k], counter, per_frame, ratesOf(options), result);
    if (runs[k].iterations() > 0) std::printf("; %.1f iterations, residual at most %.2g", runs[k].iterations(), runs[k].largestResidual());
    std::printf("\n");
    if (runs[k].iterations() > 0) {
      result["mean_iterations"] = runs[k].iterations();
      result["largest_residual"] = runs[k].largestResidual();
    }
    results.push_back(std::move(result));
  }
  return {{"object", object.name}, {"cases", results}};
}

// A case timed in turns with a plain frame.
struct Compared {
  Run run;
  double times_plain;  // median of the ratios
  double per_frame;    // s, median
};

// Nothing where the library refuses the sensor.
std::optional<Compared> comparedTo(Run& plain, const DeviceInfo& device, const std::function<Run()>& makeRun, const Options& options) {
  std::optional<Run> run;
  try {
    run.emplace(makeRun());
  } catch (const Error& error) {
    if (error.kind() != ErrorKind::kInput) throw;
    return {};
  }
  warmUp(device, [&] { plain.frame(); });
  std::vector<double> seconds, ratios;
  for (int r = -kWarmUps; r < options.repetitions; ++r) {
    const double of_plain = plain.frame(), of_run = run->frame();
    if (r < 0) continue;
    seconds.push_back(of_run / options.num_instances);
    ratios.push_back(of_run / of_plain);
  }
  return Compared{.run = std::move(*run), .times_plain = summarise(ratios).median, .per_frame = summarise(seconds).median};
}

// Each option alone and with each other one, relative to `winkler`.
nlohmann::ordered_json runPairs(const Device& device, const Sensor& sensor, const Object& object, const PoseSpread& spread,
                                const Options& options) {
  const std::vector<Pose> X_SO = randomPoses(object, spread, options.num_instances, kPoseSeed);
  const std::vector<LawCase> cases = lawCases();
  Run plain(device, cases[0], sensor, object, X_SO);
  FrameCounter counter(device, object, countedPoses(X_SO));
  const auto measure = [&](const LawCase& work) {
    return comparedTo(
        plain, device.info(), [&] { return Run(device, work, sensor, object, X_SO); }, options);
  };
  std::vector<double> alone;
  for (const LawCase& work : cases) alone.push_back(work.is_paired ? measure(work).value().times_plain : 1);
  std::printf("%s, pairs of options: times winkler, and what the pair adds to a frame over the sum of what both add alone\n",
              object.name.c_str());
  nlohmann::ordered_json results = nlohmann::ordered_json::array();
  for (std::size_t i = 0; i < cases.size(); ++i) {
    for (std::size_t k = 0; k < i; ++k) {
      const std::optional<LawCase> both = bothOf(cases[k], cases[i]);
      if (!both) continue;
      const std::optional<Compared> pair = measure(*both);
      nlohmann::ordered_json result{{"options", {cases[k].name, cases[i].name}}, {"times_winkler_alone", {alone[k], alone[i]}}};
      std::printf("  %-100s ", both->name.c_str());
      if (pair) {
        const double times = pair->times_plain;
        result["times_winkler"] = times;
        std::printf("%6.2f  %5.2f", times, (times - 1) / (alone[k] + alone[i] - 2));
        addLimit(pair->run, counter, pair->per_frame, ratesOf(options), result);
      } else {
        result["times_winkler"] = nullptr;
        std::printf("refused");
      }
      std::printf("\n");
      results.push_back(std::move(result));
    }
  }
  return {{"object", object.name}, {"pairs", results}};
}

void run(const Options& options) {
  const Device device = Device::open({.device = options.device});
  const Sensor sensor = loadSensor(options.sensor);
  std::printf("%s, %s; %d instances of %s, %d repetitions\n", device.info().name.c_str(), device.info().driver.c_str(),
              options.num_instances, sensor.name.c_str(), options.repetitions);
  nlohmann::ordered_json results = nlohmann::ordered_json::array();
  const auto runAll = options.pairs ? runPairs : runObject;
  // The results are written after every object, so that a time limit loses one.
  const auto measure = [&](const Object& object, const PoseSpread& spread) {
    results.push_back(runAll(device, sensor, object, spread, options));
    std::fflush(stdout);
    if (options.json.empty()) return;
    writeJson(options.json, {{"bench", "law_cost"},
                             {"machine", machine(device.info())},
                             {"sensor", sensor.name},
                             {"num_instances", options.num_instances},
                             {"repetitions", options.repetitions},
                             {"bandwidth_bytes_per_second", ratesOf(options).bandwidth},
                             {"arithmetic_operations_per_second", ratesOf(options).arithmetic},
                             {"objects", results}});
  };
  measure(Object("cylinder", Cylinder{.radius = 0.008, .length = 0.04}), {.laid = axisAngle({0, 1, 0}, 1.5707963267948966)});
  measure(Object("ellipsoid_5120", ellipsoid({0.020, 0.014, 0.012}, 4)), {.rolls = true});
}

}  // namespace
}  // namespace taxelsim::bench

int main(int argc, char** argv) {
  taxelsim::bench::Options options;
  CLI::App app("Cost of a frame by contact law, readout and output, relative to winkler on the same poses");
  app.add_option("--json", options.json, "Write the results to this JSON file");
  app.add_option("--instances", options.num_instances, "Instances of the batch")->check(CLI::Range(1, 1 << 20))->capture_default_str();
  app.add_option("--repetitions", options.repetitions, "Timed frames per case")->check(CLI::Range(1, 10000))->capture_default_str();
  app.add_option("--only", options.only, "Only winkler and the case of this name");
  app.add_flag("--pairs", options.pairs, "Any two options together instead of all cases");
  app.add_option("--bandwidth", options.bandwidth, "Memory bandwidth of the machine for the limits, GB/s")
      ->check(CLI::PositiveNumber)
      ->capture_default_str();
  app.add_option("--arithmetic", options.arithmetic, "Arithmetic rate of the machine for the limits, GFLOP/s of float32")
      ->check(CLI::PositiveNumber)
      ->capture_default_str();
  app.add_option("--sensor", options.sensor, "Sensor file, with law winkler on one grid")->capture_default_str();
  app.add_option("--device", options.device, "Device, as for `taxelsim frame --device`");
  CLI11_PARSE(app, argc, argv);
  return taxelsim::bench::exitStatus([&] { return taxelsim::bench::run(options), 0; });
}
