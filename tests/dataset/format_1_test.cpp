// Data sets of format 1 stay readable. data/format_1 was written by version 0.1.0 from data/format_1_scene.yaml.
#include "dataset/example.h"

namespace taxelsim::testing {
namespace {

// 3 episodes of 2 frames in shards of 2 episodes.
const std::filesystem::path kFormat1 = TAXELSIM_SOURCE_DIR "/tests/dataset/data/format_1";

TEST(Format1, IsRead) {
  for (const ShardStatus& status : checkShards(kFormat1, /*contents=*/true)) EXPECT_EQ(status.problem, "");
  EXPECT_EQ(checkView(kFormat1).state, ViewStatus::State::kUnverified);
  const DatasetReader reader(kFormat1);
  EXPECT_EQ(reader.manifest().format_version, 1u);
  EXPECT_EQ(reader.manifest().policy, "");
  EXPECT_EQ(reader.episodeEnds(), (std::vector<std::uint64_t>{2, 4, 6}));
  EXPECT_EQ(reader.readAsDouble("meta/episode", 0, 3), (std::vector<double>{0, 1, 2}));
  EXPECT_EQ(reader.readAsDouble("meta/load_driven", 0, 3), (std::vector<double>{1, 1, 1})) << "int32 in format 1";
  EXPECT_EQ(reader.readAsDouble("meta/load", 1, 1)[0], 1.5615869760513306);
  const std::vector<double> image = reader.readAsDouble("data/tactile_image", 4, 1);
  EXPECT_EQ(image, (std::vector<double>{3, 347, 124, 0, 51, 717, 308, 0, 0, 50, 0, 0}));
}

TEST(Format1, IsVerified) {
  const TemporaryDirectory directory;
  std::filesystem::copy(kFormat1, directory / "d");
  std::string bytes = filesIn(directory / "d")["shard-000001.h5"];
  const std::vector<std::byte> image = DatasetReader(directory / "d").read("data/tactile_image", 4, 2);
  bytes[bytes.find(std::string(reinterpret_cast<const char*>(image.data()), image.size())) + 7] ^= 1;
  overwrite(directory / "d/shard-000001.h5", bytes);
  EXPECT_NE(checkShards(directory / "d", true)[1].problem.find("SHA-256 mismatch of data/tactile_image"), std::string::npos);
  const DatasetReader reader(directory / "d");
  EXPECT_EQ(reader.readAsDouble("meta/load", 0, 2).size(), 2u) << "of shard 0";
  expectError(ErrorKind::kInput, "SHA-256 mismatch of data/tactile_image", [&] { reader.readAsDouble("meta/load", 2, 1); });
}

TEST(Format1, IsNotResumed) {
  const TemporaryDirectory directory;
  std::filesystem::copy(kFormat1, directory / "d");
  const auto before = filesIn(directory / "d");
  Manifest manifest = readManifest(directory / "d");
  expectError(ErrorKind::kInput, "format 1 cannot be written", [&] { DatasetWriter(directory / "d", manifest); });
  manifest.format_version = 2;
  expectError(ErrorKind::kInput, "another format (1 there, 2 requested)", [&] { DatasetWriter(directory / "d", manifest); });
  EXPECT_EQ(filesIn(directory / "d"), before);
}

}  // namespace
}  // namespace taxelsim::testing
