// Corrupt shards, locks and full disks. Corrupt shards are reported by name, never read as data and never overwritten.
#include <fcntl.h>
#include <sys/file.h>
#include <sys/resource.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <unistd.h>

#include <csignal>

#include "dataset/example.h"

namespace taxelsim::testing {
namespace {

constexpr std::size_t kFlipStride = 101;  // bytes between flipped bits; prime, so that every bit of a byte is flipped somewhere

// checkShards() with contents and DatasetWriter must both report the shard by name, and leave the files unchanged.
void expectCorrupt(const std::filesystem::path& directory, const std::string& shard, const std::string& what) {
  SCOPED_TRACE(what);
  const auto before = filesIn(directory);
  bool found = false;
  for (const ShardStatus& status : checkShards(directory, /*contents=*/true)) {
    if (status.state != ShardStatus::State::kBroken) continue;
    found = true;
    EXPECT_NE(status.problem.find(shard), std::string::npos) << status.problem;
  }
  EXPECT_TRUE(found) << "not detected";
  expectError(ErrorKind::kInput, shard, [&] { DatasetWriter(directory, exampleManifest()); });
  EXPECT_EQ(filesIn(directory), before) << "files changed";
}

TEST(Corruption, DetectsTruncatedShards) {
  const TemporaryDirectory directory;
  writeExample(directory / "d", exampleManifest());
  const std::string whole = filesIn(directory / "d")["shard-000001.h5"];
  for (const std::size_t size : {std::size_t{0}, std::size_t{7}, std::size_t{100}, whole.size() / 2, whole.size() - 1}) {
    overwrite(directory / "d/shard-000001.h5", whole.substr(0, size));
    expectCorrupt(directory / "d", "shard-000001.h5", "truncated to " + std::to_string(size));
    for (const bool allow_incomplete : {false, true}) {
      const DatasetReader reader(directory / "d", allow_incomplete);
      expectError(ErrorKind::kInput, "shard-000001.h5", [&] { reader.readAsDouble("data/total_force", 0, reader.numFrames()); });
    }
  }
}

TEST(Corruption, DetectsFlippedBits) {
  for (const int compression : {0, 4}) {
    const TemporaryDirectory directory;
    Manifest manifest = exampleManifest();
    manifest.num_episodes = manifest.episodes_per_shard = 4;
    manifest.compression = compression;
    writeExample(directory / "d", manifest);
    std::string bytes = filesIn(directory / "d")["shard-000000.h5"];
    for (std::size_t i = 0; i < bytes.size(); i += kFlipStride) {
      bytes[i] ^= static_cast<char>(1 << i % 8);
      overwrite(directory / "d/shard-000000.h5", bytes);
      bytes[i] ^= static_cast<char>(1 << i % 8);
      ASSERT_EQ(checkShards(directory / "d", true)[0].state, ShardStatus::State::kBroken) << "byte " << i;
    }
    overwrite(directory / "d/shard-000000.h5", bytes);
    EXPECT_EQ(checkShards(directory / "d", true)[0].problem, "");
  }
}

TEST(Corruption, DetectsAppendedBytes) {
  const TemporaryDirectory directory;
  writeExample(directory / "d", exampleManifest());
  overwrite(directory / "d/shard-000001.h5", filesIn(directory / "d")["shard-000001.h5"] + "x");
  expectCorrupt(directory / "d", "shard-000001.h5", "one byte appended");
}

TEST(Corruption, DetectsMissingAndInvalidChecksums) {
  const TemporaryDirectory directory;
  writeExample(directory / "d", exampleManifest());
  const std::filesystem::path checksum = directory / "d/shard-000001.h5.sha256";
  const std::string line = filesIn(directory / "d")["shard-000001.h5.sha256"];
  std::string other = line;
  other[0] = other[0] == '0' ? '1' : '0';
  std::string upper = line;
  upper[5] = 'A';
  for (const std::string& text :
       {other, upper, line.substr(0, 64), line + line, std::string("{}"), std::string(5000, '0'), std::string()}) {
    overwrite(checksum, text);
    expectCorrupt(directory / "d", "shard-000001.h5", "checksum file: " + text.substr(0, 100));
  }
  std::filesystem::remove(checksum);
  expectCorrupt(directory / "d", "shard-000001.h5.sha256 is missing", "no checksum file");
  ASSERT_EQ(mkfifo(checksum.c_str(), 0600), 0);
  EXPECT_EQ(checkShards(directory / "d", true)[1].state, ShardStatus::State::kBroken) << "a FIFO is not read";
  std::filesystem::remove(checksum);
  overwrite(checksum, line);
  EXPECT_EQ(checkShards(directory / "d", true)[1].problem, "");
}

TEST(ChecksumFile, IsWrittenBeforeItsShard) {
  const TemporaryDirectory directory;
  DatasetWriter writer(directory / "d", exampleManifest());
  std::filesystem::create_directories(directory / "d/shard-000000.h5.sha256/in_the_way");
  expectError(ErrorKind::kIo, "shard-000000.h5.sha256", [&] { writer.writeShard(0, exampleShard(exampleManifest(), 0)); });
  EXPECT_FALSE(std::filesystem::exists(directory / "d/shard-000000.h5")) << "a shard without a checksum";
  std::filesystem::remove_all(directory / "d/shard-000000.h5.sha256");
  writer.writeShard(0, exampleShard(exampleManifest(), 0));
  EXPECT_EQ(checkShards(directory / "d", true)[0].problem, "");
}

TEST(Corruption, ReportsTheStateOfTheView) {
  const TemporaryDirectory directory;
  writeExample(directory / "d", exampleManifest());
  const auto files = filesIn(directory / "d");
  EXPECT_EQ(checkView(directory / "d").state, ViewStatus::State::kWhole);
  std::string bytes = files.at("dataset.h5");
  bytes[bytes.size() / 2] ^= 1;
  overwrite(directory / "d/dataset.h5", bytes);
  EXPECT_EQ(checkView(directory / "d").state, ViewStatus::State::kBroken);
  EXPECT_NE(checkView(directory / "d").problem.find("dataset.h5: its SHA-256"), std::string::npos);
  std::filesystem::remove(directory / "d/dataset.h5");
  EXPECT_EQ(checkView(directory / "d").state, ViewStatus::State::kMissing);
  DatasetWriter(directory / "d", exampleManifest()).finish();
  EXPECT_EQ(filesIn(directory / "d"), files) << "written again";

  const auto expectForeign = [&](const std::string& part, auto change) {
    Manifest other = exampleManifest();
    change(other);
    const TemporaryDirectory elsewhere;
    writeExample(elsewhere / "d", other);
    for (const char* name : {"dataset.h5", "dataset.h5.sha256"}) overwrite(directory / "d" / name, filesIn(elsewhere / "d")[name]);
    EXPECT_NE(checkView(directory / "d").problem.find(part), std::string::npos) << checkView(directory / "d").problem;
  };
  expectForeign("seed is 4", [](Manifest& m) { m.seed = 4; });
  expectForeign("policy", [](Manifest& m) { m.policy = "another"; });
}

TEST(Corruption, DetectsShardsWithOtherEpisodeLengthsThanTheView) {
  const TemporaryDirectory directory;
  writeExample(directory / "d", exampleManifest());
  DatasetWriter writer(directory / "o", exampleManifest());
  for (std::uint64_t shard = 0; shard < 3; ++shard) {
    ShardData data = exampleShard(exampleManifest(), shard);
    ASSERT_NE(data.episode_lengths[0], data.episode_lengths[1]);
    std::swap(data.episode_lengths[0], data.episode_lengths[1]);
    writer.writeShard(shard, data);
  }
  writer.finish();
  for (const char* name : {"shard-000001.h5", "shard-000001.h5.sha256"}) overwrite(directory / "d" / name, filesIn(directory / "o")[name]);
  const DatasetReader reader(directory / "d");
  expectError(ErrorKind::kInput, "shard-000001.h5: its episodes have other lengths than in dataset.h5",
              [&] { reader.readAsDouble("data/total_force", 0, reader.numFrames()); });
}

TEST(Corruption, DetectsAFlippedBitInAColumn) {
  const TemporaryDirectory directory;
  writeExample(directory / "d", exampleManifest());
  const ShardData data = exampleShard(exampleManifest(), 2);
  std::string bytes = filesIn(directory / "d")["shard-000002.h5"];
  const std::string image(reinterpret_cast<const char*>(data.columns[0].data()), data.columns[0].size());
  const std::size_t place = bytes.find(image);
  ASSERT_NE(place, std::string::npos) << "an uncompressed column is stored as is";
  bytes[place + 5] ^= 1;
  overwrite(directory / "d/shard-000002.h5", bytes);
  expectCorrupt(directory / "d", "shard-000002.h5", "one bit of one pixel");
  EXPECT_EQ(checkShards(directory / "d", false)[2].state, ShardStatus::State::kBroken);
}

TEST(Corruption, DetectsForeignShards) {
  const TemporaryDirectory directory;
  writeExample(directory / "d", exampleManifest());
  const auto files = filesIn(directory / "d");
  const auto foreign = [&](const std::string& what, auto change) {
    Manifest other = exampleManifest();
    change(other);
    const TemporaryDirectory elsewhere;
    writeExample(elsewhere / "o", other);
    overwrite(directory / "d/shard-000000.h5", filesIn(elsewhere / "o")["shard-000000.h5"]);
    renewChecksum(directory / "d/shard-000000.h5");
    expectCorrupt(directory / "d", "shard-000000.h5", what);
  };
  foreign("scene", [](Manifest& m) { m.scene = "name: other\n"; });
  foreign("seed", [](Manifest& m) { m.seed = 4; });
  foreign("device", [](Manifest& m) { m.device = "GPU"; });
  foreign("version", [](Manifest& m) { m.program_version = "0"; });
  foreign("episodes per shard", [](Manifest& m) { m.episodes_per_shard = 2; });
  foreign("type", [](Manifest& m) { m.columns[1].type = ScalarType::kFloat64; });
  foreign("policy", [](Manifest& m) { m.policy = "servo v2"; });
  foreign("unit", [](Manifest& m) { m.columns[1].unit = "kN"; });
  foreign("length", [](Manifest& m) { m.columns[9].text_length = 6; });
  foreign("column", [](Manifest& m) { m.columns[1].name = "data/other"; });
  overwrite(directory / "d/shard-000000.h5", files.at("shard-000001.h5"));
  renewChecksum(directory / "d/shard-000000.h5");
  expectCorrupt(directory / "d", "shard-000000.h5", "another shard of the same data set");
  overwrite(directory / "d/shard-000000.h5", "not HDF5 at all");
  renewChecksum(directory / "d/shard-000000.h5");
  expectCorrupt(directory / "d", "shard-000000.h5", "text");
}

TEST(Corruption, ReportsMissingShards) {
  const TemporaryDirectory directory;
  writeExample(directory / "d", exampleManifest());
  std::filesystem::remove(directory / "d/shard-000001.h5");
  expectError(ErrorKind::kInput, "shard-000001.h5: the shard is missing", [&] { DatasetReader(directory / "d"); });
  const DatasetReader reader(directory / "d", /*allow_incomplete=*/true);
  EXPECT_EQ(reader.missingShards(), std::vector<std::uint64_t>{1});
  EXPECT_EQ(reader.numEpisodes(), 7u);
  const std::vector<double> episodes = reader.readAsDouble("meta/episode", 3, 2);
  const double step = 7;  // difference of the synthetic values of consecutive episodes
  EXPECT_EQ(episodes[1] - episodes[0], 5 * step) << "episode 3 is followed by episode 8";
  EXPECT_EQ(checkShards(directory / "d", true)[1].state, ShardStatus::State::kMissing);
}

TEST(Corruption, RejectsDirectoriesWithoutDataSet) {
  const TemporaryDirectory directory;
  expectError(ErrorKind::kInput, "no data set", [&] { DatasetReader(directory / "nothing"); });
  expectError(ErrorKind::kInput, "no data set", [&] { checkShards(directory.path(), false); });
}

TEST(Lock, AllowsOneWriter) {
  const TemporaryDirectory directory;
  {
    const DatasetWriter writer(directory / "d", exampleManifest());
    expectError(ErrorKind::kIo, "another process", [&] { DatasetWriter(directory / "d", exampleManifest()); });
    const pid_t child = fork();
    if (child == 0) {
      try {
        DatasetWriter(directory / "d", exampleManifest());
        _exit(0);
      } catch (const Error& error) {
        _exit(error.kind() == ErrorKind::kIo ? 3 : 4);
      }
    }
    int status = 0;
    waitpid(child, &status, 0);
    EXPECT_EQ(WEXITSTATUS(status), 3);
  }
  EXPECT_NO_THROW(DatasetWriter(directory / "d", exampleManifest()));
  EXPECT_FALSE(std::filesystem::exists(directory / "d/.lock"));
}

// In a directory that others may write to, a link under the name of the lock would make the writer create or change another file.
TEST(Lock, FollowsNoLinks) {
  const TemporaryDirectory directory;
  std::filesystem::create_directory(directory / "d");
  std::filesystem::create_symlink(directory / "elsewhere", directory / "d/.lock");
  expectError(ErrorKind::kIo, ".lock", [&] { DatasetWriter(directory / "d", exampleManifest()); });
  EXPECT_FALSE(std::filesystem::exists(directory / "elsewhere"));
}

TEST(Lock, IsReleasedWhenItsProcessIsKilled) {
  const TemporaryDirectory directory;
  int ready[2];
  ASSERT_EQ(pipe(ready), 0);
  const pid_t child = fork();
  if (child == 0) {
    const DatasetWriter writer(directory / "d", exampleManifest());
    const char byte = 1;
    if (write(ready[1], &byte, 1) != 1) _exit(1);
    while (true) pause();
  }
  char byte = 0;
  ASSERT_EQ(read(ready[0], &byte, 1), 1);
  expectError(ErrorKind::kIo, "another process", [&] { DatasetWriter(directory / "d", exampleManifest()); });
  kill(child, SIGKILL);
  waitpid(child, nullptr, 0);
  EXPECT_NO_THROW(DatasetWriter(directory / "d", exampleManifest()));
  close(ready[0]);
  close(ready[1]);
}

// A limit on the file size simulates a full disk: write() fails half way.
TEST(DiskFull, IsAnErrorAndLeavesNoFile) {
  const TemporaryDirectory directory;
  const pid_t child = fork();
  if (child == 0) {
    signal(SIGXFSZ, SIG_IGN);
    DatasetWriter writer(directory / "d", exampleManifest());
    const rlimit limit{1000, 1000};
    setrlimit(RLIMIT_FSIZE, &limit);
    for (int attempt = 0; attempt < 2; ++attempt) {
      try {
        writer.writeShard(0, exampleShard(exampleManifest(), 0));
        _exit(1);
      } catch (const Error& error) {
        if (error.kind() != ErrorKind::kIo || std::string(error.what()).find("shard-000000.h5") == std::string::npos) _exit(2);
      }
    }
    _exit(writer.isComplete(0) ? 3 : 0);
  }
  int status = 0;
  waitpid(child, &status, 0);
  ASSERT_TRUE(WIFEXITED(status));
  EXPECT_EQ(WEXITSTATUS(status), 0);
  const auto files = filesIn(directory / "d");
  EXPECT_EQ(files.count("dataset.yaml"), 1u);
  for (const auto& [name, bytes] : files)
    EXPECT_TRUE(name == "dataset.yaml" || name == ".lock" || name == "shard-000000.h5.sha256") << name;
  EXPECT_EQ(checkShards(directory / "d", true)[0].state, ShardStatus::State::kMissing) << "a checksum alone is no shard";
}

}  // namespace
}  // namespace taxelsim::testing
