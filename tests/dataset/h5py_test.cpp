// Interoperability: h5py reads the same values through the view and from the shards.
#include <nlohmann/json.hpp>

#include "base/sha256.h"
#include "dataset/example.h"
#include "support/test.h"

namespace taxelsim::testing {
namespace {

// Runs a Python script of this directory on `path` and parses its output. The working directory is not that of the data set.
nlohmann::json runScript(const char* script, const std::filesystem::path& path) {
  const std::string command =
      std::string("cd / && " TAXELSIM_TEST_PYTHON " " TAXELSIM_SOURCE_DIR "/tests/dataset/") + script + " '" + path.string() + "'";
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
  const nlohmann::json found = runScript("read_with_h5py.py", directory / "moved");
  ASSERT_TRUE(found.is_object());

  EXPECT_EQ(found["attributes"]["format_version"], 2);
  EXPECT_EQ(found["attributes"]["policy"], manifest.policy);
  EXPECT_EQ(found["shards"][1]["policy"], manifest.policy);
  EXPECT_EQ(found["variable_length"], nlohmann::json::array()) << "no texts of variable length";
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
    const nlohmann::json& read = found["columns"][column.name];
    const std::uint64_t num_rows = column.per_episode ? reader.numEpisodes() : reader.numFrames();
    EXPECT_EQ(read["unit"], column.unit);
    EXPECT_EQ(read["description"], column.description);
    EXPECT_EQ(read["view"], read["concatenated"]) << column.name;
    EXPECT_EQ(read["view"], sha256Hex(reader.read(column.name, 0, num_rows))) << column.name;
    EXPECT_TRUE(read["hashes_match"]) << column.name;
    std::vector<std::size_t> shape{static_cast<std::size_t>(num_rows)};
    shape.insert(shape.end(), column.shape.begin(), column.shape.end());
    EXPECT_EQ(read["shape"].get<std::vector<std::size_t>>(), shape) << column.name;
    EXPECT_EQ(read["value_names"].get<std::vector<std::string>>(), column.value_names) << column.name;
    EXPECT_EQ(read["bit_names"].get<std::vector<std::string>>(), column.bit_names) << column.name;
    if (column.type == ScalarType::kText) {
      EXPECT_EQ(read["texts"].get<std::vector<std::string>>(), reader.readAsText(column.name, 0, num_rows));
      continue;
    }
    double sum = 0;
    for (const double value : reader.readAsDouble(column.name, 0, num_rows)) sum += value;
    EXPECT_EQ(read["sum"], sum) << column.name << ": sums of integers below 2^53 are exact";
  }
  EXPECT_EQ(found["columns"]["data/tactile_image"]["type"], "uint16");
  EXPECT_EQ(found["columns"]["data/pose"]["type"], "float64");
  EXPECT_EQ(found["columns"]["data/contact_type"]["type"], "uint8");
  EXPECT_EQ(found["columns"]["data/patch"]["type"], "int16");
  EXPECT_EQ(found["columns"]["meta/object_name"]["type"], "|S5");
  EXPECT_EQ(found["columns"]["data/tactile_image"]["compressed"], GetParam() > 0);
}

// Columns of several chunks, the last one partly filled, one column of noise that deflate cannot shrink. Then the same file written with
// HDF5's own filters, as earlier versions did. Both readers must read both files.
TEST(H5pyChunks, AreEquivalentToHdf5Filters) {
  const TemporaryDirectory directory;
  Manifest manifest = exampleManifest();
  manifest.compression = 4;
  manifest.num_episodes = manifest.episodes_per_shard = 1;
  manifest.columns = {{"data/smooth", ScalarType::kFloat64, {50}, "N", "Shrinks.", false},
                      {"data/noise", ScalarType::kUint16, {40}, "counts", "Does not.", false},
                      {"data/flag", ScalarType::kUint8, {}, "1", "One byte.", false},
                      {"meta/name", ScalarType::kText, {}, "1", "Three bytes.", true, 3}};
  constexpr std::uint64_t kNumFrames = 10000;
  std::vector<double> smooth(50 * kNumFrames);
  for (std::size_t i = 0; i < smooth.size(); ++i) smooth[i] = static_cast<double>(i / 50);
  std::vector<std::uint16_t> noise(40 * kNumFrames);
  std::mt19937 random(3);
  for (std::uint16_t& value : noise) value = static_cast<std::uint16_t>(random());
  const auto bytes_of = [](const auto& values) {
    const std::span bytes = std::as_bytes(std::span(values));
    return std::vector<std::byte>(bytes.begin(), bytes.end());
  };
  const ShardData data{
      .episode_lengths = {kNumFrames},
      .columns = {bytes_of(smooth), bytes_of(noise), std::vector<std::byte>(kNumFrames, std::byte{1}), bytes_of(std::string("bar"))}};
  {
    DatasetWriter writer(directory / "d", manifest);
    writer.writeShard(0, data);
    writer.finish();
  }
  const auto check = [&](const char* filters) {
    SCOPED_TRACE(filters);
    EXPECT_EQ(checkShards(directory / "d", true)[0].problem, "");
    const DatasetReader reader(directory / "d");
    for (std::size_t c = 0; c < manifest.columns.size(); ++c) {
      EXPECT_EQ(reader.read(manifest.columns[c].name, 0, manifest.columns[c].per_episode ? 1 : kNumFrames), data.columns[c]);
    }
    const nlohmann::json columns = runScript("read_with_h5py.py", directory / "d")["columns"];
    for (const Column& column : manifest.columns) {
      EXPECT_TRUE(columns[column.name]["hashes_match"]) << column.name;
      EXPECT_TRUE(columns[column.name]["compressed"]) << column.name;
    }
  };
  check("taxelsim's compressor");
  EXPECT_EQ(runScript("apply_hdf5_filters.py", directory / "d/shard-000000.h5"), 4)
      << "chunks of noise and of a name, which are not deflated";
  renewChecksum(directory / "d/shard-000000.h5");
  check("HDF5's filters");
  EXPECT_NO_THROW(DatasetWriter(directory / "d", manifest)) << "resumed";
}

TEST(ChecksumFiles, AreReadBySha256sum) {
  const TemporaryDirectory directory;
  writeExample(directory / "d", exampleManifest());
  const std::string command = "cd '" + (directory / "d").string() + "' && sha256sum --status --strict -c *.sha256";
  EXPECT_EQ(std::system(command.c_str()), 0);
  std::string bytes = filesIn(directory / "d")["dataset.h5"];
  bytes.back() ^= 1;
  overwrite(directory / "d/dataset.h5", bytes);
  EXPECT_NE(std::system(command.c_str()), 0);
}

INSTANTIATE_TEST_SUITE_P(Compression, H5py, ::testing::Values(0, 6));

}  // namespace
}  // namespace taxelsim::testing
