// Reading returns the bytes that were written, and files are a pure function of their content.
#include <chrono>
#include <thread>

#include "dataset/column.h"
#include "dataset/example.h"
#include "dataset/manifest.h"
#include "support/test.h"

namespace taxelsim::testing {
namespace {

// Longer than the resolution of HDF5 time stamps (1 s), so that a time stamp would change the file.
constexpr auto kClockTick = std::chrono::milliseconds(1100);

std::vector<std::byte> expectedColumn(const Manifest& manifest, std::size_t column) {
  std::vector<std::byte> all;
  for (std::uint64_t shard = 0; shard < manifest.numShards(); ++shard) {
    const ShardData data = exampleShard(manifest, shard);
    all.insert(all.end(), data.columns[column].begin(), data.columns[column].end());
  }
  return all;
}

class RoundTrip : public ::testing::TestWithParam<int> {};

TEST_P(RoundTrip, ReadsWhatWasWritten) {
  const TemporaryDirectory directory;
  Manifest manifest = exampleManifest();
  manifest.compression = GetParam();
  writeExample(directory / "new/deep", manifest);

  const DatasetReader reader(directory / "new/deep");
  EXPECT_EQ(reader.numEpisodes(), 11u);
  std::uint64_t frames = 0;
  for (std::uint64_t episode = 0; episode < 11; ++episode) {
    frames += exampleLength(episode);
    EXPECT_EQ(reader.episodeEnds()[episode], frames);
  }
  EXPECT_EQ(reader.numFrames(), frames);
  EXPECT_TRUE(reader.missingShards().empty());
  for (std::size_t c = 0; c < manifest.columns.size(); ++c) {
    const Column& column = manifest.columns[c];
    const std::vector<std::byte> expected = expectedColumn(manifest, c);
    const std::uint64_t num_rows = column.per_episode ? 11 : frames;
    EXPECT_EQ(reader.read(column.name, 0, num_rows), expected) << column.name;
    const std::size_t row_bytes = dataset::rowBytes(column);
    for (std::uint64_t first = 0; first <= num_rows; ++first) {
      const std::uint64_t count = std::min<std::uint64_t>(num_rows - first, 6);
      const std::vector<std::byte> expected_rows(expected.begin() + first * row_bytes, expected.begin() + (first + count) * row_bytes);
      EXPECT_EQ(reader.read(column.name, first, count), expected_rows) << column.name << " from " << first;
    }
  }
}

TEST_P(RoundTrip, SameContentGivesSameBytes) {
  const TemporaryDirectory directory;
  Manifest manifest = exampleManifest();
  manifest.compression = GetParam();
  writeExample(directory / "a", manifest);
  std::this_thread::sleep_for(kClockTick);
  writeExample(directory / "b", manifest);
  const auto files = filesIn(directory / "a");
  EXPECT_EQ(files, filesIn(directory / "b"));
  std::vector<std::string> names;
  for (const auto& [name, bytes] : files) names.push_back(name);
  EXPECT_THAT(names, ::testing::ElementsAre("dataset.checksums", "dataset.h5", "dataset.h5.sha256", "dataset.yaml", "shard-000000.h5",
                                            "shard-000000.h5.sha256", "shard-000001.h5", "shard-000001.h5.sha256", "shard-000002.h5",
                                            "shard-000002.h5.sha256"));
}

INSTANTIATE_TEST_SUITE_P(Compression, RoundTrip, ::testing::Values(0, 4));

TEST(Reader, ConvertsAllTypesToDouble) {
  const TemporaryDirectory directory;
  const Manifest manifest = exampleManifest();
  writeExample(directory / "d", manifest);
  const DatasetReader reader(directory / "d");
  for (std::size_t c = 0; c < manifest.columns.size(); ++c) {
    const Column& column = manifest.columns[c];
    if (column.type == ScalarType::kText) continue;
    const std::size_t per_row = dataset::rowBytes(column) / scalarSize(column);
    const std::vector<double> values = reader.readAsDouble(column.name, 5, 6);
    ASSERT_EQ(values.size(), 6 * per_row);
    for (std::size_t i = 0; i < values.size(); ++i) EXPECT_EQ(values[i], exampleNumber(column, c, 5 * per_row + i)) << column.name;
  }
}

TEST(Reader, ReadsTextsWithoutPadding) {
  const TemporaryDirectory directory;
  writeExample(directory / "d", exampleManifest());
  const DatasetReader reader(directory / "d");
  // Column 9: (7 i + 9003) % 60000.
  EXPECT_EQ(reader.readAsText("meta/object_name", 3, 2), (std::vector<std::string>{"9024", "9031"}));
  expectError(ErrorKind::kInput, "text", [&] { reader.readAsDouble("meta/object_name", 0, 1); });
  expectError(ErrorKind::kInput, "numbers", [&] { reader.readAsText("meta/episode", 0, 1); });
}

TEST(Reader, OpensShardsOnlyWhenTheirRowsAreRead) {
  const TemporaryDirectory directory;
  writeExample(directory / "d", exampleManifest());
  overwrite(directory / "d/shard-000001.h5", "broken");
  const DatasetReader reader(directory / "d");
  EXPECT_EQ(reader.numEpisodes(), 11u) << "from dataset.h5";
  EXPECT_EQ(reader.readAsDouble("meta/episode", 0, 4).size(), 4u);
  expectError(ErrorKind::kInput, "shard-000001.h5", [&] { reader.readAsDouble("meta/episode", 0, 5); });
  std::filesystem::remove(directory / "d/dataset.h5");
  expectError(ErrorKind::kInput, "shard-000001.h5", [&] { DatasetReader(directory / "d"); });
}

TEST(Reader, NeedsNoView) {
  const TemporaryDirectory directory;
  writeExample(directory / "d", exampleManifest());
  const std::vector<std::uint64_t> ends = DatasetReader(directory / "d").episodeEnds();
  const std::vector<double> poses = DatasetReader(directory / "d").readAsDouble("data/pose", 0, ends.back());
  overwrite(directory / "d/dataset.h5", "broken");
  EXPECT_EQ(DatasetReader(directory / "d").episodeEnds(), ends);
  std::filesystem::remove(directory / "d/dataset.h5");
  EXPECT_EQ(DatasetReader(directory / "d").episodeEnds(), ends);
  EXPECT_EQ(DatasetReader(directory / "d").readAsDouble("data/pose", 0, ends.back()), poses);
}

TEST(ChunkSize, ChangesTheFilesButNotTheValues) {
  const TemporaryDirectory directory;
  Manifest manifest = exampleManifest();
  manifest.compression = 1;
  manifest.columns[0].shape = {40, 10};  // 800 bytes
  writeExample(directory / "large", manifest);
  manifest.chunk_bytes = 1024;
  writeExample(directory / "small", manifest);
  EXPECT_NE(filesIn(directory / "large")["shard-000000.h5"], filesIn(directory / "small")["shard-000000.h5"]);
  const DatasetReader large(directory / "large"), small(directory / "small");
  EXPECT_EQ(small.manifest().chunk_bytes, 1024u);
  EXPECT_EQ(large.read("data/tactile_image", 0, large.numFrames()), small.read("data/tactile_image", 0, small.numFrames()));
}

TEST(Reader, RejectsUnknownColumnsAndRows) {
  const TemporaryDirectory directory;
  writeExample(directory / "d", exampleManifest());
  const DatasetReader reader(directory / "d");
  expectError(ErrorKind::kInput, "no column \"data/nothing\"", [&] { reader.read("data/nothing", 0, 1); });
  expectError(ErrorKind::kInput, "rows", [&] { reader.read("data/total_force", 0, reader.numFrames() + 1); });
  expectError(ErrorKind::kInput, "rows", [&] { reader.read("data/total_force", reader.numFrames(), 1); });
  expectError(ErrorKind::kInput, "rows", [&] { reader.read("data/total_force", ~std::uint64_t{0}, 2); });
  EXPECT_TRUE(reader.read("data/total_force", reader.numFrames(), 0).empty());
}

TEST(RoundTripProperty, IsIndependentOfTheShardSize) {
  const bool holds = rc::check("rows are independent of the shard size", [] {
    const TemporaryDirectory directory;
    Manifest manifest = exampleManifest();
    manifest.num_episodes = *rc::gen::inRange<std::uint64_t>(1, 30);
    manifest.episodes_per_shard = *rc::gen::inRange<std::uint64_t>(1, 40);
    manifest.compression = *rc::gen::element(0, 1);
    writeExample(directory / "d", manifest);
    Manifest whole = manifest;
    whole.episodes_per_shard = whole.num_episodes;
    const ShardData expected = exampleShard(whole, 0);
    const DatasetReader reader(directory / "d");
    for (std::size_t c = 0; c < manifest.columns.size(); ++c)
      RC_ASSERT(reader.read(manifest.columns[c].name, 0, manifest.columns[c].per_episode ? reader.numEpisodes() : reader.numFrames()) ==
                expected.columns[c]);
  });
  EXPECT_TRUE(holds);
}

}  // namespace
}  // namespace taxelsim::testing
