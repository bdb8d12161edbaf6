// What the host does in a control period of thousands of servo loops: its time by part, what it exchanges with the device, and the fraction
// of the period that controllers, robots and objects take. One slice, so that host and device do not overlap.
#include <CLI/CLI.hpp>
#include <algorithm>
#include <array>
#include <cstdio>
#include <map>
#include <string>
#include <vector>

#include "episodes/batch.h"
#include "report.h"
#include "simulation/host_threads.h"
#include "taxelsim/error.h"

namespace taxelsim::bench {
namespace {

constexpr int kWarmUps = 5;  // control periods; the first one searches for loads

struct Options {
  std::string scene = TAXELSIM_BENCH "/scenes/edge_servo_5k.yaml";
  std::string json, device;
  int num_instances = 4096;
  int num_ticks = 100;
  int num_threads = 0;
  SlicePlan::Loops loops = SlicePlan::Loops::kFaster;
};

using Loops = SlicePlan::Loops;
const std::map<std::string, Loops> kLoops{{"faster", Loops::kFaster}, {"host", Loops::kHost}, {"device", Loops::kDevice}};

// Runs one episode in each instance; discards the frames.
class NoSink : public EpisodeSink {
 public:
  explicit NoSink(int num_instances) : num_left_(num_instances) {}

  std::optional<std::uint64_t> next(int instance) override {
    if (num_left_ == 0) return {};
    --num_left_;
    return static_cast<std::uint64_t>(instance);
  }
  void begin(int, const EpisodeRecord& record) override { num_misses_ += record.load_reached ? 0 : 1; }
  void frame(const FrameView& view, const FrameContext& context) override {
    if (context.times[0] < last_time_) return;
    num_touching_ = 0;
    for (const float force : view.total_force) num_touching_ += force > 0 ? 1 : 0;
    last_time_ = context.times[0];
    for (const std::uint8_t status : context.robot_status) num_held_back_ += status != 0 ? 1 : 0;
  }
  void end(int) override {}

  int numTouching() const { return num_touching_; }
  long numHeldBack() const { return num_held_back_; }

 private:
  int num_left_;
  int num_misses_ = 0, num_touching_ = 0;
  long num_held_back_ = 0;
  double last_time_ = 0;
};

struct Part {
  const char* name;
  double HostTimes::*seconds;
};

constexpr std::array kParts{
    Part{"read", &HostTimes::read},     Part{"episodes", &HostTimes::episodes}, Part{"controller", &HostTimes::controller},
    Part{"robots", &HostTimes::robots}, Part{"objects", &HostTimes::objects},   Part{"inputs", &HostTimes::inputs},
    Part{"submit", &HostTimes::submit}};

// Of every timed control period.
struct Ticks {
  std::vector<double> control, share, period, host;
  std::array<std::vector<double>, kParts.size()> parts;
  std::vector<DeviceTraffic> traffic;

