// `generate --shards`, `--part` and `finish`: several processes in one directory, one of them lost.
#include <csignal>
#include <future>
#include <nlohmann/json.hpp>

#include "cli/command_line.h"
#include "support/test.h"

namespace taxelsim::testing {
namespace {

using ::testing::HasSubstr;

constexpr const char* kOtherProbe = "0123456789abcdef0123456789abcdef0123456789abcdef0123456789abcdef";

// One frame of 24 spheres, by default in six shards.
std::string writeScene(const std::string& file, const std::string& radius = "5", int episodes_per_shard = 4) {
  std::ofstream(file) << "format_version: 1\nname: balls\nkind: contacts\nsensor: " << TAXELSIM_SOURCE_DIR
                      << "/scenes/sensors/wts0614_soft_cover.yaml\nobjects: [{sphere: {radius_mm: " << radius
                      << "}}]\nrandomization: {load: [0.1, 1]}\nrecord: [tactile_image]\n"
                      << "data_set: {episodes: 24, seed: 1, episodes_per_shard: " << episodes_per_shard << "}\n";
  return file;
}

TEST(Shards, ProcessesTogetherGiveTheBytesOfOneAlsoAfterAKill) {
  const TemporaryDirectory root;
  const std::string scene = writeScene(root / "scene.yaml"), many = root / "many";
  succeed({"generate", scene, "-o", root / "one"});

  // Killed at any time, a process leaves complete shards, or none, and claims that have ended.
  runTaxelsim({"generate", scene, "-o", many, "--part", "1/2", "--batch-size", "1"}, {.signal = SIGKILL, .signal_after = 0.5});
  std::vector<std::future<Outcome>> processes;
  for (const auto& choice : {std::pair{"--part", "1/2"}, std::pair{"--shards", "2..5"}, std::pair{"--shards", "1..3"}})
    processes.push_back(std::async(std::launch::async, [&, choice] {
      return runTaxelsim({"generate", scene, "-o", many, choice.first, choice.second, "--batch-size", "4"});
    }));
  for (std::future<Outcome>& process : processes) {
    const Outcome outcome = process.get();
    EXPECT_EQ(outcome.status, 0) << outcome.err;
    EXPECT_THAT(outcome.out, HasSubstr("of 6 complete"));
  }
  EXPECT_FALSE(std::filesystem::exists(many + "/dataset.h5"));

  std::filesystem::rename(many + "/shard-000004.h5", root / "shard");
  expectRefused(runTaxelsim({"finish", many}), "shard-000004.h5 is missing; missing shards: 4 (1 of 6)");
  std::filesystem::rename(root / "shard", many + "/shard-000004.h5");
  const Outcome finished = succeed({"finish", many});
  EXPECT_THAT(finished.out, HasSubstr("6 shards verified"));
  EXPECT_EQ(filesOf(many), filesOf(root / "one"));

  expectRefused(runTaxelsim({"--log-level", "error", "generate", writeScene(root / "other.yaml", "6"), "-o", many, "--part", "1/2"}),
                "another scene: objects[0].sphere.radius");
  const std::string manifest = contentOf(many + "/dataset.yaml");
  for (const auto& [key, value, part] : {std::tuple{"program_version: ", "\"9.9.9\"", "another program version (9.9.9 there, "},
                                         std::tuple{"device: ", "\"a GPU\"", "another device (a GPU there, "},
                                         std::tuple{"probe_sha256: ", kOtherProbe, "computes other values"}}) {
    const std::size_t begin = manifest.find(std::string("\n") + key) + 1 + std::string(key).size();
    std::ofstream(many + "/dataset.yaml") << manifest.substr(0, begin) << value << manifest.substr(manifest.find('\n', begin));
    expectRefused(runTaxelsim({"--log-level", "error", "generate", scene, "-o", many, "--part", "1/2"}), part);
  }
}

TEST(Shards, RangesThatAreNoneAreRefused) {
  const TemporaryDirectory root;
  const std::string scene = writeScene(root / "scene.yaml");
  const auto refuse = [&](const std::string& option, const std::string& value, const std::string& part) {
    expectRefused(runTaxelsim({"generate", scene, "-o", root / "out", option, value}), part);
  };
  for (const char* value : {"5..2", "1-2", "..3", "1..", "-1..3", "a..b", "1..2x"}) refuse("--shards", value, "is not FIRST..LAST");
  for (const char* value : {"0/3", "4/3", "1/0", "3", "1/2/3", "-1/3"}) refuse("--part", value, "is not K/N");
  refuse("--shards", "2..6", "--shards: 2..6 is not allowed: the data set has shards 0 to 5");
  EXPECT_EQ(runTaxelsim({"generate", scene, "-o", root / "out", "--part", "1/2", "--shards", "0..1"}).status, 2) << "both";
  EXPECT_FALSE(std::filesystem::exists(root / "out"));
  const Outcome empty = succeed({"generate", scene, "-o", root / "out", "--part", "7/7"});
  EXPECT_THAT(empty.out, HasSubstr("part 7/7 of 6 shards is empty"));
}

TEST(Shards, InspectReadsASampleOfManyAndNoticesChanges) {
  const TemporaryDirectory root;
  const std::string out = root / "out";
  succeed({"generate", writeScene(root / "scene.yaml", "5", 1), "-o", out, "--episodes", "20"});
  const auto inspect = [&](std::vector<std::string> options) {
    options.insert(options.begin(), {"inspect", out, "--json"});
    return nlohmann::json::parse(runTaxelsim(options).out);
  };
  const nlohmann::json quick = inspect({});
  EXPECT_EQ(quick["shards"]["whole"], 20);
  EXPECT_GT(quick["shards"]["vouched_for"], 0) << "all but those of the same tick of the clock as the list";
  EXPECT_EQ(quick["checked"], "sizes and times");
  EXPECT_EQ(quick["statistics_of_shards"], 16);
  const nlohmann::json all = inspect({"--verify"});
  EXPECT_EQ(all["shards"]["vouched_for"], 0);
  EXPECT_EQ(all["checked"], "all bytes");
  EXPECT_EQ(all["statistics_of_shards"], 20);
  const Outcome text = runTaxelsim({"inspect", out});
  EXPECT_THAT(text.out, HasSubstr("values    of 16 of 20 shards; --verify reads all"));
  EXPECT_THAT(text.out, HasSubstr(" of 20 shards unchanged since they were verified (sizes and times)"));
  EXPECT_THAT(text.out, HasSubstr("; --verify reads all bytes\n"));

  std::filesystem::remove(out + "/shard-000019.h5");
  EXPECT_EQ(inspect({})["shards"]["missing"], nlohmann::json::array({19}));
  std::filesystem::resize_file(out + "/shard-000010.h5", 1000);
  expectRefused(runTaxelsim({"inspect", out}), "shard-000010.h5: its SHA-256");
}

}  // namespace
}  // namespace taxelsim::testing
