// The scale of pictures: a percentile of what was measured, beyond noise.
#include "taxelsim/counts_range.h"

#include "dataset/example.h"
#include "support/test.h"

namespace taxelsim::testing {
namespace {

constexpr std::uint64_t kLength = 10'000;  // frames of each of two episodes, more than a sample has
constexpr const char* kImage = "data/tactile_image";
constexpr const char* kCounts = "data/pad/taxel_counts";

TEST(CountsRange, IsAPercentileOfTheCountsBeyondNoise) {
  EXPECT_EQ(countsRange({}, 0), 1);
  EXPECT_EQ(countsRange({}, 2.91), 30) << "ten standard deviations, rounded up";
  std::vector<double> counts(10'001);
  std::iota(counts.begin(), counts.end(), 0);
  EXPECT_EQ(countsRange(counts, 0), 9991) << "of 9,999 counts above 1, 9,990 are not larger";
  EXPECT_EQ(countsRange(counts, 900), 9999) << "the 999th of 1,000 counts above 9,000";
}

// Two episodes of a pad with one taxel, in a shard each. value(frame): (image, x, y, normal).
template <typename Value>
void writePad(const std::filesystem::path& directory, const std::string& scene, Value value) {
  Manifest manifest;
  manifest.scene = scene;
  manifest.sensor_name = "pad";
  manifest.num_episodes = 2;
  manifest.episodes_per_shard = 1;
  manifest.columns = {{kImage, ScalarType::kUint16, {1}, "counts", "Output.", false},
                      {kCounts, ScalarType::kInt32, {1, 3}, "counts", "Output.", false}};
  DatasetWriter writer(directory, manifest);
  for (std::uint64_t shard = 0; shard < 2; ++shard) {
    ShardData data{.episode_lengths = {kLength}, .columns = {std::vector<std::byte>(2 * kLength), std::vector<std::byte>(12 * kLength)}};
    for (std::uint64_t frame = 0; frame < kLength; ++frame) {
      const std::array<std::int32_t, 4> counts = value(shard * kLength + frame);
      const auto image = static_cast<std::uint16_t>(counts[0]);
      std::memcpy(data.columns[0].data() + 2 * frame, &image, 2);
      std::memcpy(data.columns[1].data() + 12 * frame, counts.data() + 1, 12);
    }
    writer.writeShard(shard, data);
  }
  writer.finish();
}

TEST(CountsRange, ReadsASampleOfADataSetAndTheNoiseOfItsScene) {
  const TemporaryDirectory root;
  const std::string scene =
      "sensors:\n  - readout: {noise: 2, bias: 1, three_axis: {noise: [1, 3, 1]}}\n  - readout: {noise: 3}\nrandomization: {noise: [0, "
      "4]}\n";
  writePad(root / "quiet", scene, [](std::uint64_t frame) { return std::array<std::int32_t, 4>{frame % 50 == 0 ? 50 : 7, 99, 99, -5}; });
  const DatasetReader quiet(root / "quiet");
  EXPECT_EQ(countsRange(quiet, kImage, 0, quiet.numFrames()), 50) << "ten times the root of 3^2 + 4^2";
  EXPECT_EQ(countsRange(quiet, kCounts, 0, quiet.numFrames()), 50) << "the axes have a noise of their own";

  // The second episode presses; the sample has blocks of both.
  writePad(root / "pressed", "", [](std::uint64_t frame) {
    const std::int32_t counts = frame < kLength ? 100 : 300;
    return std::array<std::int32_t, 4>{counts, 9000, -9000, 2 * counts};
  });
  const DatasetReader pressed(root / "pressed");
  EXPECT_EQ(countsRange(pressed, kImage, 0, 2 * kLength), 300);
  EXPECT_EQ(countsRange(pressed, kCounts, 0, 2 * kLength), 600) << "of the normal axis";
  EXPECT_EQ(countsRange(pressed, kImage, 0, kLength), 100) << "of the first episode";
  EXPECT_EQ(countsRange(pressed, kImage, kLength - 1, kLength + 1), 300);
}

}  // namespace
}  // namespace taxelsim::testing
