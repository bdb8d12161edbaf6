// Several writers in one directory: claims, lost writers, refusals by name, and the step that completes the data set.
#include <sys/wait.h>
#include <unistd.h>

#include <csignal>
#include <fstream>

#include "dataset/example.h"
#include "taxelsim/version.h"

namespace taxelsim::testing {
namespace {

constexpr std::uint64_t kNumShards = 15;

Manifest sharedManifest() {
  Manifest manifest = exampleManifest();
  manifest.program_version = kVersion;
  manifest.num_episodes = 4 * kNumShards - 1;
  manifest.probe_sha256 = std::string(64, 'a');
  return manifest;
}

DatasetWriterOptions all() {
  return {.shards = ShardRange{.first = 0, .end = kNumShards}};
}

// Writes the shards of the range that no other process has claimed.
void work(const std::filesystem::path& directory, const DatasetWriterOptions& options) {
  const Manifest manifest = sharedManifest();
  DatasetWriter writer(directory, manifest, options);
  for (std::uint64_t shard = options.shards->first; shard < options.shards->end; ++shard)
    if (writer.claim(shard)) writer.writeShard(shard, exampleShard(manifest, shard));
}

template <typename Function>
pid_t inChild(Function function) {
  const pid_t child = fork();
  if (child == 0) {
    function();
    _exit(0);
  }
  return child;
}

int statusOf(pid_t child) {
  int status = -1;
  waitpid(child, &status, 0);
  return status;
}

TEST(SharedDirectory, WritersTogetherGiveTheBytesOfOne) {
  const TemporaryDirectory directory;
  writeExample(directory / "one", sharedManifest());
  std::vector<pid_t> children;
  for (int i = 0; i < 3; ++i) children.push_back(inChild([&] { work(directory / "many", all()); }));
  for (const pid_t child : children) ASSERT_EQ(statusOf(child), 0);
  ASSERT_TRUE(finishDataset(directory / "many"));
  EXPECT_EQ(filesIn(directory / "many"), filesIn(directory / "one"));
  ASSERT_TRUE(finishDataset(directory / "many")) << "may be repeated";
  EXPECT_EQ(filesIn(directory / "many"), filesIn(directory / "one"));
}

TEST(SharedDirectory, PartsCoverAllShardsOnce) {
  for (const std::uint64_t num_shards : {1, 5, 16, 17, 1'000'000}) {
    for (const std::uint64_t num_parts : {1, 2, 7, 16, 20}) {
      std::uint64_t next = 0;
      for (std::uint64_t part = 1; part <= num_parts; ++part) {
        const ShardRange range = partOfShards(num_shards, part, num_parts);
        EXPECT_EQ(range.first, next);
        EXPECT_LE(range.end - range.first, num_shards / num_parts + 1);
        EXPECT_GE(range.end - range.first, num_shards / num_parts);
        next = range.end;
      }
      EXPECT_EQ(next, num_shards);
    }
  }
}

TEST(SharedDirectory, AClaimEndsWithItsProcess) {
  const TemporaryDirectory directory;
  writeExample(directory / "one", sharedManifest());
  int ready[2];
  ASSERT_EQ(pipe(ready), 0);
  const pid_t child = inChild([&] {
    DatasetWriter writer(directory / "many", sharedManifest(), all());
    const char claimed = writer.claim(3) ? 1 : 0;
    std::ofstream(directory / "many/.shard-000003.h5.tmp-7") << "half";
    if (::write(ready[1], &claimed, 1) == 1) pause();
  });
  char claimed = 0;
  ASSERT_EQ(read(ready[0], &claimed, 1), 1);
  ASSERT_EQ(claimed, 1);
  {
    DatasetWriter writer(directory / "many", sharedManifest(), all());
    EXPECT_FALSE(writer.claim(3)) << "of another process";
    EXPECT_TRUE(writer.claim(2));
    EXPECT_TRUE(writer.claim(2)) << "its own";
    kill(child, SIGKILL);
    EXPECT_TRUE(WIFSIGNALED(statusOf(child)));
    EXPECT_TRUE(writer.claim(3)) << "of a lost process";
    writer.writeShard(2, exampleShard(sharedManifest(), 2));
    EXPECT_FALSE(writer.claim(2)) << "complete";
  }
  work(directory / "many", all());
  ASSERT_TRUE(finishDataset(directory / "many"));
  EXPECT_EQ(filesIn(directory / "many"), filesIn(directory / "one")) << "without what the lost process left";
  close(ready[0]);
  close(ready[1]);
}

TEST(SharedDirectory, ProgramsThatDifferAreRefusedByName) {
  const TemporaryDirectory directory;
  const DatasetWriter first(directory / "d", sharedManifest(), all());
  const auto expectRejected = [&](const std::string& part, auto change) {
    Manifest manifest = sharedManifest();
    change(manifest);
    expectError(ErrorKind::kInput, part, [&] { DatasetWriter(directory / "d", manifest, all()); });
  };
  expectRejected("another program version (" + std::string(kVersion) + " there, 9.9.9 requested)",
                 [](Manifest& m) { m.program_version = "9.9.9"; });
  expectRejected("another device (" + sharedManifest().device + " there, GPU, driver 2 requested)",
                 [](Manifest& m) { m.device = "GPU, driver 2"; });
  expectRejected("another scene", [](Manifest& m) { m.scene += "x: 1\n"; });
  expectRejected("probe_sha256: " + std::string(64, 'a') + " there, " + std::string(64, 'b') + " here",
                 [](Manifest& m) { m.probe_sha256 = std::string(64, 'b'); });
  expectRejected("cannot extend it", [](Manifest& m) { m.num_episodes += 4; });
  expectError(ErrorKind::kInput, "shards: 0 to 15 requested, the data set has 0 to 14",
              [&] { DatasetWriter(directory / "d", sharedManifest(), {.shards = ShardRange{.first = 0, .end = kNumShards + 1}}); });
}

TEST(SharedDirectory, IsEitherSharedOrNot) {
  const TemporaryDirectory directory;
  {
    const DatasetWriter shared(directory / "d", sharedManifest(), all());
    EXPECT_NO_THROW(DatasetWriter(directory / "d", sharedManifest(), all()));
    expectError(ErrorKind::kIo, "another process is writing", [&] { DatasetWriter(directory / "d", sharedManifest()); });
    expectError(ErrorKind::kIo, "another process is writing", [&] { finishDataset(directory / "d"); });
  }
  const DatasetWriter alone(directory / "d", sharedManifest());
  expectError(ErrorKind::kIo, "another process is writing", [&] { DatasetWriter(directory / "d", sharedManifest(), all()); });
}

TEST(SharedDirectory, ADataSetWithoutProbeIsAccepted) {
  const TemporaryDirectory directory;
  Manifest old = sharedManifest();
  old.probe_sha256.clear();
  { const DatasetWriter writer(directory / "d", old, all()); }
  EXPECT_NO_THROW(DatasetWriter(directory / "d", sharedManifest(), all()));
  EXPECT_EQ(readManifest(directory / "d").probe_sha256, "") << "the manifest stays as it is";
}

TEST(Finish, NamesMissingAndBrokenShardsAndAnotherVersion) {
  const TemporaryDirectory directory;
  work(directory / "d", {.shards = ShardRange{.first = 0, .end = 3}});
  work(directory / "d", {.shards = ShardRange{.first = 5, .end = kNumShards - 1}});
  const auto before = filesIn(directory / "d");
  expectError(ErrorKind::kInput, "shard-000003.h5 is missing; missing shards: 3..4, 14 (3 of 15)", [&] { finishDataset(directory / "d"); });
  work(directory / "d", all());
  const std::string whole = filesIn(directory / "d")["shard-000007.h5"];
  overwrite(directory / "d/shard-000007.h5", whole.substr(0, whole.size() - 1));
  expectError(ErrorKind::kInput, "shard-000007.h5: its SHA-256 is", [&] { finishDataset(directory / "d"); });
  EXPECT_FALSE(std::filesystem::exists(directory / "d/dataset.h5"));
  overwrite(directory / "d/shard-000007.h5", whole);
  EXPECT_TRUE(finishDataset(directory / "d"));
  Manifest other = sharedManifest();
  other.program_version = "9.9.9";
  writeExample(directory / "other", other);
  expectError(ErrorKind::kInput, "taxelsim 9.9.9 wrote this data set", [&] { finishDataset(directory / "other"); });
}

TEST(SharedDirectory, RepairsTheShardsOfTheRangeOnly) {
  const TemporaryDirectory directory;
  work(directory / "d", all());
  const auto whole = filesIn(directory / "d");
  for (const char* name : {"shard-000002.h5", "shard-000009.h5"}) overwrite(directory / "d" / name, whole.at(name) + "x");
  const ShardRange range{.first = 0, .end = 5};
  expectError(ErrorKind::kInput, "shard-000002.h5", [&] { work(directory / "d", {.shards = range}); });
  work(directory / "d", {.repair = true, .shards = range});
  const auto files = filesIn(directory / "d");
  EXPECT_EQ(files.at("shard-000002.h5"), whole.at("shard-000002.h5"));
  EXPECT_EQ(files.at("shard-000009.h5"), whole.at("shard-000009.h5") + "x");
}

}  // namespace
}  // namespace taxelsim::testing
