/// @file
/// Data sets on disk: HDF5 shards, a manifest, a virtual view over all shards (docs/reference/scene_file.md). generate.h creates their
/// content.
#pragma once

#include <array>
#include <atomic>
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <variant>
#include <vector>

namespace taxelsim {

/// Format of the data sets that DatasetWriter writes. Readers also read format 1 (docs/how_to/migration.md).
inline constexpr std::uint64_t kDatasetFormat = 2;

inline constexpr std::uint64_t kDefaultChunkBytes = std::uint64_t{256} << 10;  ///< Default of Manifest::chunk_bytes.
inline constexpr std::uint64_t kMinChunkBytes = std::uint64_t{1} << 10;        ///< Smallest Manifest::chunk_bytes.
inline constexpr std::uint64_t kMaxChunkBytes = std::uint64_t{64} << 20;       ///< Largest Manifest::chunk_bytes.
inline constexpr std::size_t kMaxTextLength = 1024;                            ///< Largest Column::text_length.

/// Type of a column's values.
enum class ScalarType {
  kUint8,    ///< 8-bit unsigned integer.
  kUint16,   ///< 16-bit unsigned integer.
  kInt16,    ///< 16-bit signed integer.
  kInt32,    ///< 32-bit signed integer.
  kUint64,   ///< 64-bit unsigned integer.
  kFloat32,  ///< IEEE 754 single precision.
  kFloat64,  ///< IEEE 754 double precision.
  kText,     ///< UTF-8 text of Column::text_length bytes, padded with zeros.
};

/// One HDF5 dataset of every shard: (num_frames x shape) or, if per_episode, (num_episodes x shape).
struct Column {
  std::string name;                        ///< Full path: "data/tactile_image", "data/ground_truth/edge_angle", "meta/object".
  ScalarType type = ScalarType::kFloat32;  ///< Type of the values.
  std::vector<std::size_t> shape;          ///< Shape of one row; empty for a scalar.
  std::string unit;                        ///< "N", "m", "rad", "counts", "1"; stored as an attribute.
  std::string description;                 ///< One sentence; stored as an attribute.
  bool per_episode = false;                ///< One row per episode instead of one per frame.
  std::size_t text_length = 0;             ///< Bytes of one value of type kText, 1 to kMaxTextLength; 0 for other types.
  /// Names of the values 0, 1, ... of an integer column that is an enumeration or a flag; stored as an attribute. Empty for others.
  std::vector<std::string> value_names = {};
  /// Names of the bits 0, 1, ... of an unsigned column that is a set of flags; stored as an attribute. Empty for others.
  std::vector<std::string> bit_names = {};
};

/// Bytes of one value of the column.
std::size_t scalarSize(const Column& column);

/// NumPy's name of the type: "uint16", "int32", ...; "text" for kText.
const char* nameOf(ScalarType type);

/// Everything that determines the content of a data set and its division into shards.
struct Manifest {
  std::uint64_t format_version = kDatasetFormat;  ///< 1 or 2. DatasetWriter writes kDatasetFormat only.
  std::string scene;                              ///< Resolved scene, YAML text.
  std::string sensor_name;                        ///< Sensor::name.
  int num_rows = 0;                               ///< Rows of a sensor that is one grid patch, else 0.
  int num_cols = 0;                               ///< Columns of that patch, else 0.
  std::array<double, 2> pitch{0, 0};              ///< m, pitch of that patch along x and y, else 0.
  std::uint64_t seed = 0;                         ///< Seed of all random numbers.
  std::uint64_t num_episodes = 0;                 ///< Episodes of the data set.
  /// (num_episodes), numbers of the episodes in the order of the rows. Empty (default): 0 to num_episodes - 1.
  std::vector<std::uint64_t> episodes{};
  std::uint64_t episodes_per_shard = 0;  ///< Episodes of each shard but the last.
  int compression = 0;                   ///< gzip level, 0 (none) to 9.
  /// Largest size of a chunk of a compressed column before compression, kMinChunkBytes to kMaxChunkBytes. A chunk has at least one row.
  std::uint64_t chunk_bytes = kDefaultChunkBytes;
  std::string program_version;  ///< Version of taxelsim that created the data set.
  std::string device;           ///< Name and driver of the device that created it.
  std::string policy{};         ///< Policy::id of the policy that acted; empty: the scene's controllers.
  /// SHA-256 of the probe, a few frames that every program computes before it may write: devices of equal names can compute different
  /// values (docs/understand/determinism.md). Empty: unknown, as in data sets of earlier versions.
  std::string probe_sha256{};
  std::vector<Column> columns;  ///< Columns, without meta/episode_ends, which every shard has.

