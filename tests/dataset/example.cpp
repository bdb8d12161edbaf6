#include "dataset/example.h"

#include <unistd.h>

#include "base/sha256.h"
#include "dataset/checksum.h"
#include "dataset/column.h"
#include "dataset/manifest.h"
#include "support/test.h"

namespace taxelsim::testing {
namespace {

// A value for element `i` of column `c`; small integer types hold its lowest bits.
std::uint64_t valueOf(std::uint64_t c, std::uint64_t i) {
  return (i * 7 + c * 1000 + 3) % 60000;
}

template <typename T>
std::vector<std::byte> rowsOf(std::uint64_t column, std::uint64_t first, std::uint64_t count) {
  std::vector<std::byte> bytes(count * sizeof(T));
  for (std::uint64_t i = 0; i < count; ++i) {
    const T value = static_cast<T>(valueOf(column, first + i));
    std::memcpy(bytes.data() + i * sizeof(T), &value, sizeof(T));
  }
  return bytes;
}

std::vector<std::byte> textsOf(const Column& column, std::uint64_t c, std::uint64_t first, std::uint64_t count) {
  std::vector<std::byte> bytes(count * column.text_length);
  for (std::uint64_t i = 0; i < count; ++i) {
    const std::string text = std::to_string(valueOf(c, first + i)).substr(0, column.text_length);
    std::memcpy(bytes.data() + i * column.text_length, text.data(), text.size());
  }
  return bytes;
}

// Calls function(T{}) with the type of the column's numbers.
template <typename Function>
auto withType(ScalarType type, Function function) {
  switch (type) {
    case ScalarType::kUint8:
      return function(std::uint8_t{});
    case ScalarType::kUint16:
      return function(std::uint16_t{});
    case ScalarType::kInt16:
      return function(std::int16_t{});
    case ScalarType::kInt32:
      return function(std::int32_t{});
    case ScalarType::kUint64:
      return function(std::uint64_t{});
    case ScalarType::kFloat32:
      return function(float{});
    default:
      return function(double{});
  }
}

}  // namespace

double exampleNumber(const Column& column, std::size_t c, std::uint64_t i) {
  return withType(column.type, [&]<typename T>(T) { return static_cast<double>(static_cast<T>(valueOf(c, i))); });
}

Manifest exampleManifest() {
  Manifest manifest;
  manifest.scene = "format_version: 1\nname: \"press\"  # comment\n\nlist:\n  - 1\n  - \"quoted: yes\"\n";
  manifest.sensor_name = "pad \"A\"";
  manifest.num_rows = 2;
  manifest.num_cols = 3;
  manifest.pitch = {0.0034, 0.1 + 0.2};  // the second has 17 digits
  manifest.seed = 18446744073709551615u;
  manifest.num_episodes = 11;
  manifest.episodes_per_shard = 4;
  manifest.program_version = "1.2.3";
  manifest.device = "llvmpipe, driver 22";
  manifest.policy = "servo v1";
  manifest.columns = {{"data/tactile_image", ScalarType::kUint16, {2, 3}, "counts", "What the sensor reports.", false},
                      {"data/total_force", ScalarType::kFloat32, {}, "N", "Sum over the taxels.", false},
                      {"data/ground_truth/contact_wrench", ScalarType::kFloat32, {6}, "N, N m", "On the sensor.", false},
                      {"data/pose", ScalarType::kFloat64, {7}, "m, 1", "X_SO.", false},
                      {"meta/object", ScalarType::kInt32, {}, "1", "Index of the object.", true},
                      {"meta/episode", ScalarType::kUint64, {}, "1", "Number of the episode.", true},
                      {"data/contact_type", ScalarType::kUint8, {2}, "1", "Of each row.", false, 0, {"none", "point", "edge"}},
                      {"data/status", ScalarType::kUint8, {}, "1", "Of the robot.", false, 0, {}, {"limit", "lost"}},
                      {"data/patch", ScalarType::kInt16, {}, "1", "Number of the patch, or -1.", false},
                      {"meta/object_name", ScalarType::kText, {}, "1", "Name of the object.", true, 5}};
  return manifest;
}

std::uint64_t exampleLength(std::uint64_t episode) {
  return 1 + episode * 3 % 5;
}

ShardData exampleShard(const Manifest& manifest, std::uint64_t shard) {
  ShardData data;
  const std::uint64_t first_episode = dataset::firstEpisode(manifest, shard);
  std::uint64_t first_frame = 0, num_frames = 0;
  for (std::uint64_t episode = 0; episode < first_episode; ++episode) first_frame += exampleLength(episode);
  for (std::uint64_t i = 0; i < dataset::numEpisodes(manifest, shard); ++i) {
    data.episode_lengths.push_back(exampleLength(first_episode + i));
    num_frames += data.episode_lengths.back();
  }
  for (std::size_t c = 0; c < manifest.columns.size(); ++c) {
    const Column& column = manifest.columns[c];
    const std::uint64_t per_row = dataset::rowBytes(column) / scalarSize(column);
    const std::uint64_t first = per_row * (column.per_episode ? first_episode : first_frame);
    const std::uint64_t count = per_row * (column.per_episode ? data.episode_lengths.size() : num_frames);
    data.columns.push_back(column.type == ScalarType::kText ? textsOf(column, c, first, count) : withType(column.type, [&]<typename T>(T) {
      return rowsOf<T>(c, first, count);
    }));
  }
  return data;
}

void writeExample(const std::filesystem::path& directory, const Manifest& manifest) {
  DatasetWriter writer(directory, manifest);
  for (std::uint64_t shard = 0; shard < manifest.numShards(); ++shard) writer.writeShard(shard, exampleShard(manifest, shard));
  writer.finish();
}

std::map<std::string, std::string> filesIn(const std::filesystem::path& directory) {
  std::map<std::string, std::string> files;
  for (const auto& entry : std::filesystem::directory_iterator(directory)) {
    std::ifstream stream(entry.path(), std::ios::binary);
    files[entry.path().filename().string()] = std::string(std::istreambuf_iterator<char>(stream), {});
  }
  return files;
}

void renewChecksum(const std::filesystem::path& file) {
  overwrite(dataset::checksumFile(file), sha256File(file) + "  " + file.filename().string() + "\n");
}

void overwrite(const std::filesystem::path& file, const std::string& bytes) {
  std::ofstream(file, std::ios::binary) << bytes;
}

}  // namespace taxelsim::testing
