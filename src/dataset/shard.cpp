#include "dataset/shard.h"

#include <algorithm>
#include <functional>
#include <span>

#include "base/sha256.h"
#include "dataset/checksum.h"
#include "dataset/column_io.h"
#include "dataset/compressor.h"
#include "dataset/manifest.h"
#include "taxelsim/error.h"

namespace taxelsim::dataset {
namespace {

constexpr std::size_t kShardMetadataBytes = 4096;           // headers and attributes of a shard, estimate
constexpr std::size_t kColumnMetadataBytes = 640;           // the same of each column, without its texts
constexpr std::size_t kPieceBytes = std::size_t{16} << 20;  // of a column that is verified
constexpr std::size_t kFilesPerChild = 256;                 // HDF5 keeps some memory of each file
constexpr const char* kHashAttribute = "sha256";

// For compressed columns HDF5 places chunk indices between the rows, regardless of the size of the metadata block.
std::size_t metadataBytes(const Manifest& manifest) {
  std::size_t bytes = kShardMetadataBytes;
  if (manifest.compression > 0) return bytes;
  for (const Column& column : manifest.columns) {
    bytes += kColumnMetadataBytes + column.unit.size() + column.description.size();
    for (const auto* names : {&column.value_names, &column.bit_names})
      for (const std::string& name : *names) bytes += name.size();
  }
  return bytes;
}

// Number of rows per chunk of a compressed column.
std::uint64_t chunkRows(const Manifest& manifest, const Column& column, std::uint64_t num_rows) {
  return std::clamp<std::uint64_t>(manifest.chunk_bytes / rowBytes(column), 1, num_rows);
}

void writeAttributes(hid_t data, const Column& column, const std::string& sha256) {
  writeColumnAttributes(data, column);
  writeAttribute(data, kHashAttribute, sha256);
}

// Rows of a column with their SHA-256.
struct HashedRows {
  explicit HashedRows(std::span<const std::byte> all) : bytes(all), sha256(sha256Hex(all)) {}