  /// Number of shards.
  std::uint64_t numShards() const { return (num_episodes + episodes_per_shard - 1) / episodes_per_shard; }
};

/// Content of one shard.
struct ShardData {
  std::vector<std::uint64_t> episode_lengths;   ///< (num_episodes of the shard), frames of each episode.
  std::vector<std::vector<std::byte>> columns;  ///< Rows of each of Manifest::columns, in native byte order, tightly packed.
};

/// Shards with the numbers first, ..., end - 1.
struct ShardRange {
  std::uint64_t first = 0;  ///< Number of the first shard.
  std::uint64_t end = 0;    ///< Number after the last shard, > first, or first if there are none.

  bool contains(std::uint64_t shard) const { return shard >= first && shard < end; }  ///< Whether the shard is one of them.
};

/// Part `part` (1 to `num_parts`) of a data set of `num_shards` shards; the parts differ by at most one shard. Empty for some parts if
/// there are more parts than shards.
ShardRange partOfShards(std::uint64_t num_shards, std::uint64_t part, std::uint64_t num_parts);

/// Options of DatasetWriter.
struct DatasetWriterOptions {
  /// Whether to remove shards that are damaged or belong to another data set, and dataset.h5 with them, so that they are written again,
  /// with a warning in the log for each. Default false: such a shard is an error.
  bool repair = false;
  /// Writes these shards only, and shares the directory with other writers that do so, on this machine or on others; see claim(). Default:
  /// none, the writer has the directory to itself and writes all shards.
  std::optional<ShardRange> shards{};
  /// Whether to read all bytes of the shards on disk. Default false: trusts dataset.checksums for shards whose size and times say that they
  /// have not changed since.
  bool verify_all = false;
  /// Called with the number of shards that are verified and the number of shards on disk, before each shard and at the end. Default: none.
  std::function<void(std::uint64_t num_verified, std::uint64_t num_shards)> on_verify{};
  /// Stops the verification when *stop becomes true. Not owned; must outlive the constructor. Default: none.
  const std::atomic<bool>* stop = nullptr;
};

/// Writes a data set into a directory; resumes an unfinished one. A lock file excludes other writers from the directory, or those that do
/// not share it (DatasetWriterOptions::shards).
///
/// Threads: for one thread at a time, but claim() may be called during writeShard().
class DatasetWriter {
 public:
  /// Creates the directory and the manifest, or compares an existing manifest with `manifest`. Verifies the shards on disk, those of the
  /// range if the directory is shared. Removes left-over temporary files unless it is shared.
  ///
  /// A data set can be extended to more episodes if that leaves its complete shards unchanged. Throws Error(kInput) if the directory holds
  /// other files, or a data set with another format, scene, seed, list of episodes, number of episodes per shard, program version, device,
  /// policy or probe, or a shard that differs from its checksum. A shared data set can not be extended. Throws Error(kIo) if the file
  /// system refuses or another process is writing.
  DatasetWriter(std::filesystem::path directory, Manifest manifest, const DatasetWriterOptions& options = {});
  /// Releases the directory; unfinished shards are lost.
  ~DatasetWriter();
  DatasetWriter(const DatasetWriter&) = delete;
  DatasetWriter& operator=(const DatasetWriter&) = delete;

  /// False if DatasetWriterOptions::stop ended the verification of the shards on disk; nothing can be written then.
  bool isVerified() const;

  /// Whether the shard was complete on disk when it was verified, or was written since by this writer.
  bool isComplete(std::uint64_t shard) const;

  /// Whether the shard is on disk now, written by any process.
  bool isOnDisk(std::uint64_t shard) const;

  /// Claims a shard of a shared directory. False if another writer has claimed it, or the shard is on disk. writeShard() releases the
  /// claim; the end of the process does so for any reason. True for a writer that has the directory to itself, unless the shard is on disk.
  bool claim(std::uint64_t shard);

  /// Writes a shard and its checksum under temporary names, flushes them to disk and renames them, the shard last. Waits. Threads may write
  /// different shards at the same time; no other method may be called meanwhile, except claim() and isOnDisk().
  ///
  /// Throws Error(kInput) if the shard is already complete, Error(kIo) if the file system refuses.
  void writeShard(std::uint64_t shard, const ShardData& data);

