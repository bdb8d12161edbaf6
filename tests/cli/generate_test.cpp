// `generate`: bytes that depend neither on the batch size nor on interruptions; refusals.
#include <csignal>

#include "cli/command_line.h"
#include "support/test.h"

namespace taxelsim::testing {
namespace {

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

// All files of a data set by name, without the lock.
std::map<std::string, std::string> filesOf(const std::string& directory) {
  std::map<std::string, std::string> files;
  for (const auto& entry : std::filesystem::directory_iterator(directory)) {
    if (entry.path().filename().string().find("lock") == std::string::npos)
      files[entry.path().filename().string()] = contentOf(entry.path());
  }
  return files;
}

void expectSame(const std::map<std::string, std::string>& files, const std::map<std::string, std::string>& expected,
                const std::string& what) {
  ASSERT_EQ(files.size(), expected.size()) << what;
  for (const auto& [name, bytes] : expected) {
    ASSERT_TRUE(files.contains(name)) << what << ": " << name;
    EXPECT_TRUE(files.at(name) == bytes) << what << ": " << name << " differs";
  }
}

TEST(Generate, SameBytesForAnyBatchSize) {
  const TemporaryDirectory root;
  const std::string scene = writeScene(root / "scene.yaml");
  std::map<std::string, std::string> expected;
  for (const int batch_size : {1, 7, 256, 4096}) {
    const std::string out = root / ("out" + std::to_string(batch_size));
    const Outcome outcome = runTaxelsim({"generate", scene, "-o", out, "--batch-size", std::to_string(batch_size)});
    ASSERT_EQ(outcome.status, 0) << outcome.err;
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
  ASSERT_EQ(runTaxelsim(whole).status, 0);
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
  ASSERT_EQ(runTaxelsim(killed).status, 0);
  expectSame(filesOf(root / "killed"), filesOf(root / "whole"), "after the kills");
}

TEST(Generate, AnInterruptLeavesWholeShardsAndAResumableSet) {
  const TemporaryDirectory root;
  const std::string scene = writeScene(root / "scene.yaml", 1200);
  const std::vector<std::string> command{"generate", scene, "-o", root / "out", "--batch-size", "8"};
  const Outcome stopped = runTaxelsim(command, {.signal = SIGINT, .signal_after = 0.6});
  ASSERT_EQ(stopped.status, 130) << stopped.err;
  ASSERT_EQ(runTaxelsim(command).status, 0);
  ASSERT_EQ(runTaxelsim({"generate", scene, "-o", root / "whole"}).status, 0);
  expectSame(filesOf(root / "out"), filesOf(root / "whole"), "after the interrupt");
}

TEST(Generate, RepairsABrokenShard) {
  const TemporaryDirectory root;
  const std::string scene = writeScene(root / "scene.yaml");
  const std::vector<std::string> command{"generate", scene, "-o", root / "out"};
  ASSERT_EQ(runTaxelsim(command).status, 0);
  const auto whole = filesOf(root / "out");
  std::ofstream(root / "out/shard-000001.h5", std::ios::app) << "x";
  EXPECT_EQ(runTaxelsim(command).status, 2);
  std::vector<std::string> repair = command;
  repair.emplace_back("--repair");
  const Outcome outcome = runTaxelsim(repair);
  ASSERT_EQ(outcome.status, 0) << outcome.err;
  EXPECT_NE(outcome.err.find("the shard is removed and made again"), std::string::npos) << outcome.err;
  expectSame(filesOf(root / "out"), whole, "after the repair");
}

TEST(Generate, AnotherSceneOrSeedIsRefused) {
  const TemporaryDirectory root;
  const std::string scene = writeScene(root / "scene.yaml");
  ASSERT_EQ(runTaxelsim({"generate", scene, "-o", root / "out"}).status, 0);
  const auto before = filesOf(root / "out");
  expectRefused(runTaxelsim({"--log-level", "error", "generate", scene, "-o", root / "out", "--seed", "4"}), "seed");
  expectRefused(runTaxelsim({"--log-level", "error", "generate", writeScene(root / "other.yaml", 13), "-o", root / "out"}),
                "another scene: episode.num_steps: 12 there, 13 requested");
  expectSame(filesOf(root / "out"), before, "after the refusals");
}

TEST(Generate, AGrownDataSetHasTheBytesOfOneMadeAtOnce) {
  const TemporaryDirectory root;
  const std::string scene = writeScene(root / "scene.yaml");
  ASSERT_EQ(runTaxelsim({"generate", scene, "-o", root / "whole"}).status, 0);
  ASSERT_EQ(runTaxelsim({"generate", scene, "-o", root / "grown", "--episodes", "16"}).status, 0);
  const Outcome outcome = runTaxelsim({"generate", scene, "-o", root / "grown", "--episodes", "36"});
  ASSERT_EQ(outcome.status, 0) << outcome.err;
  EXPECT_NE(outcome.out.find("36 episodes (16 found on disk)"), std::string::npos) << outcome.out;
  expectSame(filesOf(root / "grown"), filesOf(root / "whole"), "16, then 36 episodes");
}

TEST(Generate, ADataSetWithAPartialShardCannotGrow) {
  const TemporaryDirectory root;
  const std::string scene = writeScene(root / "scene.yaml");
  ASSERT_EQ(runTaxelsim({"generate", scene, "-o", root / "out", "--episodes", "12"}).status, 0);
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
  const Outcome outcome = runTaxelsim({"generate", root / "scene.yaml", "-o", root / "out"});
  EXPECT_EQ(outcome.status, 0) << outcome.err;
  // The ball carries at most pi k d^2 (R - d/3) at d = 2 mm, 9.4 N; the plane carries 100 N.
  EXPECT_NE(outcome.err.find("warning: object ball: load out of reach in "), std::string::npos) << outcome.err;
  EXPECT_NE(outcome.err.find("pressed through the skin, it carried "), std::string::npos) << outcome.err;
  EXPECT_EQ(outcome.err.find("object half_space"), std::string::npos) << outcome.err;
  EXPECT_EQ(outcome.out.find("out of reach"), std::string::npos) << outcome.out;
}

TEST(Generate, WarnsOfSizesInMillimetres) {
  const TemporaryDirectory root;
  std::ofstream(root / "scene.yaml") << "format_version: 1\nname: large\nkind: contacts\nsensor: " << kSensor
                                     << "\nobjects: [{sphere: {radius: 3}}]\nrandomization: {load: 1}\ndata_set: {episodes: 1}\n";
  const Outcome outcome = runTaxelsim({"generate", root / "scene.yaml", "-o", root / "out"});
  EXPECT_EQ(outcome.status, 0) << outcome.err;
  EXPECT_NE(
      outcome.err.find("scene.yaml:5:20: objects[0].sphere: the object is 6 m long; are its sizes in millimetres? Give them by keys that "
                       "end in _mm\n"),
      std::string::npos)
      << outcome.err;
}

TEST(Generate, WithoutADriverOneLineNamesThePackageToInstall) {
  const TemporaryDirectory root;
  const Outcome outcome = runTaxelsim({"generate", writeScene(root / "scene.yaml"), "-o", root / "out"},
                                      {.environment = {"VK_ICD_FILENAMES=/nonexistent.json", "VK_DRIVER_FILES=/nonexistent.json"}});
  EXPECT_EQ(outcome.status, 1);
  EXPECT_NE(outcome.err.find("taxelsim: "), std::string::npos) << outcome.err;
  EXPECT_NE(outcome.err.find("mesa-vulkan-drivers"), std::string::npos) << outcome.err;
}

}  // namespace
}  // namespace taxelsim::testing
