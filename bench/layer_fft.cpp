// Law `elastic_layer` compared with solvers of the same equations on the CPU (peers/fft_layer_peer.h), all to the same residual. Every
// solver is verified against the double-precision solution, then all run in turns in one process.
#include <CLI/CLI.hpp>
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <ctime>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "bench_objects.h"
#include "peers/fft_layer_peer.h"
#include "peers/layer_agreement.h"
#include "peers/threads.h"
#include "report.h"
#include "taxelsim/error.h"
#include "taxelsim/simulator.h"

namespace taxelsim::bench {
namespace {

constexpr double kDt = 1e-3;  // s
constexpr std::uint64_t kPoseSeed = 1;
constexpr int kWarmUps = 2;
constexpr double kStride = 1e-5;  // m, along x, back and forth between frames, as in law_cost
constexpr int kVerifiedFrames = 4;
// Of float32 heights; they agree to about 1e-7 m (peers/agreement.cpp).
constexpr double kDepthError = 2e-7;  // m
// Of single-precision sums: displacements of 1e4 terms, sqrt(1e4) x 2^-24.
constexpr double kRounding = 6e-6;

constexpr std::array kPeerNames{"fft", "whole_ffts", "direct"};

struct Options {
  std::string sensor = TAXELSIM_BENCH "/sensors/wts0614.yaml";
  std::string json, device, only;
  int num_instances = 512;
  int repetitions = 11;
  int num_solved = 64;  // instances that are compared with the solution
  int num_threads = 0;
};

struct Case {
  std::string name;
  int samples_per_taxel;
  ElasticLayer::Base base;
  double margin;  // m
  bool cold;      // whether to reset before every frame
  // At most; the default of the law, unless it does not reach the tolerance. More would change the workgroups of a software driver.
  int iterations = 10;
  // A share of the batch and of the instances that are solved in double precision, which takes a second each on large grids.
  int share = 1;
};

std::vector<Case> allCases() {
  constexpr auto kHalfSpace = ElasticLayer::Base::kHalfSpace, kBonded = ElasticLayer::Base::kBonded;
  return {{"half-space, 2 x 2, cold", 2, kHalfSpace, 0, true},       {"half-space, 2 x 2, sliding", 2, kHalfSpace, 0, false},
          {"bonded, margin, 2 x 2, cold", 2, kBonded, 4e-3, true},   {"bonded, margin, 2 x 2, sliding", 2, kBonded, 4e-3, false},
          {"half-space, 4 x 4, cold", 4, kHalfSpace, 0, true},       {"half-space, 4 x 4, sliding", 4, kHalfSpace, 0, false},
          {"half-space, 8 x 8, cold", 8, kHalfSpace, 0, true, 16, 8}};
}

Sensor layerSensor(Sensor sensor, const Case& work) {
  sensor.samples_per_taxel = work.samples_per_taxel;
  sensor.skin = {.thickness = sensor.skin.thickness,
                 .law = ElasticLayer{.elastic_modulus = 1e6, .poisson_ratio = 0.49, .base = work.base, .iterations = work.iterations},
                 .margin = work.margin};
  return sensor;
}

// Poses of even and of odd frames.
std::array<std::vector<Pose>, 2> slidingPoses(const std::vector<Pose>& X_SO) {
  std::array<std::vector<Pose>, 2> poses{X_SO, X_SO};
  for (Pose& pose : poses[1]) pose.position[0] += kStride;
  return poses;
}

// Seconds of a frame of the batch.
struct Cost {
  double wall = 0;
  double processor = 0;  // of all threads
};

template <typename Work>
Cost costOf(const Work& work) {
  const std::clock_t begin = std::clock();
  const Stopwatch watch;
  work();
  return {watch.seconds(), static_cast<double>(std::clock() - begin) / CLOCKS_PER_SEC};
}

class DeviceSide {
 public:
  DeviceSide(const Device& device, const Sensor& sensor, const Object& object, std::array<std::vector<Pose>, 2> poses, bool cold,
             bool forces)
      : cold_(cold), ids_(poses[0].size(), 0), poses_(std::move(poses)) {
    const Model model(device, {.sensor = sensor, .objects = {object}});
    simulator_.emplace(
        model, SimulatorOptions{.num_instances = static_cast<int>(ids_.size()),
                                .outputs = {.tactile_normal_force = forces, .tactile_shear_force = false, .penetration_depth = false}});
  }

  Cost frame(std::size_t odd) {
    if (cold_) {
      for (std::size_t i = 0; i < ids_.size(); ++i) simulator_->reset(static_cast<int>(i), i);
    }
    return costOf([&] {
      simulator_->setObjects(ids_, poses_[odd]);
      simulator_->step(kDt);
      frame_ = simulator_->read();
    });
  }

