// SIGKILL at any time leaves only complete shards, and resuming gives the same bytes as an uninterrupted run.
#include <sys/wait.h>
#include <unistd.h>

#include <chrono>
#include <csignal>
#include <random>
#include <thread>

#include "dataset/example.h"

namespace taxelsim::testing {
namespace {

constexpr int kKills = 25;
constexpr int kMaxLifetime = 60000;  // us; about the duration of a complete run

Manifest killManifest() {
  Manifest manifest = exampleManifest();
  manifest.num_episodes = 60;
  manifest.columns[0].shape = {300, 300};  // large, so that most kills occur while a shard is written
  return manifest;
}

TEST(Kill, LeavesOnlyCompleteShards) {
  const TemporaryDirectory directory;
  const Manifest manifest = killManifest();
  writeExample(directory / "complete", manifest);
  const auto complete = filesIn(directory / "complete");

  std::mt19937 random(20);  // times of the kills
  int interrupted = 0;
  std::filesystem::path target;
  for (int i = 0; i < kKills; ++i) {
    if (i % 5 == 0) target = directory / ("cut" + std::to_string(i));
    const pid_t child = fork();
    if (child == 0) {
      DatasetWriter writer(target, manifest);
      for (std::uint64_t shard = 0; shard < manifest.numShards(); ++shard)
        if (!writer.isComplete(shard)) writer.writeShard(shard, exampleShard(manifest, shard));
      writer.finish();
      _exit(0);
    }
    std::this_thread::sleep_for(std::chrono::microseconds(random() % kMaxLifetime));
    kill(child, SIGKILL);
    int status = 0;
    waitpid(child, &status, 0);
    interrupted += WIFSIGNALED(status);
    if (!std::filesystem::exists(target)) continue;
    for (const auto& [name, bytes] : filesIn(target)) {
      if (name.starts_with(".") || name == "dataset.checksums") continue;  // which lists the shards that the last run found
      ASSERT_TRUE(complete.count(name)) << name;
      EXPECT_TRUE(complete.at(name) == bytes) << name << " differs";
    }
    if (i % 5 != 4) continue;
    {
      DatasetWriter writer(target, manifest);
      for (std::uint64_t shard = 0; shard < manifest.numShards(); ++shard)
        if (!writer.isComplete(shard)) writer.writeShard(shard, exampleShard(manifest, shard));
      writer.finish();
    }
    EXPECT_TRUE(filesIn(target) == complete) << "files differ after resuming";
  }
  EXPECT_GT(interrupted, 0);
}

}  // namespace
}  // namespace taxelsim::testing
