#include "cli/pressed_pad.h"

#include "support/test.h"

namespace taxelsim::testing {
namespace {

constexpr int kRows = 6, kCols = 14;
constexpr double kPitch = 0.0034;  // m
constexpr std::uint64_t kFramesPerEpisode = 3;
constexpr double kFrameTime = 0.01;    // s
constexpr double kPeak = 3100;         // counts
constexpr double kWidth = 0.0028;      // m, of the bar
constexpr double kHalfLength = 0.009;  // m
constexpr double kNewtonPerCount = 0.001;

struct Contact {
  double angle, x, y, depth;
};

Contact contactOf(std::uint64_t frame) {
  const auto t = static_cast<double>(frame);
  return {1.5 - 0.21 * t, 0.002 * std::sin(0.9 * t), 0.008 * std::sin(0.5 * t), 0.45 + 0.55 * std::abs(std::cos(0.7 * t))};
}

std::uint16_t countsAt(const Contact& contact, int i, int j) {
  const double x = (i - 0.5 * (kRows - 1)) * kPitch - contact.x, y = (j - 0.5 * (kCols - 1)) * kPitch - contact.y;
  const double along = x * std::cos(contact.angle) + y * std::sin(contact.angle);
  const double across = -x * std::sin(contact.angle) + y * std::cos(contact.angle);
  const double past = std::max(std::abs(along) - kHalfLength, 0.0);
  const double value = kPeak * contact.depth * std::exp(-(across * across + past * past) / (kWidth * kWidth)) - 150;
  return static_cast<std::uint16_t>(std::max(value, 0.0));
}

template <typename T>
void append(std::vector<std::byte>& bytes, T value) {
  bytes.resize(bytes.size() + sizeof(T));
  std::memcpy(bytes.data() + bytes.size() - sizeof(T), &value, sizeof(T));
}

}  // namespace

void writePressedPad(const std::filesystem::path& directory, const PadOptions& options) {
  Manifest manifest;
  manifest.scene = "format_version: 1\nname: turning bar\n";
  manifest.sensor_name = "made-up pad, 6 x 14";
  manifest.seed = 7;
  manifest.num_episodes = options.num_episodes;
  manifest.episodes_per_shard = 2;
  manifest.program_version = "0.1.0";
  manifest.device = "no device";
  manifest.policy = "drop 1";
  if (options.one_grid) {
    manifest.num_rows = kRows;
    manifest.num_cols = kCols;
    manifest.pitch = {kPitch, kPitch};
  }
  const std::vector<std::size_t> shape =
      options.one_grid ? std::vector<std::size_t>{kRows, kCols} : std::vector<std::size_t>{kRows * kCols};
  manifest.columns = {{"data/tactile_image", ScalarType::kUint16, shape, "counts", "What the sensor reports.", false}};
  if (options.features) {
    manifest.columns.push_back({"data/total_force", ScalarType::kFloat32, {}, "N", "Sum over the taxels.", false});
    manifest.columns.push_back({"data/edge_angle", ScalarType::kFloat32, {}, "rad", "Of the principal axis.", false});
    manifest.columns.push_back({"data/edge_confidence", ScalarType::kFloat32, {}, "1", "0 to 1.", false});
    manifest.columns.push_back({"meta/load", ScalarType::kFloat64, {}, "N", "Commanded load; NaN for a depth.", true});
    manifest.columns.push_back({"meta/object_name", ScalarType::kText, {}, "1", "Name of the object.", true, 4});
    manifest.columns.push_back({"meta/success", ScalarType::kUint8, {}, "1", "Of the task.", true, 0, {"false", "true"}});
    manifest.columns.push_back({"data/time", ScalarType::kFloat64, {}, "s", "Since the first frame.", false});
  }
  DatasetWriter writer(directory, manifest);
  for (std::uint64_t shard = 0; shard < manifest.numShards(); ++shard) {
    ShardData data;
    data.columns.resize(manifest.columns.size());
    for (std::uint64_t episode = 2 * shard; episode < std::min(2 * shard + 2, manifest.num_episodes); ++episode) {
      data.episode_lengths.push_back(kFramesPerEpisode);
      for (std::uint64_t frame = kFramesPerEpisode * episode; frame < kFramesPerEpisode * (episode + 1); ++frame) {
        const Contact contact = contactOf(frame);
        double sum = 0;
        for (int i = 0; i < kRows; ++i)
          for (int j = 0; j < kCols; ++j) {
            append(data.columns[0], countsAt(contact, i, j));
            sum += countsAt(contact, i, j);
          }
        if (!options.features) continue;
        append(data.columns[1], static_cast<float>(sum * kNewtonPerCount));
        append(data.columns[2], static_cast<float>(contact.angle - (contact.angle > 1.5707963 ? 3.1415926 : 0)));
        append(data.columns[3], 0.87f);
        append(data.columns[7], kFrameTime * static_cast<double>(frame % kFramesPerEpisode));
      }
      if (!options.features) continue;
      append(data.columns[4], episode == 0 ? std::numeric_limits<double>::quiet_NaN() : 0.5 * static_cast<double>(episode));
      const bool is_bar = episode % 2 == 0;
      std::array<char, 4> name{};
      (is_bar ? options.bar_name : "drop").copy(name.data(), name.size());
      append(data.columns[5], name);
      append(data.columns[6], static_cast<std::uint8_t>(is_bar));
    }
    writer.writeShard(shard, data);
  }
  writer.finish();
}

}  // namespace taxelsim::testing
