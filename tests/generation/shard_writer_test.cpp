#include "generation/shard_writer.h"

#include "episodes/example_scene.h"
#include "support/test.h"
#include "taxelsim/error.h"

namespace taxelsim {
namespace {

constexpr std::uint64_t kNumShards = 6;

Manifest smallManifest() {
  Manifest manifest;
  manifest.scene = "name: writer\n";
  manifest.sensor_name = "array";
  manifest.num_episodes = kNumShards;
  manifest.episodes_per_shard = 1;
  manifest.program_version = "0";
  manifest.device = "none";
  manifest.columns = {{"data/a", ScalarType::kFloat32, {}, "N", "A.", false}};
  return manifest;
}

std::unique_ptr<ShardBuffer> bufferOf(std::uint64_t shard) {
  auto buffer = std::make_unique<ShardBuffer>();
  buffer->shard = shard;
  buffer->data.episode_lengths = {1};
  const float value = static_cast<float>(shard);
  buffer->data.columns.assign(1, std::vector<std::byte>(sizeof value));
  std::memcpy(buffer->data.columns[0].data(), &value, sizeof value);
  return buffer;
}

class ShardWriterThreads : public ::testing::TestWithParam<int> {};

TEST_P(ShardWriterThreads, WriteAllShardsAndReturnBuffers) {
  const TestDirectory directory;
  DatasetWriter dataset(directory.path(), smallManifest());
  ShardWriter writer(dataset, 2, GetParam());
  for (std::uint64_t shard = 0; shard < kNumShards; ++shard) writer.submit(bufferOf(shard));
  writer.close();
  EXPECT_EQ(writer.numEpisodesWritten(), kNumShards);
  int num_buffers = 0;
  while (writer.reclaim()) ++num_buffers;
  EXPECT_EQ(num_buffers, static_cast<int>(kNumShards));
  dataset.finish();
  const DatasetReader reader(directory.path());
  EXPECT_EQ(reader.readAsDouble("data/a", 0, kNumShards), (std::vector<double>{0, 1, 2, 3, 4, 5}));
}

TEST(ShardWriter, DestructorWritesQueuedShards) {
  const TestDirectory directory;
  DatasetWriter dataset(directory.path(), smallManifest());
  {
    ShardWriter writer(dataset, kNumShards);
    for (std::uint64_t shard = 0; shard < kNumShards; ++shard) writer.submit(bufferOf(shard));
  }
  for (std::uint64_t shard = 0; shard < kNumShards; ++shard) EXPECT_TRUE(dataset.isComplete(shard)) << shard;
}

// The directory is removed: submit() must throw instead of blocking.
TEST_P(ShardWriterThreads, RethrowWriteErrors) {
  const TestDirectory directory;
  DatasetWriter dataset(directory.path(), smallManifest());
  std::filesystem::remove_all(directory.path());
  ShardWriter writer(dataset, 1, GetParam());
  EXPECT_THROW(
      {
        for (std::uint64_t shard = 0; shard < kNumShards; ++shard) writer.submit(bufferOf(shard));
      },
      Error);
  EXPECT_THROW(writer.close(), Error);
  EXPECT_EQ(writer.numEpisodesWritten(), 0u);
}

INSTANTIATE_TEST_SUITE_P(Threads, ShardWriterThreads, ::testing::Values(1, 3));

// Large compressed shards from several threads have the bytes of one thread.
TEST(ShardWriter, ShardsDoNotDependOnThreads) {
  Manifest manifest = smallManifest();
  manifest.compression = 1;
  constexpr std::size_t kNumValues = 100'000;
  manifest.columns[0].shape = {kNumValues};
  std::vector<std::string> checksums;
  for (const int num_threads : {1, 4}) {
    const TestDirectory directory;
    DatasetWriter dataset(directory.path(), manifest);
    ShardWriter writer(dataset, kNumShards, num_threads);
    for (std::uint64_t shard = 0; shard < kNumShards; ++shard) {
      std::unique_ptr<ShardBuffer> buffer = bufferOf(shard);
      std::vector<float> values(kNumValues);
      for (std::size_t i = 0; i < kNumValues; ++i) values[i] = std::sin(static_cast<float>(i * (shard + 1)));
      const std::span<const std::byte> bytes = std::as_bytes(std::span(values));
      buffer->data.columns[0].assign(bytes.begin(), bytes.end());
      writer.submit(std::move(buffer));
    }
    writer.close();
    dataset.finish();
    checksums.push_back(testing::contentOf(directory.path() / "dataset.checksums"));
  }
  EXPECT_FALSE(checksums[0].empty());
  EXPECT_EQ(checksums[0], checksums[1]);
}

}  // namespace
}  // namespace taxelsim
