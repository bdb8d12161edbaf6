/// @file
/// Data sets on disk: HDF5 shards, a manifest, a virtual view over all shards (docs/file_formats.md). generate.h creates their content.
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

/// Type of a column's values.
enum class ScalarType {
  kUint16,   ///< 16-bit unsigned integer.
  kInt32,    ///< 32-bit signed integer.
  kUint64,   ///< 64-bit unsigned integer.
  kFloat32,  ///< IEEE 754 single precision.
  kFloat64,  ///< IEEE 754 double precision.
};

/// One HDF5 dataset of every shard: (num_frames x shape) or, if per_episode, (num_episodes x shape).
struct Column {
  std::string name;                        ///< Full path: "data/tactile_image", "data/ground_truth/edge_angle", "meta/object".
  ScalarType type = ScalarType::kFloat32;  ///< Type of the values.
  std::vector<std::size_t> shape;          ///< Shape of one row; empty for a scalar.
  std::string unit;                        ///< "N", "m", "rad", "counts", "1"; stored as an attribute.
  std::string description;                 ///< One sentence; stored as an attribute.
  bool per_episode = false;                ///< One row per episode instead of one per frame.
};

/// Bytes of one value.
std::size_t scalarSize(ScalarType type);

/// NumPy's name of the type: "uint16", "int32", ...
const char* nameOf(ScalarType type);

/// Everything that determines the content of a data set and its division into shards.
struct Manifest {
  std::string scene;                     ///< Resolved scene, YAML text.
  std::string sensor_name;               ///< Sensor::name.
  int num_rows = 0;                      ///< Rows of a sensor that is one grid patch, else 0.
  int num_cols = 0;                      ///< Columns of that patch, else 0.
  std::array<double, 2> pitch{0, 0};     ///< m, pitch of that patch along x and y, else 0.
  std::uint64_t seed = 0;                ///< Seed of all random numbers.
  std::uint64_t num_episodes = 0;        ///< Episodes of the data set.
  std::uint64_t episodes_per_shard = 0;  ///< Episodes of each shard but the last.
  int compression = 0;                   ///< gzip level, 0 (none) to 9.
  std::string program_version;           ///< Version of taxelsim that created the data set.
  std::string device;                    ///< Name and driver of the device that created it.
  std::string policy{};                  ///< Policy::id of the policy that acted; empty: the scene's controllers.
  std::vector<Column> columns;           ///< Columns, without meta/episode_ends, which every shard has.

  /// Number of shards.
  std::uint64_t numShards() const { return (num_episodes + episodes_per_shard - 1) / episodes_per_shard; }
};

/// Content of one shard.
struct ShardData {
  std::vector<std::uint64_t> episode_lengths;   ///< (num_episodes of the shard), frames of each episode.
  std::vector<std::vector<std::byte>> columns;  ///< Rows of each of Manifest::columns, in native byte order, tightly packed.
};

/// Writes a data set into a directory; resumes an unfinished one. A lock file excludes other writers from the directory.
///
/// Threads: for one thread at a time.
class DatasetWriter {
 public:
  /// Creates the directory and the manifest, or compares an existing manifest with `manifest`. Removes left-over temporary files.
  ///
  /// A data set can be extended to more episodes if that leaves its complete shards unchanged. Throws Error(kInput) if the directory holds
  /// other files, or a data set with another scene, seed, number of episodes per shard, program version or device. Throws Error(kIo) if the
  /// file system refuses or another process is writing.
  DatasetWriter(std::filesystem::path directory, Manifest manifest);
  /// Releases the directory; unfinished shards are lost.
  ~DatasetWriter();
  DatasetWriter(const DatasetWriter&) = delete;
  DatasetWriter& operator=(const DatasetWriter&) = delete;

  /// Whether the shard is complete on disk.
  bool isComplete(std::uint64_t shard) const;

  /// Writes a shard under a temporary name, flushes it to disk and renames it. Waits.
  ///
  /// Throws Error(kInput) if the shard is already complete, Error(kIo) if the file system refuses.
  void writeShard(std::uint64_t shard, const ShardData& data);

  /// Writes the virtual view atomically. Throws Error(kIo) if a shard is missing.
  void finish();

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

/// Reads the manifest alone. Throws Error(kInput) if the directory holds no data set, a newer format, or a manifest that was altered.
Manifest readManifest(const std::filesystem::path& directory);

/// Result of checking one shard.
struct ShardStatus {
  /// State of a shard.
  enum class State {
    kWhole,    ///< Complete and intact.
    kMissing,  ///< Not on disk.
    kBroken,   ///< Unreadable, or in conflict with the manifest or its checksums.
  };
  std::uint64_t shard = 0;      ///< Number of the shard.
  State state = State::kWhole;  ///< State of the shard.
  std::string problem;          ///< One line about a broken shard.
};

/// Checks every shard, in order.
///
/// `contents`: whether to read all values and verify their SHA-256; otherwise headers only. Throws what readManifest() throws.
std::vector<ShardStatus> checkShards(const std::filesystem::path& directory, bool contents);

/// Reads a data set. Checks every shard against the manifest when opened.
///
/// Threads: for one thread at a time.
class DatasetReader {
 public:
  /// Opens a data set.
  ///
  /// Throws Error(kInput) if the directory holds no data set or a newer format, or if a shard is missing or broken (the message names it).
  /// With `allow_incomplete` missing shards are skipped.
  explicit DatasetReader(std::filesystem::path directory, bool allow_incomplete = false);
  ~DatasetReader();
  DatasetReader(DatasetReader&&) noexcept;  ///< Leaves the other object unusable.

  const Manifest& manifest() const;                         ///< Manifest; valid as long as the reader.
  std::uint64_t numFrames() const;                          ///< Frames of all shards that are present.
  std::uint64_t numEpisodes() const;                        ///< Episodes of all shards that are present.
  const std::vector<std::uint64_t>& episodeEnds() const;    ///< (numEpisodes()), index of the frame after each episode.
  const std::vector<std::uint64_t>& missingShards() const;  ///< Numbers of the shards that are missing.

  /// Rows [first, first + count) of a column as bytes. Throws Error(kInput) for an unknown column or rows out of range.
  std::vector<std::byte> read(const std::string& column, std::uint64_t first, std::uint64_t count) const;
  /// The same rows converted to double. Throws what read() throws.
  std::vector<double> readAsDouble(const std::string& column, std::uint64_t first, std::uint64_t count) const;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace taxelsim
