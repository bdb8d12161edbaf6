// Frames per second of taxelsim beside Embree 3 on the same poses and samples, in one process: verified against each other first, then
// timed in turns (taxelsim, Embree, taxelsim, ...), so that what else the machine does meets both. The ratio is what is to be quoted.
#include <CLI/CLI.hpp>
#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <functional>
#include <string>
#include <vector>

#include "bench_objects.h"
#include "embree_peer.h"
#include "report.h"
#include "taxelsim/error.h"
#include "taxelsim/simulator.h"

namespace taxelsim::bench {
namespace {

constexpr double kDt = 1e-3;  // s
constexpr std::uint64_t kPoseSeed = 1;
constexpr int kWarmUps = 3;
constexpr double kMaxDepthError = MeshOptions{}.max_depth_error;
// A surface that lies this much off moves the force of a taxel by as much more: a column of skin one taxel wide carries 2000 N/m, and where
// the surface is steep the depth differs by more than the distance.
constexpr double kForcePerDepth = 3 * 2000;  // N/m

// A taxel agrees when its spread force is within this of the peer's. Both work in float32: heights of objects 60 mm long agree to about
// 1e-7 m, and a column of skin one taxel wide carries 2000 N/m, so 2e-4 N; the peer's cylinder of 1024 strips lies up to 4e-8 m inside the
// true one.
constexpr double kForceTolerance = 5e-4;  // N
// A ray through a silhouette or between two triangles may fall to either side, which moves the force of one sample: these taxels are
// counted.
constexpr double kMaxOutliers = 2e-3;  // of all taxels under contact
// No instance may be off by more than a few samples, whatever its taxels say.
constexpr double kTotalForceTolerance = 0.01;  // of the total force
constexpr double kTotalForceFloor = 0.4;       // N: two samples at the deepest
constexpr double kMostTouched = 40;            // taxels under the larger contacts

struct Case {
  std::string name;
  Object object;  // for taxelsim
  Mesh peer;      // for Embree
  std::string peer_note;
  PoseSpread spread;
  double depth_tolerance = 0;  // m: by how much taxelsim's surface may lie off the peer's
};

struct Options {
  std::string sensor = TAXELSIM_SCENES "/sensors/wts0614.yaml";
  std::string prism = TAXELSIM_SCENES "/objects/hex_prism.obj";
  std::string json, device;
  int num_instances = 4096;
  int repetitions = 11;
  int threads = 0;
  std::vector<std::string> cases;
};

double secondsOf(const std::function<void()>& work) {
  const auto start = std::chrono::steady_clock::now();
  work();
  return std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
}

struct Agreement {
  std::size_t num_touched = 0;  // taxels under contact in either
  std::size_t num_outliers = 0;
  double largest_inlier = 0;       // N
  double largest = 0;              // N
  double worst_total = 0;          // N, of an instance
  std::size_t num_counts_off = 0;  // taxels under contact whose counts differ by more than one
  bool agrees = true;
};

Agreement compare(const FrameView& frame, const PeerFrame& peer, int num_taxels, double depth_tolerance) {
  Agreement result;
  const double tolerance = kForceTolerance + kForcePerDepth * depth_tolerance;
  for (std::size_t i = 0; i < peer.clean.size(); ++i) {
    for (int t = 0; t < num_taxels; ++t) {
      const std::size_t k = i * num_taxels + t;
      const double ours = frame.ground_truth.tactile_normal_force[k], theirs = peer.spread_force[k];
      if (ours == 0 && theirs == 0) continue;
      ++result.num_touched;
      const double difference = std::abs(ours - theirs);
      result.largest = std::max(result.largest, difference);
      if (difference > tolerance) {
        ++result.num_outliers;
      } else {
        result.largest_inlier = std::max(result.largest_inlier, difference);
        const int counts_off = std::abs(static_cast<int>(frame.tactile_image[k]) - static_cast<int>(peer.tactile_image[k]));
        result.num_counts_off += counts_off > 1 + tolerance * 2400;
      }
    }
    const double total = std::abs(frame.ground_truth.total_force[i] - peer.clean[i].total_force);
    result.worst_total = std::max(result.worst_total, total);
    result.agrees &= total <= std::max(kTotalForceFloor + kMostTouched * kForcePerDepth * depth_tolerance,
                                       kTotalForceTolerance * peer.clean[i].total_force);
  }
  result.agrees &= result.num_touched > 0 && result.num_counts_off == 0 &&
                   static_cast<double>(result.num_outliers) <= kMaxOutliers * static_cast<double>(result.num_touched);
  return result;
}

void print(const char* what, const std::vector<double>& seconds, int num_instances) {
  const Summary s = summarise(seconds);
  std::printf("  %-24s %9.1f thousand frames/s   (%.2f ms, %.2f to %.2f)\n", what, num_instances / s.median / 1e3, s.median * 1e3,
              s.min * 1e3, s.max * 1e3);
}

// Returns null when the two do not agree.
nlohmann::ordered_json runCase(const Device& device, const Sensor& sensor, const Case& work, const Options& options) {
  const Model model(device, {.sensor = sensor, .objects = {work.object}});
  const std::vector<Pose> X_SO = randomPoses(work.object, work.spread, options.num_instances, kPoseSeed);
  const std::vector<int> ids(X_SO.size(), 0);
  EmbreePeer peer(sensor, work.peer, Rays::kAll, options.threads), skipping_peer(sensor, work.peer, Rays::kUnderBox, options.threads);
  PeerFrame peer_frame;

  // Both give the image, measured features and clean features; the forces come back in the check only.
  SimulatorOptions checked{.num_instances = options.num_instances};
  SimulatorOptions timed{.num_instances = options.num_instances,
                         .outputs = {.tactile_normal_force = false, .tactile_shear_force = false, .penetration_depth = false}};
  Agreement agreement;
  {
    Simulator simulator(model, checked);
    simulator.setObjects(ids, X_SO);
    simulator.step(kDt);
    peer.run(X_SO, peer_frame);
    agreement = compare(simulator.read(), peer_frame, numTaxels(sensor), work.depth_tolerance);
  }
  const double touched = static_cast<double>(agreement.num_touched) / static_cast<double>(X_SO.size() * numTaxels(sensor));
  std::printf(
      "%s: %.1f %% of the taxels under contact; %zu of %zu differ by more than %g N (at most %.2g N), the others by at most %.2g N; "
      "total force by at most %.2g N\n",
      work.name.c_str(), 100 * touched, agreement.num_outliers, agreement.num_touched,
      kForceTolerance + kForcePerDepth * work.depth_tolerance, agreement.largest, agreement.largest_inlier, agreement.worst_total);
  if (!agreement.agrees) {
    std::printf("  they do not agree: not timed\n");
    return nullptr;
  }

  Simulator simulator(model, timed);
  float sink = 0;
  std::vector<double> ours, ours_device, ours_contact, ours_submit, theirs, theirs_skipping, ratios, ratios_skipping;
  const auto frameOfOurs = [&] {
    simulator.setObjects(ids, X_SO);
    simulator.step(kDt);
    sink += simulator.read().total_force[0];
  };
  const auto frameOfTheirs = [&] { peer.run(X_SO, peer_frame); };
  const auto skippingFrameOfTheirs = [&] { skipping_peer.run(X_SO, peer_frame); };
  for (int w = 0; w < kWarmUps; ++w) {
    frameOfOurs();
    frameOfTheirs();
    skippingFrameOfTheirs();
  }
  for (int r = 0; r < options.repetitions; ++r) {
    ours.push_back(secondsOf(frameOfOurs));
    ours_device.push_back(simulator.timing().total);
    ours_contact.push_back(simulator.timing().contact);
    theirs.push_back(secondsOf(frameOfTheirs));
    theirs_skipping.push_back(secondsOf(skippingFrameOfTheirs));
    ours_submit.push_back(secondsOf([&] {
      simulator.step(kDt);
      sink += simulator.read().total_force[0];
    }));
    ratios.push_back(theirs.back() / ours.back());
    ratios_skipping.push_back(theirs_skipping.back() / ours.back());
  }
  if (!std::isfinite(sink)) return nullptr;

  const Summary ratio = summarise(ratios), ratio_skipping = summarise(ratios_skipping);
  print("taxelsim, end to end", ours, options.num_instances);
  print("taxelsim, submit to read", ours_submit, options.num_instances);
  print("taxelsim, device", ours_device, options.num_instances);
  print("  of it, contact pass", ours_contact, options.num_instances);
  print("Embree 3, every sample", theirs, options.num_instances);
  print("Embree 3, under the box", theirs_skipping, options.num_instances);
  std::printf("  taxelsim is %.2f times as fast as Embree on every sample (%.2f to %.2f), %.2f as Embree under the box%s%s\n\n",
              ratio.median, ratio.min, ratio.max, ratio_skipping.median, work.peer_note.empty() ? "" : "; ", work.peer_note.c_str());
  return {{"case", work.name},
          {"peer_note", work.peer_note},
          {"peer_triangles", work.peer.triangles.size()},
          {"touched_taxels", touched},
          {"outlier_taxels", agreement.num_outliers},
          {"largest_inlier_N", agreement.largest_inlier},
          {"seconds_end_to_end", toJson(ours)},
          {"seconds_submit_to_read", toJson(ours_submit)},
          {"seconds_device", toJson(ours_device)},
          {"seconds_contact_pass", toJson(ours_contact)},
          {"seconds_embree", toJson(theirs)},
          {"seconds_embree_under_box", toJson(theirs_skipping)},
          {"frames_per_second", options.num_instances / summarise(ours).median},
          {"frames_per_second_device", options.num_instances / summarise(ours_device).median},
          {"frames_per_second_embree", options.num_instances / summarise(theirs).median},
          {"frames_per_second_embree_under_box", options.num_instances / summarise(theirs_skipping).median},
          {"ratio", toJson(ratios)},
          {"ratio_under_box", toJson(ratios_skipping)}};
}

std::vector<Case> allCases(const Options& options) {
  const Vector3 size{0.020, 0.014, 0.012};  // m
  const Mesh prism = loadMesh(options.prism), knob = ellipsoid(size, 4), fine = ellipsoid(size, 6);
  const Cylinder cylinder{.radius = 0.008, .length = 0.04};
  std::vector<Case> cases;
  cases.push_back({"prism_24", Object("prism", prism), prism, "", {.rolls = true}});
  cases.push_back({"ellipsoid_5120", Object("ellipsoid", knob), knob, "", {.rolls = true}});
  cases.push_back({"ellipsoid_81920", Object("fine_ellipsoid", fine), fine, "", {.rolls = true}});
  const Mesh simple = asLoaded(fine, kMaxDepthError);
  cases.push_back({"ellipsoid_81920_10um",
                   Object("simplified_ellipsoid", simple),
                   fine,
                   "taxelsim had " + std::to_string(simple.triangles.size()) + " triangles, as loadMesh() gives them",
                   {.rolls = true},
                   kMaxDepthError});
  cases.push_back({"cylinder_analytic",
                   Object("cylinder", cylinder),
                   tessellatedCylinder(cylinder.radius, cylinder.length, 1024),
                   "Embree had the cylinder in 1024 flat strips",
                   {.laid = axisAngle({0, 1, 0}, 1.5707963267948966)}});
  return cases;
}

int run(const Options& options) {
  const Device device = Device::open({.device = options.device});
  const Sensor sensor = loadSensor(options.sensor);
  std::printf("%s, %s; %d instances of %s, %d repetitions\n\n", device.info().name.c_str(), device.info().driver.c_str(),
              options.num_instances, sensor.name.c_str(), options.repetitions);
  nlohmann::ordered_json results = nlohmann::ordered_json::array();
  bool complete = true;
  for (const Case& work : allCases(options)) {
    if (!options.cases.empty() && std::find(options.cases.begin(), options.cases.end(), work.name) == options.cases.end()) continue;
    nlohmann::ordered_json result = runCase(device, sensor, work, options);
    complete &= !result.is_null();
    if (!result.is_null()) results.push_back(std::move(result));
  }
  if (!options.json.empty()) {
    writeJson(options.json, {{"bench", "frame_rate"},
                             {"machine", machine(device.info())},
                             {"sensor", sensor.name},
                             {"num_instances", options.num_instances},
                             {"repetitions", options.repetitions},
                             {"cases", results}});
  }
  return complete ? 0 : 1;
}

}  // namespace
}  // namespace taxelsim::bench

