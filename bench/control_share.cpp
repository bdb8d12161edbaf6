// Fraction of a control period that the host spends on controllers, robots and objects, with thousands of servo loops at once. One slice,
// so that host and device do not overlap.
#include <CLI/CLI.hpp>
#include <cstdio>
#include <string>
#include <vector>

#include "episodes/batch.h"
#include "report.h"
#include "taxelsim/error.h"

namespace taxelsim::bench {
namespace {

constexpr int kWarmUps = 5;  // control periods; the first one searches for loads

struct Options {
  std::string scene = TAXELSIM_BENCH "/scenes/edge_servo_5k.yaml";
  std::string json, device;
  int num_instances = 4096;
  int num_ticks = 100;
};

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
    for (const std::uint8_t status : context.robots->status()) num_held_back_ += status != 0 ? 1 : 0;
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

nlohmann::ordered_json runRobot(const Model& model, Scene scene, const std::string& name, const Robot& robot, const Options& options) {
  scene.robot = robot;
  scene.num_steps = options.num_ticks + kWarmUps;
  const SlicePlan plan(scene, {.tactile_normal_force = false, .tactile_shear_force = false, .penetration_depth = false});
  NoSink sink(options.num_instances);
  std::vector<std::unique_ptr<Slice>> slices;
  slices.push_back(std::make_unique<Slice>(model, plan, options.num_instances, sink));
  std::vector<double> control, share, tick;
  int number = 0;
  runEpisodes(model.device(), slices, nullptr, [&](const Slice::Stats& tally) {
    if (++number <= kWarmUps || tally.num_episodes > 0) return;
    control.push_back(tally.control_seconds);
    tick.push_back(tally.control_seconds + tally.wait_seconds);
    share.push_back(control.back() / tick.back());
  });
  // A loop without contact computes nothing, which would falsify the time.
  if (sink.numTouching() < options.num_instances / 2) throw Error(ErrorKind::kDevice, name + ": most instances have lost contact");
  std::printf(
      "%-12s control period %7.2f ms, control %6.2f ms, %5.1f %% (median; %.1f to %.1f); %d in contact at the end, %.1f %% limited\n",
      name.c_str(), 1e3 * summarise(tick).median, 1e3 * summarise(control).median, 100 * summarise(share).median,
      100 * summarise(share).min, 100 * summarise(share).max, sink.numTouching(),
      100.0 * static_cast<double>(sink.numHeldBack()) / number / options.num_instances);
  return {{"robot", name}, {"tick_seconds", toJson(tick)}, {"control_seconds", toJson(control)}, {"control_share", toJson(share)}};
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
    writeJson(options.json, {{"bench", "control_share"},
                             {"machine", machine(device.info())},
                             {"scene", scene.name},
                             {"num_instances", options.num_instances},
                             {"ticks", options.num_ticks},
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
  app.add_option("--device", options.device, "Device, as for `taxelsim frame --device`");
  CLI11_PARSE(app, argc, argv);
  try {
    taxelsim::bench::run(options);
    return 0;
  } catch (const taxelsim::Error& error) {
    std::fprintf(stderr, "%s\n", error.what());
    return error.kind() == taxelsim::ErrorKind::kInput ? 2 : 1;
  }
}