  void add(const Slice::Stats& stats) {
    control.push_back(stats.control_seconds);
    period.push_back(stats.control_seconds + stats.wait_seconds);
    share.push_back(control.back() / period.back());
    host.push_back(0);
    for (std::size_t k = 0; k < kParts.size(); ++k) {
      parts[k].push_back(stats.host.*kParts[k].seconds);
      host.back() += parts[k].back();
    }
    traffic.push_back(stats.traffic);
  }
};

void printTicks(const std::string& name, const Ticks& ticks) {
  std::printf("  host, processor time: %.3f ms (", 1e3 * summarise(ticks.host).median);
  for (std::size_t k = 0; k < kParts.size(); ++k) {
    std::printf("%s%s %.3f", k == 0 ? "" : ", ", kParts[k].name, 1e3 * summarise(ticks.parts[k]).median);
  }
  const DeviceTraffic& traffic = ticks.traffic.back();
  std::printf(")\n  %llu submit, %llu bytes to the device, %llu bytes from the device\n",
              static_cast<unsigned long long>(traffic.num_submits), static_cast<unsigned long long>(traffic.bytes_to_device),
              static_cast<unsigned long long>(traffic.bytes_from_device));
  if (std::any_of(ticks.traffic.begin(), ticks.traffic.end(), [&](const DeviceTraffic& other) { return other != traffic; })) {
    throw Error(ErrorKind::kDevice, name + ": submits or bytes differ between control periods");
  }
}

nlohmann::ordered_json describe(const Ticks& ticks) {
  const DeviceTraffic& traffic = ticks.traffic.back();
  nlohmann::ordered_json parts;
  for (std::size_t k = 0; k < kParts.size(); ++k) parts[kParts[k].name] = toJson(ticks.parts[k]);
  return {{"num_submits", traffic.num_submits},
          {"bytes_to_device", traffic.bytes_to_device},
          {"bytes_from_device", traffic.bytes_from_device},
          {"tick_seconds", toJson(ticks.period)},
          {"control_seconds", toJson(ticks.control)},
          {"control_share", toJson(ticks.share)},
          {"host_processor_seconds", toJson(ticks.host)},
          {"host_processor_seconds_by_part", parts}};
}

nlohmann::ordered_json runRobot(const Model& model, Scene scene, const std::string& name, const Robot& robot, const Options& options) {
  scene.robot = robot;
  scene.num_steps = options.num_ticks + kWarmUps;
  SlicePlan plan(scene, kNoOutputs);
  plan.sink_reads = {.object_poses = false, .sensor_poses = false, .actions = false, .robot_status = true, .joints = false};
  plan.host_threads = options.num_threads;
  plan.loops = options.loops;
  const bool on_device = plan.deviceLoops(model).has_value();
  NoSink sink(options.num_instances);
  Ticks ticks;
  int number = 0;
  const auto runOnce = [&] {
    sink = NoSink(options.num_instances);
    ticks = {};
    number = 0;
    std::vector<std::unique_ptr<Slice>> slices;
    slices.push_back(std::make_unique<Slice>(model, plan, options.num_instances, sink));
    runEpisodes(model.device(), slices, nullptr, [&](const Slice::Stats& tally) {
      if (++number <= kWarmUps || tally.num_episodes > 0) return;
      ticks.add(tally);
    });
  };
  warmUp(model.device().info(), runOnce);
  runOnce();
  // A loop without contact computes nothing, which would falsify the time.
  if (sink.numTouching() < options.num_instances / 2) throw Error(ErrorKind::kDevice, name + ": most instances have lost contact");
  std::printf(
      "%-12s loops on the %s, control period %7.2f ms, control %6.2f ms, %5.1f %% (median; %.1f to %.1f); %d in contact at the end, "
      "%.1f %% limited\n",
      name.c_str(), on_device ? "device" : "host", 1e3 * summarise(ticks.period).median, 1e3 * summarise(ticks.control).median,
      100 * summarise(ticks.share).median, 100 * summarise(ticks.share).min, 100 * summarise(ticks.share).max, sink.numTouching(),
      100.0 * static_cast<double>(sink.numHeldBack()) / number / options.num_instances);
  printTicks(name, ticks);
  nlohmann::ordered_json result{{"robot", name}, {"loops", on_device ? "device" : "host"}};
  result.update(describe(ticks));
  return result;
}

void run(const Options& options) {
  const Device device = Device::open({.device = options.device});
  Scene scene = loadScene(options.scene);
  std::printf("%s, %s; %d loops of %s, %d ticks\n", device.info().name.c_str(), device.info().driver.c_str(), options.num_instances,
              scene.name.c_str(), options.num_ticks);
  const Model model(device, modelOptionsOf(scene));
  UrdfOptions palm{.base_link = "", .sensors = {{"palm", {}}}};
  Manipulator arm = loadUrdf(TAXELSIM_SCENES "/robots/lwr_palm.urdf", palm);
  // Bent away from singular poses, as in lwr_palm.yaml.
  constexpr double kDegree = 0.017453292519943295;
  for (const auto& [joint, position] : {std::pair{1, 30 * kDegree}, {3, -90 * kDegree}, {5, 60 * kDegree}}) {
    arm.joints[static_cast<std::size_t>(joint)].initial_position = position;
  }
  nlohmann::ordered_json results = nlohmann::ordered_json::array();
  results.push_back(runRobot(model, scene, "free_flying", FreeFlying{}, options));
  results.push_back(runRobot(model, scene, "pan_tilt", panTilt({}), options));
  results.push_back(runRobot(model, scene, "lwr_palm", arm, options));
  if (!options.json.empty()) {
    writeJson(options.json,
              {{"bench", "control_share"},
               {"machine", machine(device.info())},
               {"scene", scene.name},
               {"num_instances", options.num_instances},
               {"ticks", options.num_ticks},
               {"host_threads", options.num_threads > 0 ? options.num_threads : hostThreads(device.info().type, options.num_instances)},
               {"robots", results}});
  }
}

}  // namespace
}  // namespace taxelsim::bench

int main(int argc, char** argv) {
  taxelsim::bench::Options options;
  CLI::App app("Fraction of a control period that controllers, robots and objects take on the host");
  app.add_option("--json", options.json, "Write the results to this JSON file");
  app.add_option("--scene", options.scene, "Scene file of kind servo")->capture_default_str();
  app.add_option("--instances", options.num_instances, "Servo loops at once")->check(CLI::Range(1, 1 << 20))->capture_default_str();
  app.add_option("--ticks", options.num_ticks, "Timed control periods per robot")->check(CLI::Range(1, 100000))->capture_default_str();
  app.add_option("--threads", options.num_threads, "Host threads that share the loops; 0: as the library chooses for the device")
      ->check(CLI::Range(0, 256))
      ->capture_default_str();
  app.add_option("--loops", options.loops, "Where the loops are closed: where it is faster, on the host, on the device")
      ->transform(CLI::CheckedTransformer(taxelsim::bench::kLoops, CLI::ignore_case));
  app.add_option("--device", options.device, "Device, as for `taxelsim frame --device`");
  CLI11_PARSE(app, argc, argv);
  return taxelsim::bench::exitStatus([&] { return taxelsim::bench::run(options), 0; });
}