int main(int argc, char** argv) {
  taxelsim::bench::Options options;
  CLI::App app("Frames per second of taxelsim beside Embree 3: same poses, same samples, verified, timed in turns");
  app.add_option("--json", options.json, "Write the results into this file");
  app.add_option("--instances", options.num_instances, "Sensors in the batch")->check(CLI::Range(1, 1 << 20))->capture_default_str();
  app.add_option("--repetitions", options.repetitions, "Timed frames of each")->check(CLI::Range(1, 10000))->capture_default_str();
  app.add_option("--threads", options.threads, "Embree's threads; 0 for one per core")->check(CLI::Range(0, 1024))->capture_default_str();
  app.add_option("--case", options.cases,
                 "prism_24, ellipsoid_5120, ellipsoid_81920, ellipsoid_81920_10um or cylinder_analytic; all if not given");
  app.add_option("--sensor", options.sensor, "Sensor file")->capture_default_str();
  app.add_option("--device", options.device, "Device, as of `taxelsim frame --device`");
  CLI11_PARSE(app, argc, argv);
  try {
    return taxelsim::bench::run(options);
  } catch (const taxelsim::Error& error) {
    std::fprintf(stderr, "%s\n", error.what());
    return error.kind() == taxelsim::ErrorKind::kInput ? 2 : 1;
  }
}