  std::span<const std::byte> bytes;
  std::string sha256;
};

// Uncompressed: HDF5 only allocates the space; the rows are written from their memory.
void placeColumn(FileImage& image, const Column& column, std::uint64_t num_rows, const HashedRows& rows) {
  const Handle properties = image.datasetProperties();
  checked(H5Pset_alloc_time(properties, H5D_ALLOC_TIME_EARLY));
  const Handle data = image.createDataset(column, shapeOf(column, num_rows), properties);
  writeAttributes(data, column, rows.sha256);
  image.placeRows(data, rows.bytes);
}

// Compressed: writes chunks that are already filtered.
void writeChunks(FileImage& image, const Manifest& manifest, const Column& column, std::uint64_t num_rows, const std::string& sha256,
                 std::span<const StoredChunk> chunks) {
  const std::vector<hsize_t> shape = shapeOf(column, num_rows);
  std::vector<hsize_t> chunk = shape;
  chunk[0] = chunkRows(manifest, column, num_rows);
  const Handle properties = image.datasetProperties();
  checked(H5Pset_chunk(properties, static_cast<int>(chunk.size()), chunk.data()));
  checked(H5Pset_shuffle(properties));
  checked(H5Pset_deflate(properties, static_cast<unsigned>(manifest.compression)));
  const Handle data = image.createDataset(column, shape, properties);
  writeAttributes(data, column, sha256);
  std::vector<hsize_t> start(shape.size(), 0);
  for (const StoredChunk& stored : chunks) {
    checked(H5Dwrite_chunk(data, H5P_DEFAULT, stored.skipped_filters, start.data(), stored.bytes.size(), stored.bytes.data()));
    start[0] += chunk[0];
  }
}

std::vector<std::vector<StoredChunk>> compressed(const Manifest& manifest, const ShardData& data, std::uint64_t num_episodes,
                                                 std::uint64_t num_frames, Compressor& compressor) {
  std::vector<Compressor::Rows> columns;
  for (std::size_t i = 0; i < data.columns.size(); ++i) {
    const Column& column = manifest.columns[i];
    const std::uint64_t num_rows = column.per_episode ? num_episodes : num_frames;
    columns.push_back({.bytes = data.columns[i],
                       .chunk_bytes = chunkRows(manifest, column, num_rows) * rowBytes(column),
                       .scalar_bytes = scalarSize(column)});
  }
  return compressor.compress(columns);
}

void writeEnds(FileImage& image, std::span<const std::uint64_t> ends) {
  const Column column = episodeEndsColumn();
  const Handle data = image.createDataset(column, shapeOf(column, ends.size()), image.datasetProperties());
  writeAttributes(data, column, sha256Hex(std::as_bytes(ends)));
  checked(H5Dwrite(data, typeOf(column), H5S_ALL, H5S_ALL, H5P_DEFAULT, ends.data()));
}

std::vector<std::uint64_t> endsOf(const Manifest& manifest, std::uint64_t shard, const ShardData& data) {
  const std::string name = "data set: " + shardName(shard) + ": ";
  const std::uint64_t expected = numEpisodes(manifest, shard);
  if (data.episode_lengths.size() != expected)
    throw Error(ErrorKind::kInput,
                name + std::to_string(data.episode_lengths.size()) + " episodes given, " + std::to_string(expected) + " expected");
  std::vector<std::uint64_t> ends;
  std::uint64_t end = 0;
  for (const std::uint64_t length : data.episode_lengths) {
    if (length == 0) throw Error(ErrorKind::kInput, name + "an episode has no frames");
    ends.push_back(end += length);
  }
  if (data.columns.size() != manifest.columns.size())
    throw Error(ErrorKind::kInput,
                name + std::to_string(data.columns.size()) + " columns given, " + std::to_string(manifest.columns.size()) + " expected");
  for (std::size_t i = 0; i < data.columns.size(); ++i) {
    const Column& column = manifest.columns[i];
    const std::uint64_t bytes = rowBytes(column) * (column.per_episode ? expected : end);
    if (data.columns[i].size() != bytes)
      throw Error(ErrorKind::kInput, name + "column " + column.name + " has " + std::to_string(data.columns[i].size()) + " bytes, not " +
                                         std::to_string(bytes));
  }
  return ends;
}

// Reads a whole column, in pieces, and checks its hash.
void verifyRows(hid_t data, const Column& column, std::uint64_t num_rows, std::uint64_t format) {
  const std::uint64_t row_bytes = rowBytes(column);
  const std::uint64_t step = std::max<std::uint64_t>(1, kPieceBytes / row_bytes);
  std::vector<std::byte> rows(row_bytes * std::min(step, num_rows));
  Sha256 digest;
  for (std::uint64_t first = 0; first < num_rows; first += step) {
    const std::uint64_t count = std::min(step, num_rows - first);
    readRows(data, column, first, count, rows.data());
    digest.add(std::span(rows).first(row_bytes * count));
  }
  expect(digest.finish() == readTextAttribute(data, kHashAttribute, format), "SHA-256 mismatch of " + column.name);
}

// Reads shards in the order given; in child processes, up to kFilesPerChild in each. on_problem: with the number of a read that fails.
void readShards(std::span<const Hdf5Read> reads, Isolation isolation, const std::function<void(std::size_t, const Error&)>& on_problem) {
  for (std::size_t first = 0, count = 0; first < reads.size(); first += count) {
    count = isolation == Isolation::kChild ? std::min(reads.size() - first, kFilesPerChild) : 1;
    if (count > 1 && readHdf5Together(reads.subspan(first, count))) continue;
    for (std::size_t i = first; i < first + count; ++i) {
      try {
        readHdf5(reads[i].file, "shard", "generate --repair makes it again", isolation, reads[i].bytes, reads[i].read);
      } catch (const Error& error) {
        on_problem(i, error);
      }
    }
  }
}

// Checks attributes and columns of an open shard, and reads the ends of its episodes.
void checkContent(hid_t file, const Manifest& manifest, std::uint64_t shard, bool contents, std::span<std::uint64_t> ends) {
  const std::uint64_t format = manifest.format_version;
  expectNumber(file, "format_version", format);
  expectText(file, "scene_sha256", sceneHash(manifest), format);
  expectNumber(file, "seed", manifest.seed);
  expectText(file, "program_version", manifest.program_version, format);
  expectText(file, "device", manifest.device, format);
  if (format > 1) expectText(file, "policy", manifest.policy, format);
  expectNumber(file, "shard", shard);
  expectNumber(file, "first_episode", firstEpisode(manifest, shard));
  expectNumber(file, "num_episodes", ends.size());
  const Column ends_column = episodeEndsColumn();
  const Handle ends_data = openColumn(file, ends_column, ends.size(), format);
  if (format == 1) verifyRows(ends_data, ends_column, ends.size(), format);
  readEnds(ends_data, ends_column, ends);
  for (const Column& column : manifest.columns) {
    const std::uint64_t num_rows = column.per_episode ? ends.size() : ends.back();
    const Handle data = openColumn(file, column, num_rows, format);
    if (format == 1 && contents) verifyRows(data, column, num_rows, format);
  }
}

}  // namespace

FileContent shardImage(const Manifest& manifest, std::uint64_t shard, const ShardData& data, Compressor* compressor) {
  const std::vector<std::uint64_t> ends = endsOf(manifest, shard, data);
  std::vector<std::vector<StoredChunk>> chunks;
  if (manifest.compression > 0) chunks = compressed(manifest, data, ends.size(), ends.back(), *compressor);
  // All long work is done before the lock of HDF5 is taken, so that several threads can make shards.
  const std::vector<HashedRows> columns(data.columns.begin(), data.columns.end());
  try {
    const Hdf5Session session;
    FileImage image(H5F_LIBVER_V18, metadataBytes(manifest));
    writeAttribute(image.file(), "format_version", manifest.format_version);
    writeAttribute(image.file(), "shard", shard);
    writeAttribute(image.file(), "first_episode", firstEpisode(manifest, shard));
    writeAttribute(image.file(), "num_episodes", ends.size());
    writeAttribute(image.file(), "seed", manifest.seed);
    writeAttribute(image.file(), "scene_sha256", sceneHash(manifest));
    writeAttribute(image.file(), "program_version", manifest.program_version);
    writeAttribute(image.file(), "device", manifest.device);
    writeAttribute(image.file(), "policy", manifest.policy);
    writeEnds(image, ends);
    for (std::size_t i = 0; i < data.columns.size(); ++i) {
      const Column& column = manifest.columns[i];
      const std::uint64_t num_rows = column.per_episode ? ends.size() : ends.back();
      if (manifest.compression > 0) {
        writeChunks(image, manifest, column, num_rows, columns[i].sha256, chunks[i]);
      } else {
        placeColumn(image, column, num_rows, columns[i]);
      }
    }
    return image.close();
  } catch (const Hdf5Error& error) {
    throw Error(ErrorKind::kIo, "cannot create " + shardName(shard) + ": " + error.what());
  }
}

std::vector<std::vector<std::uint64_t>> checkShardFiles(std::span<const ShardFile> shards, const Manifest& manifest, bool contents,
                                                        Isolation isolation) {
  if (manifest.format_version > 1)
    for (const ShardFile& one : shards) verifyChecksum(one.file);
  return checkShardContents(shards, manifest, contents, isolation);
}

std::vector<std::vector<std::uint64_t>> checkShardContents(std::span<const ShardFile> shards, const Manifest& manifest, bool contents,
                                                           Isolation isolation, const OnShardProblem& on_problem) {
  const auto report = [&](const ShardFile& one, const Error& error) {
    if (!on_problem) throw;  // called in a handler
    on_problem(one, error);
  };
  std::vector<std::vector<std::uint64_t>> all_ends(shards.size());
  std::vector<Hdf5Read> reads;
  std::vector<const ShardFile*> files;  // of the reads
  for (std::size_t i = 0; i < shards.size(); ++i) {
    const ShardFile& one = shards[i];
    const std::uint64_t num_episodes = numEpisodes(manifest, one.shard);
    try {
      checkCounts(one.file, num_episodes);
    } catch (const Error& error) {
      report(one, error);
      continue;
    }
    all_ends[i].resize(num_episodes);
    files.push_back(&one);
    reads.push_back({one.file, std::as_writable_bytes(std::span(all_ends[i])), [&](std::span<std::byte> bytes) {
                       checkContent(openForReading(one.file), manifest, one.shard, contents, episodeEnds(bytes));
                     }});
  }
  readShards(reads, isolation, [&](std::size_t i, const Error& error) { report(*files[i], error); });
  return all_ends;
}

void readShardRows(std::span<const ShardRows> parts, const Column& column, Isolation isolation, std::byte* rows) {
  std::vector<Hdf5Read> reads;
  for (const ShardRows& part : parts) {
    const std::span<std::byte> bytes{rows, rowBytes(column) * part.count};
    reads.push_back({part.file, bytes, [&](std::span<std::byte> buffer) {
                       const Handle file = openForReading(part.file);
                       const Handle data(H5Dopen2(file, column.name.c_str(), H5P_DEFAULT), H5Dclose);
                       readRows(data, column, part.first, part.count, buffer.data());
                     }});
    rows += bytes.size();
  }
  readShards(reads, isolation, [](std::size_t, const Error&) { throw; });
}

}  // namespace taxelsim::dataset
