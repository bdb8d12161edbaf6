#include "peers/contest.h"

#include <algorithm>
#include <cstdio>
#include <functional>
#include <memory>

#include "peers/embree_peer.h"
#include "peers/ode_peer.h"
#include "peers/taxelsim_peer.h"
#include "peers/twin_peer.h"
#include "peers/vector_peer.h"
#include "taxelsim/error.h"
#ifdef TAXELSIM_HAS_MUJOCO
#include "peers/mujoco_peer.h"
#endif

namespace taxelsim::bench {
namespace {

constexpr int kWarmUps = 2;
constexpr std::size_t kFirstLook = 256;  // instances of the first verification; fast peers are verified on all
// s, about: a slower peer runs on fewer instances, a power of two, at least kFewest.
constexpr double kLongestRun = 0.5;
constexpr std::size_t kFewest = 64;
// s: where a turn takes longer, there are at most kFewRepetitions.
constexpr double kLongestTurn = 3;
constexpr int kFewRepetitions = 3;

double secondsOf(const std::function<void()>& work) {
  const Stopwatch watch;
  work();
  return watch.seconds();
}

std::unique_ptr<Peer> makePeer(const std::string& name, const Sensor& sensor, const Case& work, int threads) {
  std::vector<const Mesh*> meshes;
  for (const auto& mesh : work.meshes) meshes.push_back(mesh.get());
  const int num_instances = static_cast<int>(work.numInstances());
  if (name == "embree") return std::make_unique<EmbreePeer>(sensor, meshes, Rays::kAll, threads);
  if (name == "embree_box") return std::make_unique<EmbreePeer>(sensor, meshes, Rays::kUnderBox, threads);
  if (work.embree_only) return nullptr;
  if (name == "vector") return std::make_unique<VectorPeer>(sensor, work.objects, threads);
  if (work.slides) return nullptr;
  if (name == "twin") return std::make_unique<TwinPeer>(sensor, work.objects, threads);
  if (name == "ode_samples") return std::make_unique<OdePeer>(sensor, work.objects, OdeCells::kSamples, num_instances, threads);
  if (name == "ode_taxels") return std::make_unique<OdePeer>(sensor, work.objects, OdeCells::kTaxels, num_instances, threads);
#ifdef TAXELSIM_HAS_MUJOCO
  if (name == "mujoco") return std::make_unique<MujocoPeer>(sensor, work.objects, MujocoPoints::kTaxels, threads);
  if (name == "mujoco_samples") return std::make_unique<MujocoPeer>(sensor, work.objects, MujocoPoints::kSamples, threads);
#endif
  return nullptr;
}

// A peer and its results. It runs on the first instances of a case.
struct Entrant {
  std::unique_ptr<Peer> peer;
  PeerResult result;
  PeerFrame frame;

