// How often the intervals of `characterize` hold the truth: benches that are not there, simulated by the double-precision twin with known
// parameters and noise, one a seed. Nothing is timed.
#include <CLI/CLI.hpp>
#include <cmath>
#include <cstdio>
#include <map>
#include <random>
#include <string>
#include <vector>

#include "reference/lag.h"
#include "reference/psf.h"
#include "reference/readout.h"
#include "report.h"
#include "taxelsim/characterize.h"
#include "taxelsim/error.h"

namespace taxelsim::bench {
namespace {

constexpr double kPinRadius = 0.5e-3;      // m
constexpr double kContactOffset = 0.2e-3;  // m
constexpr double kForceNoise = 0.002;      // N, of the bench's load cell
constexpr double kFrame = 1.0 / 30;        // s
constexpr double kSigma = 0.6;             // taxels
constexpr double kPi = 3.14159265358979323846;

struct Options {
  std::string json;
  int num_runs = 200;
};

using Random = std::mt19937_64;

double gaussian(Random& random) {
  return std::normal_distribution<double>()(random);
}

// A sensor as it is, gains relative to their mean.
Sensor trueSensor(const Sensor& nominal, Random& random) {
  Sensor sensor = nominal;
  Readout& readout = sensor.readout;
  readout.curve = {2310};
  readout.trigger = 0.031;
  readout.saturation = 3840;
  readout.noise = 6;
  readout.creep = {{.fraction = 0.10, .time = 1}, {.fraction = 0.08, .time = 9}};
  sensor.psf = gaussianPsf(kSigma, 5);  // the size that leaves out no more than 0.5 %
  std::get<Winkler>(sensor.skin.law).normal_contact_stiffness = 1.61e8;
  double sum = 0;
  for (int t = 0; t < numTaxels(sensor); ++t) sum += readout.taxel_gain.emplace_back(std::exp(0.06 * gaussian(random)));
  for (double& gain : readout.taxel_gain) gain *= numTaxels(sensor) / sum;
  return sensor;
}

std::vector<float> readOut(const Sensor& sensor, const std::vector<double>& force, Random& random) {
  reference::ReadoutDraw draw;
  for (std::size_t t = 0; t < force.size(); ++t) draw.noise.push_back(sensor.readout.noise * gaussian(random));
  const std::vector<std::uint32_t> counts = reference::readOut(sensor, force, draw);
  return {counts.begin(), counts.end()};
}

std::vector<double> spreadOf(const Sensor& sensor, std::size_t taxel, double force) {
  std::vector<double> forces(static_cast<std::size_t>(numTaxels(sensor)));
  forces[taxel] = force;
  return reference::spread(sensor, forces);
}

// Every taxel pressed up to 3.2 N and let go.
ForceCurve forceCurve(const Sensor& sensor, Random& random) {
  ForceCurve curve;
  for (int t = 0; t < numTaxels(sensor); ++t) {
    for (int k = 0; k < 30; ++k) {
      const auto taxel = static_cast<std::size_t>(t);
      const double force = 3.2 * std::min(k, 29 - k) / 14;
      curve.taxel.push_back(t);
      curve.force.push_back(force);
      curve.counts.push_back(readOut(sensor, spreadOf(sensor, taxel, force), random)[taxel]);
    }
  }
  return curve;
}

ForceDepth forceDepth(const Sensor& sensor, Random& random) {
  ForceDepth data{.indenter = {.shape = Indenter::Shape::kFlatPin, .radius = kPinRadius}, .depth = {}, .force = {}};
  const double stiffness = std::get<Winkler>(sensor.skin.law).normal_contact_stiffness * kPi * kPinRadius * kPinRadius;
  for (int k = 0; k < 60; ++k) {
    data.depth.push_back(0.025e-3 * k);
    data.force.push_back(stiffness * std::max(0.0, data.depth.back() - kContactOffset) + kForceNoise * gaussian(random));
  }
  return data;
}

PointImages pointImages(const Sensor& sensor, Random& random) {
  PointImages points{.indenter = {.shape = Indenter::Shape::kFlatPin, .radius = kPinRadius}, .position = {}, .force = {}, .images = {}};
  points.images.num_taxels = static_cast<std::size_t>(numTaxels(sensor));
  const std::vector<Vector3> places = taxelPositions(sensor);
  for (int k = 0; k < 40; ++k) {
    const auto taxel = std::uniform_int_distribution<std::size_t>(0, places.size() - 1)(random);
    const double force = std::uniform_real_distribution<double>(0.6, 1.4)(random);
    points.position.push_back({places[taxel][0], places[taxel][1]});
    points.force.push_back(force);
    const std::vector<float> counts = readOut(sensor, spreadOf(sensor, taxel, force), random);
    points.images.counts.insert(points.images.counts.end(), counts.begin(), counts.end());
  }
  return points;
}

// 20 s of one taxel, loaded after half a second.
StepResponse stepResponse(const Sensor& sensor, Random& random) {
  constexpr std::size_t kTaxel = 8;
  StepResponse step{.load = 0.9, .time = {}, .counts = {}};
  reference::Lag lag(sensor.readout, static_cast<std::size_t>(numTaxels(sensor)));
  for (int k = 0; k < 600; ++k) {
    const std::vector<double> force = k < 15 ? spreadOf(sensor, kTaxel, 0) : spreadOf(sensor, kTaxel, step.load);
    step.time.push_back(kFrame * k);
    step.counts.push_back(readOut(sensor, lag.step(force, kFrame), random)[kTaxel]);
  }
  return step;
}

Measurement measurementOf(const char* name, const Sensor& nominal, decltype(Measurement::data) data) {
  return {.file = std::string(name) + ".yaml", .name = name, .sensor = nominal, .resolved_sensor = {}, .data = std::move(data)};
}

// True values by the names of estimates.
std::map<std::string, double> truthOf(const Sensor& sensor) {
  const Readout& readout = sensor.readout;
  std::map<std::string, double> truth{
      {"readout.curve.counts_per_newton", readout.curve[0]},
      {"readout.trigger", readout.trigger},
      {"readout.saturation", readout.saturation},
      {"readout.noise", readout.noise},
      {"skin.normal_contact_stiffness", std::get<Winkler>(sensor.skin.law).normal_contact_stiffness},
      {"force_depth.contact_offset", kContactOffset},
      {"psf.gaussian.sigma", kSigma},
  };
  for (std::size_t t = 0; t < readout.taxel_gain.size(); ++t)
    truth["readout.taxel_gain[" + std::to_string(t) + "]"] = readout.taxel_gain[t];
  for (std::size_t c = 0; c < readout.creep.size(); ++c) {
    truth["readout.creep[" + std::to_string(c) + "].fraction"] = readout.creep[c].fraction;
    truth["readout.creep[" + std::to_string(c) + "].time"] = readout.creep[c].time;
  }
  return truth;
}

struct Tally {
  int num_estimates = 0, num_determined = 0, num_held = 0;
  std::vector<double> relative_half_widths;
};

// Gains are one parameter, told 84 times.
std::string tallied(const std::string& parameter) {
  return parameter.starts_with("readout.taxel_gain[") ? "readout.taxel_gain" : parameter;
}

void run(const Options& options) {
  Sensor nominal = loadSensor(TAXELSIM_SCENES "/sensors/wts0614.yaml");
  nominal.patches.front().num_rows = 4;  // fewer taxels, more runs
  nominal.patches.front().num_cols = 6;
  std::map<std::string, Tally> tallies;
  for (int seed = 0; seed < options.num_runs; ++seed) {
    Random random(static_cast<std::uint64_t>(seed));
    const Sensor sensor = trueSensor(nominal, random);
    std::vector<Measurement> measurements;
    measurements.push_back(measurementOf("force_curve", nominal, forceCurve(sensor, random)));
    measurements.push_back(measurementOf("force_depth", nominal, forceDepth(sensor, random)));
    measurements.push_back(measurementOf("point_images", nominal, pointImages(sensor, random)));
    measurements.push_back(measurementOf("step_response", nominal, stepResponse(sensor, random)));
    const std::map<std::string, double> truth = truthOf(sensor);
    for (const Estimate& estimate : characterize(measurements).estimates) {
      const auto known = truth.find(estimate.parameter);
      if (known == truth.end()) continue;
      Tally& tally = tallies[tallied(estimate.parameter)];
      ++tally.num_estimates;
      if (!estimate.determined) continue;
      ++tally.num_determined;
      tally.num_held += estimate.low <= known->second && known->second <= estimate.high;
      tally.relative_half_widths.push_back((estimate.high - estimate.low) / 2 / std::abs(known->second));
    }
    std::fprintf(stderr, "\r%d of %d runs", seed + 1, options.num_runs);
  }
  std::fprintf(stderr, "\n");

  nlohmann::ordered_json parameters = nlohmann::ordered_json::array();
  std::printf("%-34s %10s %12s %10s %22s\n", "parameter", "estimates", "determined", "held, %", "half width, median, %");
  for (auto& [parameter, tally] : tallies) {
    const double held = 100.0 * tally.num_held / std::max(1, tally.num_determined);
    const double width = 100 * summarise(tally.relative_half_widths).median;
    std::printf("%-34s %10d %12d %10.1f %22.3f\n", parameter.c_str(), tally.num_estimates, tally.num_determined, held, width);
    parameters.push_back({{"parameter", parameter},
                          {"num_estimates", tally.num_estimates},
                          {"num_determined", tally.num_determined},
                          {"held_percent", held},
                          {"median_half_width_percent", width}});
  }
  if (!options.json.empty()) writeJson(options.json, {{"bench", "round_trip"}, {"num_runs", options.num_runs}, {"parameters", parameters}});
}

}  // namespace
}  // namespace taxelsim::bench

int main(int argc, char** argv) {
  taxelsim::bench::Options options;
  CLI::App app("How often the 95 % intervals of `taxelsim characterize` hold the truth");
  app.add_option("--json", options.json, "Write the results into this file");
  app.add_option("--runs", options.num_runs, "Simulated benches")->check(CLI::Range(1, 100000))->capture_default_str();
  CLI11_PARSE(app, argc, argv);
  try {
    taxelsim::bench::run(options);
    return 0;
  } catch (const taxelsim::Error& error) {
    std::fprintf(stderr, "%s\n", error.what());
    return error.kind() == taxelsim::ErrorKind::kInput ? 2 : 1;
  }
}
