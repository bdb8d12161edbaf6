// Existing directories: resumed if that gives the same bytes, rejected otherwise.
#include <atomic>
#include <chrono>
#include <thread>

#include "dataset/example.h"
#include "support/test.h"

namespace taxelsim::testing {
namespace {

TEST(Resume, GivesTheSameBytesAsAnUninterruptedRun) {
  const TemporaryDirectory directory;
  const Manifest manifest = exampleManifest();
  writeExample(directory / "whole", manifest);
  {
    DatasetWriter writer(directory / "cut", manifest);
    writer.writeShard(1, exampleShard(manifest, 1));
    expectError(ErrorKind::kIo, "shard-000000.h5", [&] { writer.finish(); });
  }
  overwrite(directory / "cut/.shard-000002.h5.tmp-77", "half");
  overwrite(directory / "cut/shard-000002.h5.sha256", "of a shard that was not renamed");
  {
    DatasetWriter writer(directory / "cut", manifest);
    EXPECT_FALSE(writer.isComplete(0));
    EXPECT_TRUE(writer.isComplete(1));
    EXPECT_FALSE(writer.isComplete(2));
    EXPECT_FALSE(writer.isComplete(3));
    expectError(ErrorKind::kInput, "is complete", [&] { writer.writeShard(1, exampleShard(manifest, 1)); });
    expectError(ErrorKind::kInput, "no shard 3", [&] { writer.writeShard(3, {}); });
    writer.writeShard(0, exampleShard(manifest, 0));
    writer.writeShard(2, exampleShard(manifest, 2));
    writer.finish();
  }
  EXPECT_EQ(filesIn(directory / "whole"), filesIn(directory / "cut"));
}

TEST(Resume, OfACompleteDataSetChangesNothing) {
  const TemporaryDirectory directory;
  writeExample(directory / "d", exampleManifest());
  const auto before = filesIn(directory / "d");
  DatasetWriter(directory / "d", exampleManifest()).finish();
  EXPECT_EQ(filesIn(directory / "d"), before);
}

TEST(Resume, RepairsBrokenShards) {
  const TemporaryDirectory directory;
  const Manifest manifest = exampleManifest();
  writeExample(directory / "d", manifest);
  const auto whole = filesIn(directory / "d");
  overwrite(directory / "d/shard-000000.h5", whole.at("shard-000000.h5") + "x");
  overwrite(directory / "d/shard-000002.h5", whole.at("shard-000001.h5"));  // of other episodes
  renewChecksum(directory / "d/shard-000002.h5");
  const auto broken = filesIn(directory / "d");
  expectError(ErrorKind::kInput, "shard-000000.h5", [&] { DatasetWriter(directory / "d", manifest); });
  EXPECT_EQ(filesIn(directory / "d"), broken);
  {
    DatasetWriter writer(directory / "d", manifest, {.repair = true});
    EXPECT_FALSE(writer.isComplete(0));
    EXPECT_TRUE(writer.isComplete(1));
    EXPECT_FALSE(writer.isComplete(2));
    EXPECT_FALSE(std::filesystem::exists(directory / "d/dataset.h5")) << "it would show zeros";
    for (const std::uint64_t shard : {0, 2}) writer.writeShard(shard, exampleShard(manifest, shard));
    writer.finish();
  }
  EXPECT_EQ(filesIn(directory / "d"), whole);
}

TEST(Resume, ReportsAndStopsTheVerification) {
  const TemporaryDirectory directory;
  const Manifest manifest = exampleManifest();
  writeExample(directory / "d", manifest);
  const auto before = filesIn(directory / "d");
  std::atomic<bool> stop = false;
  std::vector<std::uint64_t> calls;
  DatasetWriterOptions options{.on_verify =
                                   [&](std::uint64_t num_verified, std::uint64_t num_shards) {
                                     EXPECT_EQ(num_shards, 3u);
                                     calls.push_back(num_verified);
                                   },
                               .stop = &stop};
  EXPECT_TRUE(DatasetWriter(directory / "d", manifest, options).isVerified());
  EXPECT_EQ(calls, (std::vector<std::uint64_t>{0, 1, 2, 3}));
  stop = true;
  EXPECT_FALSE(DatasetWriter(directory / "d", manifest, options).isVerified());
  EXPECT_EQ(filesIn(directory / "d"), before);
}

// A sparse shard of 64 GiB takes many seconds.
TEST(Resume, HearsAStopWithinAShard) {
  const TemporaryDirectory directory;
  writeExample(directory / "d", exampleManifest());
  std::filesystem::resize_file(directory / "d/shard-000001.h5", std::uintmax_t{64} << 30);
  std::atomic<bool> stop = false;
  std::thread signal([&] {
    std::this_thread::sleep_for(std::chrono::milliseconds(50));
    stop = true;
  });
  const auto start = std::chrono::steady_clock::now();
  EXPECT_FALSE(DatasetWriter(directory / "d", exampleManifest(), {.stop = &stop}).isVerified());
  EXPECT_LT(std::chrono::steady_clock::now() - start, std::chrono::milliseconds(50 + 500));
  signal.join();
}

TEST(Resume, RejectsManifestsThatGiveOtherBytes) {
  const TemporaryDirectory directory;
  writeExample(directory / "d", exampleManifest());
  const auto before = filesIn(directory / "d");
  const auto expectRejected = [&](const std::string& part, auto change) {
    Manifest manifest = exampleManifest();
    change(manifest);
    expectError(ErrorKind::kInput, part, [&] { DatasetWriter(directory / "d", manifest); });
  };
  expectRejected("another seed", [](Manifest& m) { m.seed = 1; });
  expectRejected("another scene: nothing more there, x: 1 requested", [](Manifest& m) { m.scene += "x: 1\n"; });
  expectRejected("another program version", [](Manifest& m) { m.program_version = "1.2.4"; });
  expectRejected("another device", [](Manifest& m) { m.device = "GPU"; });
  expectRejected("episodes per shard", [](Manifest& m) { m.episodes_per_shard = 5; });
  expectRejected("another compression", [](Manifest& m) { m.compression = 1; });
  expectRejected("another chunk size", [](Manifest& m) { m.chunk_bytes = 1024; });
  expectRejected("another policy (servo v1 there, none requested)", [](Manifest& m) { m.policy.clear(); });
  expectRejected("another sensor", [](Manifest& m) { m.sensor_name = "pad B"; });
  expectRejected("recorded columns", [](Manifest& m) { m.columns.pop_back(); });
  expectRejected("another column", [](Manifest& m) { m.columns[1].name = "data/peak_force"; });
  expectRejected("total_force", [](Manifest& m) { m.columns[1].type = ScalarType::kFloat64; });
  expectRejected("another column " + exampleManifest().columns[9].name, [](Manifest& m) { ++m.columns[9].text_length; });
  expectRejected("not shrink", [](Manifest& m) { m.num_episodes = 8; });
  expectRejected("would change", [](Manifest& m) { m.num_episodes = 12; });
  EXPECT_EQ(filesIn(directory / "d"), before);
}

TEST(Resume, ExtendsIfCompleteShardsAreUnchanged) {
  const TemporaryDirectory directory;
  Manifest longer = exampleManifest();
  longer.num_episodes = 10;
  writeExample(directory / "whole", longer);
  Manifest manifest = longer;
  manifest.num_episodes = 8;
  writeExample(directory / "d", manifest);
  {
    DatasetWriter writer(directory / "d", longer);
    for (const char* name : {"d/dataset.h5", "d/dataset.h5.sha256"})
      EXPECT_FALSE(std::filesystem::exists(directory / name)) << "the view has fewer episodes than the manifest";
    EXPECT_TRUE(writer.isComplete(1));
    writer.writeShard(2, exampleShard(longer, 2));
    writer.finish();
  }
  EXPECT_EQ(filesIn(directory / "whole"), filesIn(directory / "d"));

  // A partial shard that does not exist yet may grow.
  manifest.num_episodes = 6;
  DatasetWriter(directory / "e", manifest).writeShard(0, exampleShard(manifest, 0));
  EXPECT_TRUE(DatasetWriter(directory / "e", longer).isComplete(0));
}

TEST(Resume, RejectsDirectoriesWithOtherFiles) {
  const TemporaryDirectory directory;
  std::filesystem::create_directories(directory / "photos");
  overwrite(directory / "photos/cat.jpg", "cat");
  expectError(ErrorKind::kInput, "cat.jpg", [&] { DatasetWriter(directory / "photos", exampleManifest()); });
  EXPECT_EQ(filesIn(directory / "photos").size(), 1u) << "nothing is added";
  expectError(ErrorKind::kInput, "not a directory", [&] { DatasetWriter(directory / "photos/cat.jpg", exampleManifest()); });
  std::filesystem::create_directories(directory / "other");
  overwrite(directory / "other/dataset.yaml", "path: ../yolo\ntrain: images\n");
  expectError(ErrorKind::kInput, "format_version", [&] { DatasetWriter(directory / "other", exampleManifest()); });
}

TEST(Resume, RejectsNewerFormats) {
  const TemporaryDirectory directory;
  writeExample(directory / "d", exampleManifest());
  std::string text = filesIn(directory / "d")["dataset.yaml"];
  text.replace(text.find("format_version: 2"), 17, "format_version: 3");
  overwrite(directory / "d/dataset.yaml", text);
  expectError(ErrorKind::kInput, "newer", [&] { DatasetWriter(directory / "d", exampleManifest()); });
  expectError(ErrorKind::kInput, "newer", [&] { DatasetReader(directory / "d"); });
}

TEST(Writer, RejectsRowsThatDoNotMatchTheManifest) {
  const TemporaryDirectory directory;
  const Manifest manifest = exampleManifest();
  DatasetWriter writer(directory / "d", manifest);
  const auto expectRejected = [&](const std::string& part, auto change) {
    ShardData data = exampleShard(manifest, 0);
    change(data);
    expectError(ErrorKind::kInput, part, [&] { writer.writeShard(0, data); });
  };
  expectRejected("episodes given", [](ShardData& d) { d.episode_lengths.pop_back(); });
  expectRejected("no frames", [](ShardData& d) { d.episode_lengths[1] = 0; });
  expectRejected("columns given", [](ShardData& d) { d.columns.pop_back(); });
  expectRejected("data/total_force", [](ShardData& d) { d.columns[1].pop_back(); });
  EXPECT_FALSE(writer.isComplete(0));
  EXPECT_FALSE(std::filesystem::exists(directory / "d/shard-000000.h5"));
}

}  // namespace
}  // namespace taxelsim::testing