  void run(const Poses& poses, std::size_t count) {
    peer->run(std::span(poses.ids).first(count), std::span(poses.X_SO).first(count), frame);
  }
};

// Number of instances that take about kLongestRun at this rate.
std::size_t fewEnough(double frames_per_second, std::size_t num_instances) {
  if (static_cast<double>(num_instances) <= frames_per_second * kLongestRun) return num_instances;
  std::size_t count = kFewest;
  while (2 * static_cast<double>(count) <= frames_per_second * kLongestRun) count *= 2;
  return std::min(count, num_instances);
}

// Verifies on few instances, then on as many as its speed allows.
void verify(Entrant& entrant, const Sensor& sensor, const Case& work, const Poses& poses, const PeerFrame& ours) {
  entrant.frame.with_forces = true;
  std::size_t count = std::min(kFirstLook, work.numInstances());
  double seconds = secondsOf([&] { entrant.run(poses, count); });
  const double rate = static_cast<double>(count) / seconds;
  if (const std::size_t more = fewEnough(rate, work.numInstances()); more > count) {
    count = more;
    entrant.run(poses, count);
  }
  entrant.result.agreement = compare(sensor, ours, entrant.frame, entrant.peer->trust(), work.depth_tolerance);
  entrant.frame = {.with_forces = false, .spread_force = {}, .tactile_image = {}, .measured = {}, .clean = {}};
  entrant.run(poses, count);
  seconds = secondsOf([&] { entrant.run(poses, count); });
  entrant.result.num_instances = fewEnough(static_cast<double>(count) / seconds, work.numInstances());
}

double touchedFraction(const PeerFrame& frame) {
  const auto touched = std::count_if(frame.spread_force.begin(), frame.spread_force.end(), [](float force) { return force > 0; });
  return static_cast<double>(touched) / static_cast<double>(frame.spread_force.size());
}

CaseResult headerOf(const Sensor& sensor, const Case& work) {
  const GridPatch& patch = sensor.patches[0];
  return {.name = work.name,
          .note = work.note,
          .array = std::to_string(patch.num_rows) + "x" + std::to_string(patch.num_cols),
          .num_instances = work.numInstances(),
          .num_triangles = work.num_triangles,
          .load_seconds = work.load_seconds,
          .peers = {},
          .submit_to_read = {},
          .device = {},
          .contact_pass = {}};
}

// Makes the peers and verifies them on the last frame of the first turn: sliding objects have moved by then.
std::vector<Entrant> verifiedPeers(const Model& model, const Sensor& sensor, const Case& work, const ContestOptions& options,
                                   CaseResult& result) {
  PeerFrame ours;
  const std::vector<Poses> first_turn = framesOf(work, 0);
  TaxelsimPeer simulator(model, static_cast<int>(work.numInstances()), {.with_forces = true});
  for (const Poses& poses : first_turn) simulator.run(poses.ids, poses.X_SO, ours);
  result.touched = touchedFraction(ours);

  std::vector<Entrant> entrants;
  for (const std::string& name : options.peers) {
    Entrant entrant;
    try {
      entrant.peer = makePeer(name, sensor, work, options.threads);
    } catch (const Error& error) {
      result.note += (result.note.empty() ? "" : "; ") + name + " is left out: " + error.what();
    }
    if (!entrant.peer) continue;
    entrant.result.name = entrant.peer->name();
    entrant.result.what = entrant.peer->what();
    verify(entrant, sensor, work, first_turn.back(), ours);
    result.complete &= entrant.result.agreement->agrees || entrant.peer->trust() == Trust::kOtherModel;
    entrants.push_back(std::move(entrant));
  }
  return entrants;
}

// Times taxelsim and its peers in turns. Times are per frame of the batch.
class Turns {
 public:
  Turns(const Model& model, const Case& work, std::vector<Entrant>& entrants, CaseResult& result)
      : device_(model.device().info()),
        work_(work),
        simulator_(model, static_cast<int>(work.numInstances()), {.device_clock = true}),
        entrants_(entrants),
        result_(result) {}

  // `timed`: whether to keep the times; otherwise it is a warm-up. A GPU has rested while the peers ran.
  void run(bool timed) {
    const std::vector<Poses> frames = framesOf(work_, turn_), others = framesOf(work_, turn_ + 1);
    ++turn_;
    warmUp(device_, [&] { simulator_.run(others[0].ids, others[0].X_SO, frame_); });
    const double seconds = runSimulator(frames, timed);
    const double per_frame = 1 / static_cast<double>(frames.size()), per_instance = seconds / static_cast<double>(work_.numInstances());
    for (Entrant& entrant : entrants_) {
      if (!entrant.result.agreement->agrees) continue;
      const std::size_t count = entrant.result.num_instances;
      double theirs = 0;
      for (const Poses& poses : frames) theirs += per_frame * secondsOf([&] { entrant.run(poses, count); });
      if (!timed) continue;
      entrant.result.seconds.push_back(theirs);
      entrant.result.ratios.push_back(theirs / static_cast<double>(count) / per_instance);
    }
  }

  // The times of taxelsim.
  PeerResult own() {
    return {.name = simulator_.name(),
            .what = simulator_.what(),
            .num_instances = work_.numInstances(),
            .seconds = seconds_,
            .ratios = std::vector<double>(seconds_.size(), 1.0)};
  }

 private:
  double runSimulator(const std::vector<Poses>& frames, bool timed) {
    const double per_frame = 1 / static_cast<double>(frames.size());
    double seconds = 0, device_time = 0, contact_time = 0, submit_to_read = 0;
    for (const Poses& poses : frames) {
      seconds += per_frame * secondsOf([&] { simulator_.run(poses.ids, poses.X_SO, frame_); });
      device_time += per_frame * simulator_.timing().total;
      contact_time += per_frame * simulator_.timing().contact;
      submit_to_read += per_frame * simulator_.submitToRead();
    }
    if (timed) {
      seconds_.push_back(seconds);
      result_.device.push_back(device_time);
      result_.contact_pass.push_back(contact_time);
      result_.submit_to_read.push_back(submit_to_read);
    }
    return seconds;
  }

