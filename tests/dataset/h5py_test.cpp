// Somebody else's reader: plain h5py sees the same values through the view and through the shards.
#include <gmock/gmock.h>

#include <array>
#include <cstdio>
#include <nlohmann/json.hpp>

#include "base/sha256.h"
#include "dataset/example.h"

namespace taxelsim::testing {
namespace {

// What tests/dataset/read_back.py says of a directory; it reads with another working directory than the data set's.
nlohmann::json readBack(const std::filesystem::path& directory) {
  const std::string command =
      "cd / && " TAXELSIM_TEST_PYTHON " " TAXELSIM_SOURCE_DIR "/tests/dataset/read_back.py '" + directory.string() + "'";
  FILE* pipe = popen(command.c_str(), "r");
  EXPECT_NE(pipe, nullptr);
  std::string text;
  std::array<char, 4096> buffer;
  while (const std::size_t count = std::fread(buffer.data(), 1, buffer.size(), pipe)) text.append(buffer.data(), count);
  EXPECT_EQ(pclose(pipe), 0) << text;
  return nlohmann::json::parse(text, nullptr, /*allow_exceptions=*/false);
}

class H5py : public ::testing::TestWithParam<int> {};

TEST_P(H5py, ReadsViewAndShards) {
  const TemporaryDirectory directory;
  Manifest manifest = exampleManifest();
  manifest.compression = GetParam();
  writeExample(directory / "first", manifest);
  std::filesystem::rename(directory / "first", directory / "moved");
  const nlohmann::json found = readBack(directory / "moved");
  ASSERT_TRUE(found.is_object());

  EXPECT_EQ(found["attributes"]["format_version"], 1);
  EXPECT_EQ(found["attributes"]["num_episodes"], 11);
  EXPECT_EQ(found["attributes"]["scene_sha256"], sha256Hex(std::as_bytes(std::span(manifest.scene))));
  EXPECT_EQ(found["shards"][2]["shard"], 2);
  EXPECT_EQ(found["shards"][2]["first_episode"], 8);
  EXPECT_EQ(found["shards"][2]["num_episodes"], 3);
  EXPECT_EQ(found["shards"][2]["seed"], 18446744073709551615u);

  const DatasetReader reader(directory / "moved");
  EXPECT_EQ(found["columns"].size(), manifest.columns.size() + 1);
  EXPECT_EQ(found["columns"]["meta/episode_ends"]["values"].get<std::vector<std::uint64_t>>(), reader.episodeEnds());
  for (const Column& column : manifest.columns) {
    const nlohmann::json& seen = found["columns"][column.name];
    const std::uint64_t num_rows = column.per_episode ? reader.numEpisodes() : reader.numFrames();
    EXPECT_EQ(seen["unit"], column.unit);
    EXPECT_EQ(seen["description"], column.description);
    EXPECT_EQ(seen["view"], seen["concatenated"]) << column.name;
    EXPECT_EQ(seen["view"], sha256Hex(reader.read(column.name, 0, num_rows))) << column.name;
    EXPECT_TRUE(seen["hashes_hold"]) << column.name;
    std::vector<std::size_t> shape{static_cast<std::size_t>(num_rows)};
    shape.insert(shape.end(), column.shape.begin(), column.shape.end());
    EXPECT_EQ(seen["shape"].get<std::vector<std::size_t>>(), shape) << column.name;
    double sum = 0;
    for (const double value : reader.readAsDouble(column.name, 0, num_rows)) sum += value;
    EXPECT_EQ(seen["sum"], sum) << column.name << ": sums of whole numbers below 2^53 are exact";
  }
  EXPECT_EQ(found["columns"]["data/tactile_image"]["type"], "uint16");
  EXPECT_EQ(found["columns"]["data/pose"]["type"], "float64");
  EXPECT_EQ(found["columns"]["data/tactile_image"]["compressed"], GetParam() > 0);
}

INSTANTIATE_TEST_SUITE_P(Compression, H5py, ::testing::Values(0, 6));

}  // namespace
}  // namespace taxelsim::testing