  const GroundTruthView& truth() const { return frame_.ground_truth; }

 private:
  bool cold_;
  std::vector<int> ids_;
  std::array<std::vector<Pose>, 2> poses_;
  std::optional<Simulator> simulator_;
  FrameView frame_;
};

struct Contender {
  std::string name;
  std::function<Cost(std::size_t odd)> frame;
  std::vector<double> wall, processor;  // s per frame of the batch
};

// A case with one object: the inputs, the peers and what they are verified with.
class Contest {
 public:
  Contest(const Device& device, const Case& work, const Sensor& sensor, const Object& object, const PoseSpread& spread,
          const Options& options)
      : work_(work),
        options_(options),
        sensor_(layerSensor(sensor, work)),
        object_(object),
        poses_(slidingPoses(randomPoses(object, spread, options.num_instances, kPoseSeed))),
        tolerance_(std::get<ElasticLayer>(sensor_.skin.law).tolerance),
        agreement_(sensor_),
        peers_{FftLayerPeer(sensor_, LayerProduct::kFft, options.num_instances, options.num_threads),
               FftLayerPeer(sensor_, LayerProduct::kWholeFfts, options.num_instances, options.num_threads),
               FftLayerPeer(sensor_, LayerProduct::kDirect, options.num_instances, options.num_threads)} {
    Sensor plain = sensor;
    plain.samples_per_taxel = work.samples_per_taxel;
    winkler_.emplace(device, plain, object, poses_, false, false);
    layer_.emplace(device, sensor_, object, poses_, work.cold, false);
    const LayerNodes nodes = layerNodes(sensor_);
    num_nodes_ = static_cast<std::size_t>(nodes.num_rows) * static_cast<std::size_t>(nodes.num_cols);
    for (std::size_t odd = 0; odd < 2; ++odd) {
      overlaps_[odd].resize(poses_[odd].size() * num_nodes_);
      inThreads(threadsOf(options.num_threads), options.num_instances, 1, [&](int, int i) {
        const std::vector<double> d = layerOverlaps(sensor_, object_, poses_[odd][static_cast<std::size_t>(i)]);
        std::copy(d.begin(), d.end(), overlaps_[odd].begin() + static_cast<std::ptrdiff_t>(static_cast<std::size_t>(i) * num_nodes_));
      });
      padded_[odd] = peers_[0].padded(overlaps_[odd]);
    }
  }

  // Throws Error(kDevice) if a solver is wrong.
  nlohmann::ordered_json verify(const Device& device) {
    Sensor unspread = sensor_;
    unspread.psf = Psf{};
    DeviceSide with_forces(device, unspread, object_, poses_, work_.cold, true);
    for (std::size_t k = 0; k < kVerifiedFrames; ++k) {
      with_forces.frame(k % 2);
      for (FftLayerPeer& peer : peers_) peer.run(padded_[k % 2], work_.cold);
    }
    for (const float residual : with_forces.truth().contact_residual) expectAtMost("taxelsim's residual", residual, tolerance_ + kRounding);
    const auto num_taxels = static_cast<std::size_t>(numTaxels(sensor_));
    nlohmann::ordered_json report;
    report["taxelsim"] = compare("taxelsim", options_.num_solved, [&](std::size_t i) {
      const auto forces = with_forces.truth().tactile_normal_force.subspan(i * num_taxels, num_taxels);
      return std::vector<double>(forces.begin(), forces.end());
    });
    for (std::size_t which = 0; which < peers_.size(); ++which) {
      const std::string name = kPeerNames[which];
      report[name] = compare(name, options_.num_instances, [&](std::size_t i) {
        const std::vector<double> pressures = peers_[which].pressures(static_cast<int>(i));
        expectAtMost(name + ": residual", agreement_.residual(lastOverlaps(i), pressures), tolerance_ + kRounding);
        return layerForces(sensor_, lastOverlaps(i), pressures);
      });
    }
    return report;
  }

  std::vector<Contender> contenders() {
    std::vector<Contender> all{{"winkler", [&](std::size_t odd) { return winkler_->frame(odd); }, {}, {}},
                               {"taxelsim", [&](std::size_t odd) { return layer_->frame(odd); }, {}, {}}};
    for (std::size_t which = 0; which < peers_.size(); ++which) {
      const auto frame = [this, which](std::size_t odd) { return costOf([&] { peers_[which].run(padded_[odd], work_.cold); }); };
      all.push_back({kPeerNames[which], frame, {}, {}});
    }
    return all;
  }