  /// Writes the virtual view, its checksum and dataset.checksums atomically. Only for a writer that has the directory to itself. Throws
  /// Error(kIo) if a shard is missing.
  void finish();

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

/// Options of finishDataset().
struct FinishOptions {
  /// As DatasetWriterOptions::on_verify. Default: none.
  std::function<void(std::uint64_t num_verified, std::uint64_t num_shards)> on_verify{};
  /// As DatasetWriterOptions::stop. Default: none.
  const std::atomic<bool>* stop = nullptr;
};

/// Completes a data set whose shards were written by range: verifies all bytes of all shards, in parallel, and writes dataset.h5 and
/// dataset.checksums. The directory then has the bytes of a data set that one process wrote. May be repeated. Returns false after a stop.
///
/// Throws Error(kInput) that names missing shards, a broken one, or the program version that wrote the data set if it is another one, and
/// Error(kIo) if the file system refuses or another process is writing.
bool finishDataset(const std::filesystem::path& directory, const FinishOptions& options = {});

/// Writes dataset.h5 and its checksum next to a manifest whose shards are stored elsewhere, e.g. in an object store: the bytes that
/// finishDataset() writes next to the shards. Every episode has `num_frames` frames, >= 1. Throws what readManifest() throws, Error(kInput)
/// for num_frames of 0, and Error(kIo) if the file system refuses.
void writeDatasetView(const std::filesystem::path& directory, std::uint64_t num_frames);

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
  /// Whether a whole shard was not read: dataset.checksums lists it, and its size and times say that it has not changed since.
  bool is_vouched_for = false;
  std::string problem;  ///< One line about a broken shard.
};

/// Checks every shard, in parallel threads. A shard is opened only if its bytes match its checksum file.
///
/// `contents`: whether to read all bytes. If false, trusts dataset.checksums for shards whose size and times say that they have not changed
/// since, and the headers of shards of format 1, which have no checksum files. `isolated`: as of DatasetReader. Throws what readManifest()
/// throws.
std::vector<ShardStatus> checkShards(const std::filesystem::path& directory, bool contents, bool isolated = false);

/// Result of checking dataset.h5, the virtual view over all shards.
struct ViewStatus {
  /// State of the view.
  enum class State {
    kWhole,       ///< Matches its checksum file and the manifest.
    kMissing,     ///< Not on disk; the view is written after the last shard.
    kBroken,      ///< In conflict with its checksum file or the manifest.
    kUnverified,  ///< Of format 1, which has no checksum of it.
  };
  State state = State::kWhole;  ///< State of the view.
  std::string problem;          ///< One line about a broken view.
};

/// Checks the view. `isolated`: as of DatasetReader. Throws what readManifest() throws.
ViewStatus checkView(const std::filesystem::path& directory, bool isolated = false);

/// Reads a data set. Verifies checksums before values are read: of dataset.h5 when the data set is opened, of a shard before its first row
/// is read, or when the data set is opened if dataset.h5 is missing or broken. A process verifies a file once, and again if it changes. In
/// format 1 the SHA-256 of a shard's columns take their place, and headers are checked when the data set is opened.
///
/// Threads: for one thread at a time.
class DatasetReader {
 public:
  /// Opens a data set.
  ///
  /// Throws Error(kInput) if the directory holds no data set or a newer format, or if a shard is missing or, as far as it is checked here,
  /// broken; the message names the shard. With `allow_incomplete` missing shards are skipped.
  ///
  /// `isolated`: HDF5 reads in child processes (fork()) with limits of memory and time, one for each call. For data sets from strangers: a
  /// file with a matching checksum can still be made to crash HDF5 or to keep it busy, which is an Error(kInput) then. Data sets of format
  /// 1 are always read so. Default false.
  explicit DatasetReader(std::filesystem::path directory, bool allow_incomplete = false, bool isolated = false);
  ~DatasetReader();
  DatasetReader(DatasetReader&&) noexcept;  ///< Leaves the other object unusable.

  const Manifest& manifest() const;                         ///< Manifest; valid as long as the reader.
  std::uint64_t numFrames() const;                          ///< Frames of all shards that are present.
  std::uint64_t numEpisodes() const;                        ///< Episodes of all shards that are present.
  const std::vector<std::uint64_t>& episodeEnds() const;    ///< (numEpisodes()), index of the frame after each episode.
  const std::vector<std::uint64_t>& missingShards() const;  ///< Numbers of the shards that are missing.

  /// Checks a shard as read() does before its first row, for a program that reads rows by itself. HDF5 can read the columns of the manifest
  /// then without leaving the file. `contents`: whether to compare the file, or all columns of format 1, with their SHA-256. Throws
  /// Error(kInput) for a broken shard, and for one that is not on disk.
  void checkShard(std::uint64_t shard, bool contents) const;

  /// Rows [first, first + count) of a column as bytes. Throws Error(kInput) for an unknown column, rows out of range or a broken shard.
  std::vector<std::byte> read(const std::string& column, std::uint64_t first, std::uint64_t count) const;
  /// The same rows converted to double. Throws what read() throws, and Error(kInput) for a column of text.
  std::vector<double> readAsDouble(const std::string& column, std::uint64_t first, std::uint64_t count) const;
  /// The same rows of a column of text, without padding. Throws what read() throws, and Error(kInput) for a column of numbers.
  std::vector<std::string> readAsText(const std::string& column, std::uint64_t first, std::uint64_t count) const;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace taxelsim
