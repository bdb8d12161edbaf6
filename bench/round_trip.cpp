// Coverage of the confidence intervals of `characterize`: how often they contain the true value. Simulates measurements by the
// double-precision twin with known parameters and noise, one sensor per seed. Three benches: every quantity measured separately; force
// curves with hysteresis and a nonlinear curve; images of stamps only. Nothing is timed.
#include <CLI/CLI.hpp>
#include <cmath>
#include <cstdio>
#include <map>
#include <random>
#include <string>
#include <vector>

#include "characterize/footprint.h"
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
constexpr int kNumStamps = 12;
constexpr double kPressSpread = 0.05;

struct Options {
  std::string json, bench;
  int num_runs = 200;
};

using Random = std::mt19937_64;

double gaussian(Random& random) {
  return std::normal_distribution<double>()(random);
}

// A WTS 0614 with fewer taxels.
Sensor nominalSensor(int num_rows, int num_cols) {
  Sensor nominal = loadSensor(TAXELSIM_BENCH "/sensors/wts0614.yaml");
  nominal.patches.front().num_rows = num_rows;
  nominal.patches.front().num_cols = num_cols;
  return nominal;
}

// The true sensor; gains are relative to their mean.
Sensor trueSensor(const Sensor& nominal, Random& random) {
  Sensor sensor = nominal;
  Readout& readout = sensor.readout;
  readout.curve = {2310};
  readout.trigger = 0.031;
  readout.saturation = 3840;
  readout.noise = 6;
  readout.creep = {{.fraction = 0.10, .time = 1}, {.fraction = 0.08, .time = 9}};
  sensor.psf = gaussianPsf(kSigma, 5);  // truncates at most 0.5 %
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

// Loads every taxel up to 3.2 N and unloads it, quasi-statically: only hysteresis lags.
ForceCurve forceCurve(const Sensor& sensor, int num_rows, Random& random) {
  Readout loops = sensor.readout;
  loops.creep.clear();
  ForceCurve curve;
  for (int t = 0; t < numTaxels(sensor); ++t) {
    const auto taxel = static_cast<std::size_t>(t);
    reference::Lag lag(loops, static_cast<std::size_t>(numTaxels(sensor)));
    for (int k = 0; k < num_rows; ++k) {
      const double force = 3.2 * std::min(k, num_rows - 1 - k) / (num_rows / 2 - 1);
      curve.taxel.push_back(t);
      curve.force.push_back(force);
      curve.counts.push_back(readOut(sensor, lag.step(spreadOf(sensor, taxel, force), 1), random)[taxel]);
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

// 10 s of images of a flat stamp under a dead weight, which is placed after 1 s.
StampImages stampImages(const Sensor& sensor, Random& random, std::array<double, 3>& place) {
  constexpr double kStampFrame = 0.1;  // s
  const auto uniform = [&](double low, double high) { return std::uniform_real_distribution<double>(low, high)(random); };
  StampImages stamp{.indenter = {.shape = Indenter::Shape::kStamp, .size = {10.5e-3, 10.5e-3}}, .load = uniform(3, 9), .images = {}};
  place = {uniform(-3e-3, 3e-3), uniform(-5e-3, 5e-3), uniform(-0.2, 0.2)};
  const Polygon outline = moved(sectionOf(stamp.indenter, 0), {place[0], place[1]}, place[2]);
  const double press = std::exp(sensor.readout.press_gain_spread * gaussian(random));
  const GridPatch& patch = sensor.patches.front();
  std::vector<double> forces;
  for (int i = 0; i < patch.num_rows; ++i) {
    for (int j = 0; j < patch.num_cols; ++j) {
      const double x = (i - patch.num_rows / 2.0) * patch.pitch[0], y = (j - patch.num_cols / 2.0) * patch.pitch[1];
      const double area = overlap(outline, {x, y}, {x + patch.pitch[0], y + patch.pitch[1]});
      forces.push_back(press * stamp.load * area / stamp.indenter.sectionAt(0));
    }
  }
  stamp.images.num_taxels = forces.size();
  const std::vector<double> spread = reference::spread(sensor, forces), none(forces.size());
  reference::Lag lag(sensor.readout, forces.size());
  for (int k = 1; k <= 110; ++k) {
    stamp.images.time.push_back(kStampFrame * k);
    lag.step(k <= 10 ? none : spread, kStampFrame / 2);  // touch between two frames
    const std::vector<float> counts = readOut(sensor, lag.step(k < 10 ? none : spread, kStampFrame / 2), random);
    stamp.images.counts.insert(stamp.images.counts.end(), counts.begin(), counts.end());
  }
  return stamp;
}

Measurement measurementOf(const char* name, const Sensor& nominal, decltype(Measurement::data) data) {
  return {.file = std::string(name) + ".yaml", .name = name, .sensor = nominal, .resolved_sensor = {}, .data = std::move(data)};
}

// True values by parameter name.
using Truth = std::map<std::string, double>;

std::string gainName(std::size_t taxel) {
  return "readout.taxel_gain[" + std::to_string(taxel) + "]";
}

Truth truthOf(const Sensor& sensor) {
  const Readout& readout = sensor.readout;
  Truth truth{
      {"readout.curve.counts_per_newton", readout.curve[0]},
      {"readout.curve.limit", readout.curve_limit},
      {"readout.trigger", readout.trigger},
      {"readout.saturation", readout.saturation},
      {"readout.noise", readout.noise},
      {"readout.press_gain_spread", readout.press_gain_spread},
      {"skin.normal_contact_stiffness", std::get<Winkler>(sensor.skin.law).normal_contact_stiffness},
      {"force_depth.contact_offset", kContactOffset},
      {"psf.gaussian.sigma", kSigma},
  };
  for (std::size_t t = 0; t < readout.taxel_gain.size(); ++t) truth[gainName(t)] = readout.taxel_gain[t];
  for (std::size_t k = 0; k < readout.hysteresis_strength.size(); ++k) {
    truth["readout.hysteresis_strength"] = readout.hysteresis_strength[k];
    truth["readout.hysteresis_width"] = readout.hysteresis_width[k];
  }
  for (std::size_t c = 0; c < readout.creep.size(); ++c) {
    truth["readout.creep[" + std::to_string(c) + "].fraction"] = readout.creep[c].fraction;
    truth["readout.creep[" + std::to_string(c) + "].time"] = readout.creep[c].time;
  }
  return truth;
}

// Estimated gains are relative to the mean over the estimated taxels: moves that mean from the true gains to the scale.
void makeRelative(const std::vector<Estimate>& estimates, Truth& truth) {
  double sum = 0, count = 0;
  std::vector<std::string> estimated;
  for (const Estimate& estimate : estimates) {
    if (!estimate.parameter.starts_with("readout.taxel_gain[")) continue;
    estimated.push_back(estimate.parameter);
    sum += truth.at(estimate.parameter), ++count;
  }
  if (count == 0) return;
  for (const std::string& name : estimated) truth[name] *= count / sum;
  truth["readout.curve.counts_per_newton"] *= sum / count;
  truth["readout.trigger"] *= count / sum;
}

// A bench: simulates the measurements of one sensor and returns the truth.
struct Bench {
  const char* name;
  Truth (*measure)(Random& random, std::vector<Measurement>& measurements);
};

Truth measureByItself(Random& random, std::vector<Measurement>& measurements) {
  const Sensor nominal = nominalSensor(4, 6), sensor = trueSensor(nominal, random);
  measurements.push_back(measurementOf("force_curve", nominal, forceCurve(sensor, 30, random)));
  measurements.push_back(measurementOf("force_depth", nominal, forceDepth(sensor, random)));
  measurements.push_back(measurementOf("point_images", nominal, pointImages(sensor, random)));
  measurements.push_back(measurementOf("step_response", nominal, stepResponse(sensor, random)));
  return truthOf(sensor);
}

// The curve of a voltage divider, and hysteresis.
Truth measureLoops(Random& random, std::vector<Measurement>& measurements) {
  const Sensor nominal = nominalSensor(4, 6);
  Sensor sensor = trueSensor(nominal, random);
  sensor.psf = nominal.psf;
  sensor.readout.curve_limit = 9000;
  sensor.readout.hysteresis_strength = {0.2};
  sensor.readout.hysteresis_width = {0.1};
  sensor.readout.creep.clear();
  ForceCurve curve = forceCurve(sensor, 80, random);
  curve.divider = true;
  measurements.push_back(measurementOf("force_curve", nominal, std::move(curve)));
  return truthOf(sensor);
}

Truth measureUnderStamps(Random& random, std::vector<Measurement>& measurements) {
  const Sensor nominal = nominalSensor(6, 8);
  Sensor sensor = trueSensor(nominal, random);
  sensor.readout.press_gain_spread = kPressSpread;
  sensor.readout.creep = {{.fraction = 0.2, .time = 3}};
  Truth truth = truthOf(sensor);
  for (int k = 0; k < kNumStamps; ++k) {
    std::array<double, 3> place{};
    const std::string name = "stamp" + std::to_string(k);
    measurements.push_back(measurementOf(name.c_str(), nominal, stampImages(sensor, random, place)));
    truth[name + ".x"] = place[0], truth[name + ".y"] = place[1], truth[name + ".yaw"] = place[2];
  }
  return truth;
}

constexpr Bench kBenches[] = {{"by itself", measureByItself}, {"loops", measureLoops}, {"under stamps", measureUnderStamps}};

struct Tally {
  int num_estimates = 0, num_determined = 0, num_held = 0;
  std::vector<double> relative_half_widths;
};

// Counts the gains of all taxels as one parameter, and so the places of all stamps.
std::string tallied(const std::string& parameter) {
  if (parameter.starts_with("readout.taxel_gain[")) return "readout.taxel_gain";
  return parameter.starts_with("stamp") ? "STAMP" + parameter.substr(parameter.find('.')) : parameter;
}

std::map<std::string, Tally> runBench(const Bench& bench, int num_runs) {
  std::map<std::string, Tally> tallies;
  for (int seed = 0; seed < num_runs; ++seed) {
    Random random(static_cast<std::uint64_t>(seed));
    std::vector<Measurement> measurements;
    Truth truth = bench.measure(random, measurements);
    const std::vector<Estimate> estimates = characterize(measurements).estimates;
    makeRelative(estimates, truth);
    for (const Estimate& estimate : estimates) {
      const auto known = truth.find(estimate.parameter);
      if (known == truth.end()) continue;
      Tally& tally = tallies[tallied(estimate.parameter)];
      ++tally.num_estimates;
      if (!estimate.determined) continue;
      ++tally.num_determined;
      tally.num_held += estimate.low <= known->second && known->second <= estimate.high;
      tally.relative_half_widths.push_back((estimate.high - estimate.low) / 2 / std::max(1e-300, std::abs(known->second)));
    }
    std::fprintf(stderr, "\r%s: %d of %d runs", bench.name, seed + 1, num_runs);
  }
  std::fprintf(stderr, "\n");
  return tallies;
}

void run(const Options& options) {
  nlohmann::ordered_json parameters = nlohmann::ordered_json::array();
  std::printf("%-13s %-34s %10s %12s %10s %22s\n", "bench", "parameter", "estimates", "determined", "held, %", "half width, median, %");
  for (const Bench& bench : kBenches) {
    if (!options.bench.empty() && options.bench != bench.name) continue;
    for (const auto& [parameter, tally] : runBench(bench, options.num_runs)) {
      const double held = 100.0 * tally.num_held / std::max(1, tally.num_determined);
      const double width = tally.num_determined > 0 ? 100 * summarise(tally.relative_half_widths).median : 0;
      std::printf("%-13s %-34s %10d %12d %10.1f %22.3f\n", bench.name, parameter.c_str(), tally.num_estimates, tally.num_determined, held,
                  width);
      parameters.push_back({{"bench", bench.name},
                            {"parameter", parameter},
                            {"num_estimates", tally.num_estimates},
                            {"num_determined", tally.num_determined},
                            {"held_percent", held},
                            {"median_half_width_percent", width}});
    }
  }
  if (!options.json.empty()) writeJson(options.json, {{"bench", "round_trip"}, {"num_runs", options.num_runs}, {"parameters", parameters}});
}

}  // namespace
}  // namespace taxelsim::bench

int main(int argc, char** argv) {
  taxelsim::bench::Options options;
  CLI::App app("Coverage of the 95 % confidence intervals of `taxelsim characterize`");
  app.add_option("--json", options.json, "Write the results to this JSON file");
  app.add_option("--bench", options.bench, "Only this bench: 'by itself', 'loops' or 'under stamps'");
  app.add_option("--runs", options.num_runs, "Simulated sensors per bench")->check(CLI::Range(1, 100000))->capture_default_str();
  CLI11_PARSE(app, argc, argv);
  return taxelsim::bench::exitStatus([&] { return taxelsim::bench::run(options), 0; });
}
