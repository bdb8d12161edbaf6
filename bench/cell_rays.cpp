// Area sampling compared with Embree at several rays per cell: the error of both against the double-precision twin, whose cells are clipped
// polygons, and the frames/s of both, in turns in one process.
#include <CLI/CLI.hpp>
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <memory>
#include <string>
#include <vector>

#include "peers/cases.h"
#include "peers/embree_peer.h"
#include "peers/taxelsim_peer.h"
#include "peers/threads.h"
#include "peers/twin_peer.h"
#include "report.h"
#include "taxelsim/error.h"

namespace taxelsim::bench {
namespace {

constexpr int kWarmUps = 1;
constexpr std::array kRaysPerSide{1, 2, 4, 8};  // of a cell
// taxelsim's sums are exact up to float32 heights, which agree to about 1e-7 m (peers/agreement.cpp), and meshes of round objects; contacts
// are at least 0.3 mm deep.
constexpr double kLargestError = 2e-3;  // of the total force

struct Options {
  std::string sensor = TAXELSIM_BENCH "/sensors/wts0614.yaml";
  std::string json, device;
  std::vector<std::string> cases{"cylinder_analytic", "prism_24", "ellipsoid_5120", "banana"};
  int num_instances = 1024;
  int repetitions = 7;
  int num_solved = 64;  // instances that are compared with the twin
  int num_threads = 0;
};

struct Contestant {
  std::string name;
  std::unique_ptr<Peer> verified, timed;  // that copies its forces, and that leaves them on the device
  std::vector<double> errors;             // of the total force, (num_solved)
  std::vector<double> seconds, ratios;    // (num_repetitions): of a batch, and over taxelsim's in the same turn
};

std::vector<Contestant> contestantsOf(const Device& device, const Sensor& sensor, const Case& work, const Options& options) {
  std::vector<Contestant> all;
  Sensor cells = sensor;
  cells.depth_sampling = DepthSampling::kArea;
  const Model model(device, {.sensor = cells, .objects = work.objects});
  all.push_back({"taxelsim, area",
                 std::make_unique<TaxelsimPeer>(model, options.num_solved, TaxelsimPeer::Options{.with_forces = true}),
                 std::make_unique<TaxelsimPeer>(model, options.num_instances),
                 {},
                 {},
                 {}});
  std::vector<const Mesh*> meshes;
  for (const auto& mesh : work.meshes) meshes.push_back(mesh.get());
  for (const int per_side : kRaysPerSide) {
    const auto peer = [&] { return std::make_unique<EmbreePeer>(sensor, meshes, Rays::kUnderBox, options.num_threads, per_side); };
    all.push_back({"embree, " + std::to_string(per_side * per_side) + " rays a cell", peer(), peer(), {}, {}, {}});
  }
  return all;
}

// Errors of the total forces in the first num_solved instances.
void findErrors(std::vector<Contestant>& all, const Sensor& sensor, const Case& work, const Options& options) {
  const auto count = static_cast<std::size_t>(std::min(options.num_solved, options.num_instances));
  const std::span ids(work.poses.ids.data(), count);
  const std::span X_SO(work.poses.X_SO.data(), count);
  Sensor cells = sensor;
  cells.depth_sampling = DepthSampling::kArea;
  PeerFrame truth, frame;
  TwinPeer(cells, work.objects, options.num_threads).run(ids, X_SO, truth);
  for (Contestant& one : all) {
    one.verified->run(ids, X_SO, frame);
    for (std::size_t i = 0; i < count; ++i) {
      const double force = static_cast<double>(truth.clean[i].total_force);
      if (force > 0) one.errors.push_back(std::abs(static_cast<double>(frame.clean[i].total_force) / force - 1));
    }
  }
}

void timeAll(std::vector<Contestant>& all, const Case& work, const Options& options) {
  PeerFrame frame;
  frame.with_forces = false;
  for (int turn = -kWarmUps; turn < options.repetitions; ++turn) {
    const std::vector<Poses> frames = framesOf(work, turn + kWarmUps);
    for (Contestant& one : all) {
      const Stopwatch watch;
      for (const Poses& poses : frames) one.timed->run(poses.ids, poses.X_SO, frame);
      if (turn >= 0) one.seconds.push_back(watch.seconds() / static_cast<double>(frames.size()));
    }
  }
  for (Contestant& one : all)
    for (std::size_t k = 0; k < one.seconds.size(); ++k) one.ratios.push_back(one.seconds[k] / all.front().seconds[k]);
}

nlohmann::ordered_json report(const Case& work, const std::vector<Contestant>& all, const Options& options) {
  std::printf("\n%s, %d instances\n  %-26s %10s %14s %14s %18s\n", work.name.c_str(), options.num_instances, "", "frames/s", "median error",
              "largest error", "taxelsim over it");
  nlohmann::ordered_json rows = nlohmann::ordered_json::array();
  for (const Contestant& one : all) {
    const Summary errors = summarise(one.errors);
    const double rate = options.num_instances / summarise(one.seconds).median, ratio = summarise(one.ratios).median;
    std::printf("  %-26s %10.0f %12.3f %% %12.3f %% %18.2f\n", one.name.c_str(), rate, 100 * errors.median, 100 * errors.max, ratio);
    rows.push_back({{"name", one.name},
                    {"seconds", toJson(one.seconds)},
                    {"taxelsim_over", toJson(one.ratios)},
                    {"median_error", errors.median},
                    {"largest_error", errors.max}});
  }
  return {{"case", work.name}, {"contestants", rows}};
}

int run(const Options& options) {
  const Sensor sensor = loadSensor(options.sensor);
  const Device device = Device::open({.device = options.device});
  CaseMaker maker(TAXELSIM_SCENES "/objects");
  std::printf("%s, %s; Embree with %d threads\n", device.info().name.c_str(), device.info().driver.c_str(), threadsOf(options.num_threads));
  nlohmann::ordered_json cases = nlohmann::ordered_json::array();
  bool agrees = true;
  for (const std::string& name : options.cases) {
    const Case work = maker.make(name, sensor, options.num_instances);
    std::vector<Contestant> all = contestantsOf(device, sensor, work, options);
    findErrors(all, sensor, work, options);
    const double largest = summarise(all.front().errors).max;
    if (largest > kLargestError) {
      std::fprintf(stderr, "cell_rays: %s: taxelsim's total force is off by %.2g, more than %.2g\n", name.c_str(), largest, kLargestError);
      agrees = false;
      continue;
    }
    timeAll(all, work, options);
    cases.push_back(report(work, all, options));
  }
  if (!options.json.empty())
    writeJson(options.json, {{"bench", "cell_rays"},
                             {"machine", machine(device.info())},
                             {"sensor", sensor.name},
                             {"num_instances", options.num_instances},
                             {"num_solved", options.num_solved},
                             {"repetitions", options.repetitions},
                             {"cases", cases}});
  return agrees ? 0 : 1;
}

}  // namespace
}  // namespace taxelsim::bench

int main(int argc, char** argv) {
  using namespace taxelsim::bench;
  Options options;
  CLI::App app("Area sampling compared with Embree at several rays per cell: errors against the double-precision twin, and frames/s");
  app.add_option("--json", options.json, "Write the results to this JSON file");
  app.add_option("--case", options.cases, "Cases of peers, separated by commas")->delimiter(',');
  app.add_option("--instances", options.num_instances, "Instances of the batch")->check(CLI::Range(1, 1 << 20))->capture_default_str();
  app.add_option("--solved", options.num_solved, "Instances that are compared with the twin")
      ->check(CLI::Range(1, 1024))
      ->capture_default_str();
  app.add_option("--repetitions", options.repetitions, "Timed repetitions")->check(CLI::Range(1, 10000))->capture_default_str();
  app.add_option("--threads", options.num_threads, "Threads of Embree and the twin; 0: one per core")
      ->check(CLI::Range(0, 1024))
      ->capture_default_str();
  app.add_option("--sensor", options.sensor, "Sensor file, with law winkler on one grid")->capture_default_str();
  app.add_option("--device", options.device, "Device, as for `taxelsim frame --device`");
  CLI11_PARSE(app, argc, argv);
  return exitStatus([&] { return run(options); });
}
