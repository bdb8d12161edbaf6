// Faults of clusters: a directory that vanishes under its writers, and machines whose clocks differ. Calls of clock_gettime() in the
// library arrive here, because a program's functions take precedence over libc's.
#include <fcntl.h>
#include <sys/stat.h>
#include <sys/syscall.h>
#include <sys/wait.h>
#include <unistd.h>

#include <chrono>
#include <ctime>
#include <fstream>

#include "dataset/example.h"
#include "taxelsim/version.h"

namespace {
time_t clock_offset = 0;  // s, of the wall clock of this process
}  // namespace

extern "C" int clock_gettime(clockid_t clock, timespec* time) noexcept {
  const long status = syscall(SYS_clock_gettime, clock, time);
  if (status == 0 && (clock == CLOCK_REALTIME || clock == CLOCK_REALTIME_COARSE)) time->tv_sec += clock_offset;
  return static_cast<int>(status);
}

namespace taxelsim::testing {
namespace {

namespace fs = std::filesystem;

constexpr time_t kDay = 86'400;  // s

Manifest manifestOfThisVersion() {
  Manifest manifest = exampleManifest();
  manifest.program_version = kVersion;
  return manifest;
}

DatasetWriterOptions all() {
  return {.shards = ShardRange{.first = 0, .end = exampleManifest().numShards()}};
}

// Makes the shards that are missing and that no other process has claimed.
void work(const fs::path& directory) {
  const Manifest manifest = manifestOfThisVersion();
  DatasetWriter writer(directory, manifest, all());
  for (std::uint64_t shard = 0; shard < manifest.numShards(); ++shard)
    if (writer.claim(shard)) writer.writeShard(shard, exampleShard(manifest, shard));
}

class VanishedDirectory : public ::testing::TestWithParam<bool> {};

// An unmounted file system leaves no directory, or the empty one that it was mounted on.
TEST_P(VanishedDirectory, IsAnErrorAndGetsNoShard) {
  const TemporaryDirectory root;
  const fs::path mount = root / "d", elsewhere = root / "elsewhere";
  const Manifest manifest = manifestOfThisVersion();
  writeExample(root / "one", manifest);
  for (const bool is_shared : {true, false}) {
    fs::remove_all(mount), fs::remove_all(elsewhere);
    {
      DatasetWriter writer(mount, manifest, is_shared ? all() : DatasetWriterOptions{});
      writer.writeShard(0, exampleShard(manifest, 0));
      fs::rename(mount, elsewhere);
      if (GetParam()) fs::create_directory(mount);
      for (int attempt = 0; attempt < 2; ++attempt)
        expectError(ErrorKind::kIo, "d: is not the directory that was opened any more",
                    [&] { writer.writeShard(1, exampleShard(manifest, 1)); });
      if (!is_shared) expectError(ErrorKind::kIo, "d: is not the directory that was opened", [&] { writer.finish(); });
    }
    EXPECT_EQ(fs::exists(mount), GetParam());
    if (GetParam()) {
      EXPECT_TRUE(fs::is_empty(mount)) << "nothing is written where the data set is not";
    }
    fs::remove_all(mount);
    fs::rename(elsewhere, mount);
    work(mount);
    ASSERT_TRUE(finishDataset(mount));
    EXPECT_EQ(filesIn(mount), filesIn(root / "one"));
  }
}

INSTANTIATE_TEST_SUITE_P(Leaves, VanishedDirectory, ::testing::Bool(),
                         [](const auto& tested) { return tested.param ? "AnEmptyOne" : "None"; });

TEST(ClockSkew, DoesNotShow) {
  const TemporaryDirectory directory;
  writeExample(directory / "one", manifestOfThisVersion());
  std::vector<pid_t> children;
  for (const time_t offset : {-400 * kDay, time_t{0}, 400 * kDay}) {
    const pid_t child = fork();
    if (child == 0) {
      clock_offset = offset;
      const auto now = std::chrono::system_clock::to_time_t(std::chrono::system_clock::now());
      if (std::abs(now - offset - ::time(nullptr)) > kDay) _exit(3);  // the clock of the library is not this one
      work(directory / "many");
      _exit(0);
    }
    children.push_back(child);
  }
  for (const pid_t child : children) {
    int status = -1;
    waitpid(child, &status, 0);
    ASSERT_EQ(status, 0);
  }
  // A file server can have a clock of its own: times of one shard are far ahead, those of another far behind.
  const timespec now{.tv_sec = ::time(nullptr), .tv_nsec = 0};
  time_t offset = -400 * kDay;
  for (const char* name : {"shard-000000.h5", "shard-000001.h5"}) {
    const timespec shifted{.tv_sec = now.tv_sec + offset, .tv_nsec = 0};
    const timespec times[2] = {shifted, shifted};
    ASSERT_EQ(::utimensat(AT_FDCWD, (directory / "many" / name).c_str(), times, 0), 0);
    offset = -offset;
  }
  ASSERT_TRUE(finishDataset(directory / "many"));
  EXPECT_EQ(filesIn(directory / "many"), filesIn(directory / "one"));
  for (const ShardStatus& shard : checkShards(directory / "many", false)) EXPECT_EQ(shard.problem, "");
  // A change is noticed also where the new time of modification is older than dataset.checksums.
  std::string bytes = filesIn(directory / "many")["shard-000001.h5"];
  bytes[bytes.size() / 2] ^= 1;
  overwrite(directory / "many/shard-000001.h5", bytes);
  const timespec past{.tv_sec = now.tv_sec - 400 * kDay, .tv_nsec = 0};
  const timespec times[2] = {past, past};
  ASSERT_EQ(::utimensat(AT_FDCWD, (directory / "many/shard-000001.h5").c_str(), times, 0), 0);
  EXPECT_EQ(checkShards(directory / "many", false)[1].state, ShardStatus::State::kBroken);
}

}  // namespace
}  // namespace taxelsim::testing