  const DeviceInfo& device_;
  const Case& work_;
  TaxelsimPeer simulator_;
  PeerFrame frame_;
  std::vector<Entrant>& entrants_;
  CaseResult& result_;
  std::vector<double> seconds_;
  int turn_ = 0;
};

}  // namespace

std::vector<std::string> peerNames() {
  return {"embree", "embree_box", "vector", "mujoco", "mujoco_samples", "ode_taxels", "ode_samples", "twin"};
}

std::string missingPeer([[maybe_unused]] const std::string& name) {
#ifndef TAXELSIM_HAS_MUJOCO
  if (name.starts_with("mujoco"))
    return name + " is left out: the program was built without TAXELSIM_MUJOCO, the folder of MuJoCo's Python package";
#endif
  return {};
}

CaseResult runCase(const Device& device, const Sensor& sensor, const Case& work, const ContestOptions& options) {
  CaseResult result = headerOf(sensor, work);
  const Model model(device, {.sensor = sensor, .objects = work.objects});
  std::vector<Entrant> entrants = verifiedPeers(model, sensor, work, options, result);
  Turns turns(model, work, entrants, result);
  double last = 0;  // s
  for (int w = 0; w < kWarmUps; ++w) last = secondsOf([&] { turns.run(false); });
  const int repetitions = last > kLongestTurn ? std::min(kFewRepetitions, options.repetitions) : options.repetitions;
  for (int r = 0; r < repetitions; ++r) turns.run(true);

  result.peers.push_back(turns.own());
  for (Entrant& entrant : entrants) result.peers.push_back(std::move(entrant.result));
  return result;
}

void print(const CaseResult& result) {
  std::printf("%s, %s taxels, %zu instances", result.name.c_str(), result.array.c_str(), result.num_instances);
  if (result.num_triangles > 0) std::printf(", %zu triangles", result.num_triangles);
  std::printf("; %.1f %% of the taxels under contact\n", 100 * result.touched);
  if (!result.note.empty()) std::printf("  %s\n", result.note.c_str());
  if (result.load_seconds > 0) std::printf("  read and simplified in %.1f s\n", result.load_seconds);
  std::printf("  %-15s %14s %10s  %-24s %s\n", "peer", "frames/s", "instances", "taxelsim over peer", "verified");
  for (const PeerResult& peer : result.peers) {
    const std::string verified = peer.agreement ? textOf(*peer.agreement) : peer.what;
    if (peer.seconds.empty()) {
      std::printf("  %-15s %14s %10zu  %-24s %s\n", peer.name.c_str(), "-", peer.agreement->num_instances, "not timed: disagrees",
                  verified.c_str());
      continue;
    }
    const Summary ratio = summarise(peer.ratios);
    char faster[60] = "";
    if (peer.agreement) std::snprintf(faster, sizeof faster, "%.3g (%.3g to %.3g)", ratio.median, ratio.min, ratio.max);
    std::printf("  %-15s %14.0f %10zu  %-24s %s\n", peer.name.c_str(), peer.framesPerSecond(), peer.num_instances, faster,
                verified.c_str());
  }
  const auto rate = [&](const std::vector<double>& seconds) {
    return static_cast<double>(result.num_instances) / summarise(seconds).median;
  };
  std::printf("  taxelsim submit to read %.0f frames/s, device alone %.0f, contact pass %.0f\n\n", rate(result.submit_to_read),
              rate(result.device), rate(result.contact_pass));
  std::fflush(stdout);
}

nlohmann::ordered_json toJson(const CaseResult& result) {
  nlohmann::ordered_json peers = nlohmann::ordered_json::object();
  for (const PeerResult& peer : result.peers) {
    nlohmann::ordered_json& json = peers[peer.name];
    json = {{"what", peer.what}, {"num_instances", peer.num_instances}};
    if (peer.agreement) json["agreement"] = toJson(*peer.agreement);
    if (peer.seconds.empty()) continue;
    json["frames_per_second"] = peer.framesPerSecond();
    json["seconds"] = toJson(peer.seconds);
    if (peer.agreement) json["ratio"] = toJson(peer.ratios);
  }
  return {{"case", result.name},
          {"note", result.note},
          {"array", result.array},
          {"num_instances", result.num_instances},
          {"num_triangles", result.num_triangles},
          {"load_seconds", result.load_seconds},
          {"touched_taxels", result.touched},
          {"seconds_submit_to_read", toJson(result.submit_to_read)},
          {"seconds_device", toJson(result.device)},
          {"seconds_contact_pass", toJson(result.contact_pass)},
          {"peers", peers}};
}

}  // namespace taxelsim::bench