  // Iterations of the last frame.
  nlohmann::ordered_json iterations() const {
    double sum = 0;
    for (const std::int32_t count : layer_->truth().contact_iterations) sum += count;
    nlohmann::ordered_json means{{"taxelsim", sum / options_.num_instances}};
    for (std::size_t which = 0; which < peers_.size(); ++which) means[kPeerNames[which]] = peers_[which].meanIterations();
    return means;
  }

 private:
  std::span<const double> lastOverlaps(std::size_t i) const {
    return std::span(overlaps_[(kVerifiedFrames - 1) % 2]).subspan(i * num_nodes_, num_nodes_);
  }

  void expectAtMost(const std::string& what, double value, double bound) const {
    if (value <= bound) return;
    throw Error(ErrorKind::kDevice,
                work_.name + ", " + object_.name + ": " + what + " " + std::to_string(value) + " is above " + std::to_string(bound));
  }

  // Forces of the first instances against those of the solution. `forcesOf` is called for the first `num_made` instances.
  nlohmann::ordered_json compare(const std::string& name, int num_made, const std::function<std::vector<double>(std::size_t)>& forcesOf) {
    double largest_share = 0;
    std::vector<double> errors;
    for (int k = 0; k < num_made; ++k) {
      const auto i = static_cast<std::size_t>(k);
      const std::vector<double> forces = forcesOf(i);
      if (k >= options_.num_solved) continue;
      if (solutions_.size() <= i) solutions_.push_back(layerForces(sensor_, lastOverlaps(i), agreement_.solution(lastOverlaps(i))));
      double squares = 0, total = 0, true_total = 0;
      for (std::size_t t = 0; t < forces.size(); ++t) {
        squares += (forces[t] - solutions_[i][t]) * (forces[t] - solutions_[i][t]);
        total += forces[t];
        true_total += solutions_[i][t];
      }
      const double bound = agreement_.forceBound(lastOverlaps(i), tolerance_ + kRounding, kDepthError);
      expectAtMost(name + ": difference of the forces from the solution's", std::sqrt(squares), bound);
      largest_share = std::max(largest_share, std::sqrt(squares) / bound);
      errors.push_back(std::abs(total / true_total - 1));
    }
    return {{"largest_share_of_bound", largest_share},
            {"median_error_of_total_force", summarise(errors).median},
            {"largest_error_of_total_force", summarise(errors).max}};
  }

