// `generate`: bytes that depend neither on the batch size nor on interruptions; refusals.
#include <csignal>

#include "cli/command_line.h"
#include "support/test.h"

namespace taxelsim::testing {
namespace {

using ::testing::HasSubstr;
using ::testing::Not;

const std::string kSensor = std::string(TAXELSIM_SOURCE_DIR) + "/scenes/sensors/wts0614_soft_cover.yaml";
const std::string kObjects = std::string(TAXELSIM_SOURCE_DIR) + "/scenes/objects/";

// Servo episodes with meshes and a solid and all random draws, in five shards.
std::string writeScene(const std::string& file, int num_steps = 12) {
  std::ofstream(file)
      << "format_version: 1\nname: small\nkind: servo\nsensor: " << kSensor << "\nobjects:\n  - mesh: " << kObjects
      << "hex_prism.obj\n  - mesh: " << kObjects << "knob_5k.obj\n"
      << "  - cylinder: {radius_mm: 8, length_mm: 40}\n    orientation: {rpy_deg: [90, 0, 0]}\n"
      << "episode: {num_steps: " << num_steps << ", simulation_rate: 100, control_rate: 50}\n"
      << "randomization: {x_mm: [-3, 3], y_mm: [-6, 6], yaw_deg: [-60, 60], tilt_deg: [0, 3], load: [0.5, 3], gain: [0.9, 1.1], "
         "gain_spread: 0.05, noise: [0, 17]}\n"
      << "controller: {tactile_servo: {edge_angle: {kp: 0.8}, total_force: {kp: 2}, center_across: {kp: 1}, exploration_velocity_mm: 5}}\n"
      << "record: [tactile_image, features, ground_truth, tactile_normal_force, penetration_depth, poses, actions]\n"
      << "data_set: {episodes: 36, seed: 3, episodes_per_shard: 8, compression: 1}\n";
  return file;
}

void expectSame(const Files& files, const Files& expected, const std::string& what) {
  ASSERT_EQ(files.size(), expected.size()) << what;
  for (const auto& [name, bytes] : expected) {
    ASSERT_TRUE(files.contains(name)) << what << ": " << name;
    EXPECT_TRUE(files.at(name) == bytes) << what << ": " << name << " differs";
  }
}

TEST(Generate, SameBytesForAnyBatchSize) {
  const TemporaryDirectory root;
  const std::string scene = writeScene(root / "scene.yaml");
  Files expected;
  for (const int batch_size : {1, 7, 256, 4096}) {
    const std::string out = root / ("out" + std::to_string(batch_size));
    succeed({"generate", scene, "-o", out, "--batch-size", std::to_string(batch_size)});
    if (expected.empty()) expected = filesOf(out);
    EXPECT_EQ(expected.size(), 14u) << "five shards and a view with their checksums, a manifest, a list of checksums";
    expectSame(filesOf(out), expected, "batch size " + std::to_string(batch_size));
  }
}

TEST(Generate, SameBytesAfterBeingKilledTenTimes) {
  const TemporaryDirectory root;
  const std::string scene = writeScene(root / "scene.yaml", 150);
  const std::vector<std::string> whole{"generate", scene, "-o", root / "whole", "--batch-size", "8"};
  const auto start = std::chrono::steady_clock::now();
  succeed(whole);
  const double seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  const std::vector<std::string> killed{"generate", scene, "-o", root / "killed", "--batch-size", "8"};
  std::mt19937 random(5);
  int num_killed = 0;
  constexpr int kKills = 10, kMaxRuns = 100;
  for (int run = 0; run < kMaxRuns && num_killed < kKills; ++run) {
    const double after = std::uniform_real_distribution(0.0, seconds)(random);
    const int status = runTaxelsim(killed, {.signal = SIGKILL, .signal_after = after}).status;
    if (!std::filesystem::exists(root / "killed")) continue;
    for (const auto& [name, bytes] : filesOf(root / "killed")) {
      if (name.starts_with("shard-")) {
        EXPECT_TRUE(bytes == contentOf(root / ("whole/" + name))) << name << " is half written";
      }
    }
    if (status == 128 + SIGKILL) {
      ++num_killed;
    } else {  // finished before the kill: complete, and the next run starts anew
      expectSame(filesOf(root / "killed"), filesOf(root / "whole"), "after " + std::to_string(num_killed) + " kills");
      std::filesystem::remove_all(root / "killed");
    }
  }
  EXPECT_EQ(num_killed, kKills);
  succeed(killed);
  expectSame(filesOf(root / "killed"), filesOf(root / "whole"), "after the kills");
}

TEST(Generate, AnInterruptLeavesWholeShardsAndAResumableSet) {
  const TemporaryDirectory root;
  const std::string scene = writeScene(root / "scene.yaml", 1200);
  const std::vector<std::string> command{"generate", scene, "-o", root / "out", "--batch-size", "8"};
  const Outcome stopped = runTaxelsim(command, {.signal = SIGINT, .signal_after = 0.6});
  ASSERT_EQ(stopped.status, 130) << stopped.err;
  succeed(command);
  ASSERT_EQ(runTaxelsim({"generate", scene, "-o", root / "whole"}).status, 0);
  expectSame(filesOf(root / "out"), filesOf(root / "whole"), "after the interrupt");
}

TEST(Generate, RepairsABrokenShard) {
  const TemporaryDirectory root;
  const std::string scene = writeScene(root / "scene.yaml");
  const std::vector<std::string> command{"generate", scene, "-o", root / "out"};
  succeed(command);
  const auto whole = filesOf(root / "out");
  std::ofstream(root / "out/shard-000001.h5", std::ios::app) << "x";
  EXPECT_EQ(runTaxelsim(command).status, 2);
  std::vector<std::string> repair = command;
  repair.emplace_back("--repair");
  const Outcome outcome = succeed(repair);
  EXPECT_THAT(outcome.err, HasSubstr("the shard is removed and made again"));
  expectSame(filesOf(root / "out"), whole, "after the repair");
}

TEST(Generate, AnotherSceneOrSeedIsRefused) {
  const TemporaryDirectory root;
  const std::string scene = writeScene(root / "scene.yaml");
  succeed({"generate", scene, "-o", root / "out"});
  const auto before = filesOf(root / "out");
  expectRefused(runTaxelsim({"--log-level", "error", "generate", scene, "-o", root / "out", "--seed", "4"}), "seed");
  expectRefused(runTaxelsim({"--log-level", "error", "generate", writeScene(root / "other.yaml", 13), "-o", root / "out"}),
                "another scene: episode.num_steps: 12 there, 13 requested");
  expectSame(filesOf(root / "out"), before, "after the refusals");
}

TEST(Generate, AGrownDataSetHasTheBytesOfOneMadeAtOnce) {
  const TemporaryDirectory root;
  const std::string scene = writeScene(root / "scene.yaml");
  succeed({"generate", scene, "-o", root / "whole"});
  succeed({"generate", scene, "-o", root / "grown", "--episodes", "16"});
  const Outcome outcome = succeed({"generate", scene, "-o", root / "grown", "--episodes", "36"});
  EXPECT_THAT(outcome.out, HasSubstr("36 episodes (16 found on disk)"));
  expectSame(filesOf(root / "grown"), filesOf(root / "whole"), "16, then 36 episodes");
}

TEST(Generate, ADataSetWithAPartialShardCannotGrow) {
  const TemporaryDirectory root;
  const std::string scene = writeScene(root / "scene.yaml");
  succeed({"generate", scene, "-o", root / "out", "--episodes", "12"});
  expectRefused(runTaxelsim({"--log-level", "error", "generate", scene, "-o", root / "out", "--episodes", "36"}), "shard-000001.h5");
}

TEST(Generate, BatchesThatDoNotFitAreRefusedBeforeTheyStart) {
  const TemporaryDirectory root;
  const Outcome outcome = runTaxelsim({"--log-level", "error", "generate", writeScene(root / "scene.yaml", 1), "-o", root / "out",
                                       "--episodes", "2000000", "--batch-size", "2000000"});
  expectRefused(outcome, "at most");
  EXPECT_FALSE(std::filesystem::exists(root / "out"));
}

TEST(Generate, WarnsOfObjectsThatCannotCarryTheLoad) {
  const TemporaryDirectory root;
  std::ofstream(root / "scene.yaml") << "format_version: 1\nname: heavy\nkind: contacts\nsensor: " << kSensor
                                     << "\nobjects: [{name: ball, sphere: {radius_mm: 5}}, {half_space: {}}]\n"
                                     << "randomization: {load: 100}\ndata_set: {episodes: 30, seed: 1}\n";
  const Outcome outcome = succeed({"generate", root / "scene.yaml", "-o", root / "out"});
  // The ball carries at most pi k d^2 (R - d/3) at d = 2 mm, 9.4 N; the plane carries 100 N.
  EXPECT_THAT(outcome.err, HasSubstr("warning: object ball: load out of reach in "));
  EXPECT_THAT(outcome.err, HasSubstr("pressed through the skin, it carried "));
  EXPECT_THAT(outcome.err, Not(HasSubstr("object half_space")));
  EXPECT_THAT(outcome.out, Not(HasSubstr("out of reach")));
}

TEST(Generate, WarnsOfSizesInMillimetres) {
  const TemporaryDirectory root;
  std::ofstream(root / "scene.yaml") << "format_version: 1\nname: large\nkind: contacts\nsensor: " << kSensor
                                     << "\nobjects: [{sphere: {radius: 3}}]\nrandomization: {load: 1}\ndata_set: {episodes: 1}\n";
  const Outcome outcome = succeed({"generate", root / "scene.yaml", "-o", root / "out"});
  EXPECT_THAT(outcome.err,
              HasSubstr("scene.yaml:5:20: objects[0].sphere: the object is 6 m long; are its sizes in millimetres? Give them by keys that "
                        "end in _mm\n"));
}

TEST(Generate, WithoutADriverOneLineNamesThePackageToInstall) {
  const TemporaryDirectory root;
  const Outcome outcome = runTaxelsim({"generate", writeScene(root / "scene.yaml"), "-o", root / "out"},
                                      {.environment = {"VK_ICD_FILENAMES=/nonexistent.json", "VK_DRIVER_FILES=/nonexistent.json"}});
  EXPECT_EQ(outcome.status, 1);
  EXPECT_THAT(outcome.err, HasSubstr("taxelsim: "));
  EXPECT_THAT(outcome.err, HasSubstr("mesa-vulkan-drivers"));
}

}  // namespace
}  // namespace taxelsim::testing
