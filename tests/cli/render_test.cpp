// `render` of an episode as a moving picture.
#include "cli/command_line.h"
#include "cli/moving_picture.h"
#include "cli/pressed_pad.h"
#include "support/test.h"

namespace taxelsim::testing {
namespace {

using ::testing::HasSubstr;

constexpr const char* kScene = R"(format_version: 1
name: press
kind: servo
sensor: SENSOR
objects: [OBJECT]
episode: {num_steps: 6, simulation_rate: 40}
randomization: {depth_mm: 0.4}
controller: {tactile_servo: {edge_angle: {kp: 1}, exploration_velocity_mm: 20}}
record: [RECORD]
)";
const std::string kFlat = TAXELSIM_SOURCE_DIR "/scenes/sensors/wts0614_soft_cover.yaml";
const std::string kCurved = TAXELSIM_SOURCE_DIR "/scenes/sensors/weiss_dsa_distal.yaml";
const std::string kMeshes = TAXELSIM_SOURCE_DIR "/scenes/objects";
const std::string kRod = "{cylinder: {radius_mm: 4, length_mm: 30}, name: rod, orientation: {rpy_deg: [90, 0, 0]}}";
const std::string kAll = "tactile_image, features, poses";

class MovingPictures : public ::testing::Test {
 protected:
  std::string at(const std::string& name) const { return root_ / name; }

  // Two episodes in the folder `name`.
  std::string generate(const std::string& name, const std::string& sensor, const std::string& object, const std::string& record,
                       const std::string& more = "") const {
    std::string text = kScene;
    for (const auto& [word, value] : {std::pair{"SENSOR", sensor}, {"OBJECT", object}, {"RECORD", record}})
      text.replace(text.find(word), std::strlen(word), value);
    const std::filesystem::path scene = root_.write(name + ".yaml", text + more);
    succeed({"generate", scene, "-o", at(name), "--episodes", "2"});
    return at(name);
  }

  // Expects a refusal with `part`, and no file.
  void expectNoPicture(std::vector<std::string> arguments, const std::string& part) const {
    arguments.insert(arguments.begin(), {"render", "-o", at("refused.webp")});
    expectRefused(runTaxelsim(arguments), part);
    EXPECT_FALSE(std::filesystem::exists(at("refused.webp")));
  }

 private:
  TemporaryDirectory root_;
};

TEST_F(MovingPictures, HaveTheFramesAndTimesOfTheEpisode) {
  const std::string data = generate("d", kFlat, kRod, kAll);
  const Outcome outcome = succeed({"render", data, "-o", at("a.webp"), "--episode", "1"});
  EXPECT_EQ(outcome.out, at("a.webp") + ": 6 frames, 0.15 s\n");
  const MovingPicture real(at("a.webp"));
  EXPECT_EQ(real.durations, std::vector<int>(6, 25));
  EXPECT_EQ(real.width, 900);
  succeed({"render", data, "-o", at("slow.webp"), "--episode", "1", "--speed", "0.5"});
  EXPECT_EQ(MovingPicture(at("slow.webp")).durations, std::vector<int>(6, 50));
  succeed({"render", data, "-o", at("fast.webp"), "--episode", "1", "--speed", "2"});
  EXPECT_EQ(MovingPicture(at("fast.webp")).durations, std::vector<int>(3, 25)) << "at most 50 pictures per second: every second frame";
  succeed({"render", data, "-o", at("again.webp"), "--episode", "1"});
  EXPECT_EQ(contentOf(at("again.webp")), contentOf(at("a.webp")));
  expectNoPicture({data}, "--episode is missing: a moving picture shows one episode");
  expectNoPicture({data, "--episode", "2"}, "--episode 2: " + data + " has episodes 0 to 1");
  expectNoPicture({data, "--episode", "0", "--speed", "1000"}, "--speed 1000 is not allowed");
  expectNoPicture({data, "--episode", "0", "--speed", "1e-9"}, "--speed 1e-09 is not allowed");
  expectNoPicture({data, "--episode", "0", "--speed", "0"}, "--speed");
}

TEST_F(MovingPictures, NameTheColumnThatIsMissing) {
  expectNoPicture({generate("poses", kFlat, kRod, "tactile_image, features"), "--episode", "0"}, "no column data/pose");
  expectNoPicture({generate("features", kFlat, kRod, "tactile_image, poses"), "--episode", "0"}, "no column data/total_force");
  writePressedPad(at("pad"));
  expectNoPicture({at("pad"), "--episode", "0"}, at("pad") + ": no column data/pose of one sensor");
}

TEST_F(MovingPictures, ShowOneSensor) {
  const std::string two = "robot: {pan_tilt: {sensors: [{link: tilt}, {link: tilt, mount: {position_mm: [60, 0, 0]}}]}}\n";
  expectNoPicture({generate("two", kFlat, kRod, kAll, two), "--episode", "0"}, "no column data/pose of one sensor");
}

TEST_F(MovingPictures, FindMeshesInAssets) {
  const std::string data = generate("mesh", kFlat, "{mesh: " + kMeshes + "/hex_prism.obj, orientation: {rpy_deg: [30, 0, 90]}}", kAll);
  expectNoPicture({data, "--episode", "0"}, "hex_prism.obj with SHA-256");
  expectNoPicture({data, "--episode", "0", "--assets", at("none")}, "--assets " + at("none") + ": no such folder");
  std::filesystem::create_directories(at("other"));
  std::ofstream(at("other/hex_prism.obj")) << "v 0 0 0\n";
  expectNoPicture({data, "--episode", "0", "--assets", at("other")}, "hex_prism.obj with SHA-256");
  succeed({"render", "-o", at("a.webp"), "--episode", "0", "--assets", at("other"), "--assets", kMeshes, data});
  EXPECT_EQ(MovingPicture(at("a.webp")).durations.size(), 6u);
}

TEST_F(MovingPictures, ShowCurvedSensors) {
  succeed({"render", generate("curved", kCurved, kRod, kAll), "-o", at("a.webp"), "--episode", "0"});
  EXPECT_EQ(MovingPicture(at("a.webp")).durations.size(), 6u);
}

TEST_F(MovingPictures, NeedTwoFrames) {
  const std::string text = "format_version: 1\nname: one\nkind: contacts\nsensor: " + kFlat + "\nobjects: [" + kRod +
                           "]\nrandomization: {load: 1}\nrecord: [" + kAll + "]\n";
  std::ofstream(at("one.yaml")) << text;
  succeed({"generate", at("one.yaml"), "-o", at("one"), "--episodes", "2"});
  expectNoPicture({at("one"), "--episode", "0"}, "an episode of one frame does not move");
}

}  // namespace
}  // namespace taxelsim::testing