  Case work_;
  Options options_;
  Sensor sensor_;
  Object object_;
  std::array<std::vector<Pose>, 2> poses_;
  double tolerance_;
  LayerAgreement agreement_;
  std::array<FftLayerPeer, kPeerNames.size()> peers_;
  std::optional<DeviceSide> winkler_, layer_;
  std::size_t num_nodes_ = 0;
  std::array<std::vector<double>, 2> overlaps_;  // of even and odd frames, (num_instances x num_nodes), m
  std::array<std::vector<float>, 2> padded_;
  std::vector<std::vector<double>> solutions_;  // forces of the taxels, by instance
};

// Values of `a` over those of `b`, by turn.
std::vector<double> ratios(const std::vector<double>& a, const std::vector<double>& b) {
  std::vector<double> result;
  for (std::size_t k = 0; k < a.size(); ++k) result.push_back(a[k] / b[k]);
  return result;
}

std::vector<double> differences(const std::vector<double>& a, const std::vector<double>& b) {
  std::vector<double> result;
  for (std::size_t k = 0; k < a.size(); ++k) result.push_back(a[k] - b[k]);
  return result;
}

// Time of a peer over that of a frame of taxelsim, and over what this takes more than a frame without a solver.
void addRatios(const Contender& peer, const Contender& taxelsim, const Contender& winkler, nlohmann::ordered_json& entry) {
  const std::array rows{std::pair{"over_frame", ratios(peer.wall, taxelsim.wall)},
                        std::pair{"over_frame_processor", ratios(peer.processor, taxelsim.processor)},
                        std::pair{"over_solver", ratios(peer.wall, differences(taxelsim.wall, winkler.wall))},
                        std::pair{"over_solver_processor", ratios(peer.processor, differences(taxelsim.processor, winkler.processor))}};
  std::array<double, rows.size()> medians{};
  for (std::size_t k = 0; k < rows.size(); ++k) {
    entry[rows[k].first] = toJson(rows[k].second);
    medians[k] = summarise(rows[k].second).median;
  }
  std::printf("; %.3f (processor %.3f) of a frame of taxelsim, %.3f (%.3f) of its solver", medians[0], medians[1], medians[2], medians[3]);
}

nlohmann::ordered_json runCase(const Device& device, const Case& work, const Sensor& sensor, const Object& object, const PoseSpread& spread,
                               Options options) {
  options.num_instances = std::max(options.num_instances / work.share, 1);
  options.num_solved = std::max(std::min(options.num_solved / work.share, options.num_instances), 1);
  Contest contest(device, work, sensor, object, spread, options);
  const nlohmann::ordered_json verification = contest.verify(device);
  std::vector<Contender> all = contest.contenders();
  for (int r = -kWarmUps; r < options.repetitions; ++r) {
    for (Contender& one : all) {
      const Cost cost = one.frame(static_cast<std::size_t>(r + kWarmUps) % 2);
      if (r < 0) continue;
      one.wall.push_back(cost.wall);
      one.processor.push_back(cost.processor);
    }
  }
  const nlohmann::ordered_json iterations = contest.iterations();
  std::printf("%s, %s\n", object.name.c_str(), work.name.c_str());
  nlohmann::ordered_json result{{"object", object.name},
                                {"case", work.name},
                                {"num_instances", options.num_instances},
                                {"iterations", iterations},
                                {"verification", verification}};
  for (const Contender& one : all) {
    const double to_us = 1e6 / options.num_instances;
    std::printf("  %-10s %8.2f us a frame, processor %8.2f us", one.name.c_str(), summarise(one.wall).median * to_us,
                summarise(one.processor).median * to_us);
    nlohmann::ordered_json entry{{"wall_seconds", toJson(one.wall)}, {"processor_seconds", toJson(one.processor)}};
    if (one.name != "winkler" && one.name != "taxelsim") addRatios(one, all[1], all[0], entry);
    if (iterations.contains(one.name)) std::printf("; %.1f iterations", iterations[one.name].get<double>());
    if (verification.contains(one.name)) {
      std::printf("; total force off by %.2g, at most %.2g", verification[one.name]["median_error_of_total_force"].get<double>(),
                  verification[one.name]["largest_error_of_total_force"].get<double>());
    }
    std::printf("\n");
    result[one.name] = std::move(entry);
  }
  std::fflush(stdout);
  return result;
}

void run(const Options& options) {
  const Device device = Device::open({.device = options.device});
  const Sensor sensor = loadSensor(options.sensor);
  std::printf("%s, %s; %d instances of %s, %d repetitions, %d threads\n", device.info().name.c_str(), device.info().driver.c_str(),
              options.num_instances, sensor.name.c_str(), options.repetitions, threadsOf(options.num_threads));
  const Object cylinder("cylinder", Cylinder{.radius = 0.008, .length = 0.04}), mesh("ellipsoid_5120", ellipsoid({0.020, 0.014, 0.012}, 4));
  const PoseSpread lying{.laid = axisAngle({0, 1, 0}, 1.5707963267948966)}, rolling{.rolls = true};
  nlohmann::ordered_json results = nlohmann::ordered_json::array();
  for (const Case& work : allCases()) {
    if (!options.only.empty() && work.name != options.only) continue;
    results.push_back(runCase(device, work, sensor, cylinder, lying, options));
    results.push_back(runCase(device, work, sensor, mesh, rolling, options));
  }
  if (results.empty()) throw Error(ErrorKind::kInput, "--only: no case has the name " + options.only);
  if (!options.json.empty()) {
    writeJson(options.json, {{"bench", "layer_fft"},
                             {"machine", machine(device.info())},
                             {"sensor", sensor.name},
                             {"num_instances", options.num_instances},
                             {"repetitions", options.repetitions},
                             {"threads", threadsOf(options.num_threads)},
                             {"cases", results}});
  }
}

}  // namespace
}  // namespace taxelsim::bench

int main(int argc, char** argv) {
  taxelsim::bench::Options options;
  CLI::App app("Law elastic_layer compared with solvers of the same equations by FFTs and by direct sums, to the same residual");
  app.add_option("--json", options.json, "Write the results to this JSON file");
  app.add_option("--instances", options.num_instances, "Instances of the batch")->check(CLI::Range(1, 1 << 16))->capture_default_str();
  app.add_option("--repetitions", options.repetitions, "Timed frames per case and solver")
      ->check(CLI::Range(1, 10000))
      ->capture_default_str();
  app.add_option("--solved", options.num_solved, "Instances whose forces are compared with the double-precision solution")
      ->check(CLI::Range(1, 1 << 16))
      ->capture_default_str();
  app.add_option("--threads", options.num_threads, "Threads of the solvers on the CPU; 0: one per core")
      ->check(CLI::Range(0, 1024))
      ->capture_default_str();
  app.add_option("--only", options.only, "Only the case of this name");
  app.add_option("--sensor", options.sensor, "Sensor file, with law winkler on one grid")->capture_default_str();
  app.add_option("--device", options.device, "Device, as for `taxelsim frame --device`");
  CLI11_PARSE(app, argc, argv);
  return taxelsim::bench::exitStatus([&] { return taxelsim::bench::run(options), 0; });
}
