// Data sets on disk: HDF5 shards, a manifest, a virtual view over all shards (docs/file_formats.md). Not how the data is made.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <memory>
#include <span>
#include <string>
#include <variant>
#include <vector>

namespace taxelsim {

enum class ScalarType { kUint16, kInt32, kUint64, kFloat32, kFloat64 };

// One HDF5 data set in every shard: (num_frames x shape) or, under meta/, (num_episodes x shape).
struct Column {
  std::string name;  // full path: "data/tactile_image", "data/ground_truth/edge_angle", "meta/object"
  ScalarType type = ScalarType::kFloat32;
  std::vector<std::size_t> shape;  // of one row; empty for a scalar
  std::string unit;                // "N", "m", "rad", "counts", "1"; written as an attribute
  std::string description;         // one sentence; written as an attribute
  bool per_episode = false;        // one row per episode, not per frame
};

// Bytes of one value.
std::size_t scalarSize(ScalarType type);

// "uint16", "int32", ...: NumPy's names.
const char* nameOf(ScalarType type);

// What decides a data set's content, and how it is cut into shards.
struct Manifest {
  std::string scene;  // resolved scene, YAML text
  std::string sensor_name;
  int num_rows = 0, num_cols = 0;     // of the sensor when it is one grid patch, else 0
  std::array<double, 2> pitch{0, 0};  // m, along x and y, of that patch, else 0
  std::uint64_t seed = 0;
  std::uint64_t num_episodes = 0;
  std::uint64_t episodes_per_shard = 0;
  int compression = 0;
  std::string program_version;
  std::string device;           // name and driver of the device that made it
  std::vector<Column> columns;  // without meta/episode_ends, which every shard has

  std::uint64_t numShards() const { return (num_episodes + episodes_per_shard - 1) / episodes_per_shard; }
};

// Rows of one shard, column by column, in the manifest's order; bytes in native order, tightly packed.
struct ShardData {
  std::vector<std::uint64_t> episode_lengths;  // frames of each episode of the shard
  std::vector<std::vector<std::byte>> columns;
};

// Writes a data set into a directory, resuming what is there. One writer per directory: a lock file is held.
class DatasetWriter {
 public:
  // Creates the directory and the manifest, or checks the manifest that is there against `manifest`. Throws Error(kInput) when the
  // directory holds something else, or a data set of a different scene, seed, number of episodes per shard, program version or device;
  // Error(kIo) when the disk refuses, or another process is writing. Left-over temporary files are removed. A data set may be extended to
  // more episodes only where that leaves complete shards unchanged.
  DatasetWriter(std::filesystem::path directory, Manifest manifest);
  ~DatasetWriter();
  DatasetWriter(const DatasetWriter&) = delete;
  DatasetWriter& operator=(const DatasetWriter&) = delete;

  // True when the shard is on disk, whole.
  bool isComplete(std::uint64_t shard) const;

  // Writes shard under a temporary name, flushes it to disk and renames it. Waits. May be called from one thread at a time.
  void writeShard(std::uint64_t shard, const ShardData& data);

  // Writes the virtual view, atomically; throws Error(kIo) when a shard is missing.
  void finish();

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

// The manifest alone. Throws Error(kInput) when the directory holds no data set, one of a newer format, or a manifest that was changed.
Manifest readManifest(const std::filesystem::path& directory);

struct ShardStatus {
  enum class State { kWhole, kMissing, kBroken };
  std::uint64_t shard = 0;
  State state = State::kWhole;
  std::string problem;  // of a broken one, a complete line
};

// Looks at every shard, in order. With `contents` all values are read and held against their SHA-256; without, headers only. Throws what
// readManifest() throws.
std::vector<ShardStatus> checkShards(const std::filesystem::path& directory, bool contents);

// Reads one back; checks every shard against the manifest when opened.
class DatasetReader {
 public:
  // Throws Error(kInput) when the directory holds no data set, one of a newer format, or a shard that is missing or broken (the message
  // names it); with allow_incomplete missing shards are left out instead.
  explicit DatasetReader(std::filesystem::path directory, bool allow_incomplete = false);
  ~DatasetReader();
  DatasetReader(DatasetReader&&) noexcept;

  const Manifest& manifest() const;
  std::uint64_t numFrames() const;
  std::uint64_t numEpisodes() const;
  const std::vector<std::uint64_t>& episodeEnds() const;  // (num_episodes), over all shards present
  const std::vector<std::uint64_t>& missingShards() const;

  // Rows [first, first + count) of a column as bytes; throws Error(kInput) for an unknown column or rows out of range.
  std::vector<std::byte> read(const std::string& column, std::uint64_t first, std::uint64_t count) const;
  // The same, turned into doubles.
  std::vector<double> readAsDouble(const std::string& column, std::uint64_t first, std::uint64_t count) const;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace taxelsim
