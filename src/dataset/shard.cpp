#include "dataset/shard.h"

#include <algorithm>
#include <span>

#include "base/sha256.h"
#include "dataset/compressor.h"
#include "dataset/hdf5.h"
#include "dataset/manifest.h"
#include "taxelsim/error.h"

namespace taxelsim::dataset {
namespace {

constexpr std::size_t kChunkBytes = std::size_t{256} << 10;  // compressed columns; several fit HDF5's chunk cache of 1 MiB
constexpr std::size_t kMetadataBytes = 4096;                 // headers and attributes of a shard, estimate
constexpr std::size_t kColumnMetadataBytes = 1024;           // the same of each column
constexpr const char* kHashAttribute = "sha256";

// For compressed columns HDF5 places chunk indices between the rows, regardless of the size of the metadata block.
std::size_t metadataBytes(const Manifest& manifest) {
  return kMetadataBytes + (manifest.compression > 0 ? 0 : manifest.columns.size() * kColumnMetadataBytes);
}

Column episodeEndsColumn() {
  return {.name = kEpisodeEnds,
          .type = ScalarType::kUint64,
          .shape = {},
          .unit = "1",
          .description = "Number of frames up to the end of each episode, counted from the first frame of this file.",
          .per_episode = true};
}

std::vector<hsize_t> shapeOf(const Column& column, std::uint64_t num_rows) {
  std::vector<hsize_t> shape{num_rows};
  shape.insert(shape.end(), column.shape.begin(), column.shape.end());
  return shape;
}

// Number of rows per chunk of a compressed column.
std::uint64_t chunkRows(const Column& column, std::uint64_t num_rows) {
  return std::clamp<std::uint64_t>(kChunkBytes / rowBytes(column), 1, num_rows);
}

void writeAttributes(hid_t data, const Column& column, std::span<const std::byte> rows) {
  writeAttribute(data, "unit", column.unit);
  writeAttribute(data, "description", column.description);
  writeAttribute(data, kHashAttribute, sha256Hex(rows));
}

// Uncompressed: HDF5 only allocates the space; the rows are written from their memory.
void placeColumn(FileImage& image, const Column& column, std::uint64_t num_rows, std::span<const std::byte> rows) {
  const Handle properties = image.datasetProperties();
  checked(H5Pset_alloc_time(properties, H5D_ALLOC_TIME_EARLY));
  const Handle data = image.createDataset(column.name, column.type, shapeOf(column, num_rows), properties);
  writeAttributes(data, column, rows);
  image.placeRows(data, rows);
}

// Compressed: writes chunks that are already filtered.
void writeChunks(FileImage& image, const Column& column, std::uint64_t num_rows, int level, std::span<const std::byte> rows,
                 std::span<const StoredChunk> chunks) {
  const std::vector<hsize_t> shape = shapeOf(column, num_rows);
  std::vector<hsize_t> chunk = shape;
  chunk[0] = chunkRows(column, num_rows);
  const Handle properties = image.datasetProperties();
  checked(H5Pset_chunk(properties, static_cast<int>(chunk.size()), chunk.data()));
  checked(H5Pset_shuffle(properties));
  checked(H5Pset_deflate(properties, static_cast<unsigned>(level)));
  const Handle data = image.createDataset(column.name, column.type, shape, properties);
  writeAttributes(data, column, rows);
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
    columns.push_back(
        {.bytes = data.columns[i], .chunk_bytes = chunkRows(column, num_rows) * rowBytes(column), .scalar_bytes = scalarSize(column.type)});
  }
  return compressor.compress(columns);
}

void writeEnds(FileImage& image, std::span<const std::uint64_t> ends) {
  const Column column = episodeEndsColumn();
  const Handle data = image.createDataset(column.name, column.type, shapeOf(column, ends.size()), image.datasetProperties());
  writeAttributes(data, column, std::as_bytes(ends));
  checked(H5Dwrite(data, memoryType(column.type), H5S_ALL, H5S_ALL, H5P_DEFAULT, ends.data()));
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

void expect(bool holds, const std::string& problem) {
  if (!holds) throw Hdf5Error(problem);
}

void expectNumber(hid_t file, const char* name, std::uint64_t expected) {
  const std::uint64_t found = readNumberAttribute(file, name);
  expect(found == expected,
         std::string(name) + " is " + std::to_string(found) + ", not " + std::to_string(expected) + " as in the manifest");
}

void expectText(hid_t file, const char* name, const std::string& expected) {
  const std::string found = readTextAttribute(file, name);
  expect(found == expected, std::string(name) + " is " + found + ", not " + expected + " as in the manifest");
}

// Opens a column. Throws Hdf5Error if its type or shape is not as expected.
Handle openColumn(hid_t file, const Column& column, std::uint64_t num_rows) {
  Handle data(H5Dopen2(file, column.name.c_str(), H5P_DEFAULT), H5Dclose);
  const Handle type(H5Dget_type(data), H5Tclose);
  const Handle space(H5Dget_space(data), H5Sclose);
  const std::vector<hsize_t> shape = shapeOf(column, num_rows);
  std::vector<hsize_t> found(static_cast<std::size_t>(checked(H5Sget_simple_extent_ndims(space))));
  if (!found.empty()) checked(H5Sget_simple_extent_dims(space, found.data(), nullptr));
  expect(checked(H5Tequal(type, fileType(column.type))) > 0 && found == shape, "column " + column.name + " has another type or shape");
  return data;
}

void readRows(hid_t data, const Column& column, std::uint64_t first, std::uint64_t count, std::byte* rows) {
  std::vector<hsize_t> start(column.shape.size() + 1, 0);
  start[0] = first;
  const std::vector<hsize_t> shape = shapeOf(column, count);
  const Handle space(H5Dget_space(data), H5Sclose);
  checked(H5Sselect_hyperslab(space, H5S_SELECT_SET, start.data(), nullptr, shape.data(), nullptr));
  const Handle memory(H5Screate_simple(static_cast<int>(shape.size()), shape.data(), nullptr), H5Sclose);
  checked(H5Dread(data, memoryType(column.type), memory, space, H5P_DEFAULT, rows));
}

// Reads a whole column and checks its hash.
std::vector<std::byte> readVerified(hid_t data, const Column& column, std::uint64_t num_rows) {
  std::vector<std::byte> rows(rowBytes(column) * num_rows);
  readRows(data, column, 0, num_rows, rows.data());
  expect(sha256Hex(rows) == readTextAttribute(data, kHashAttribute), "SHA-256 mismatch of " + column.name);
  return rows;
}

std::vector<std::uint64_t> readEnds(hid_t file, std::uint64_t num_episodes) {
  const Column column = episodeEndsColumn();
  const Handle data = openColumn(file, column, num_episodes);
  const std::vector<std::byte> bytes = readVerified(data, column, num_episodes);
  std::vector<std::uint64_t> ends(num_episodes);
  std::copy(bytes.begin(), bytes.end(), std::as_writable_bytes(std::span(ends)).begin());
  for (std::size_t i = 0; i < ends.size(); ++i) expect(ends[i] > (i > 0 ? ends[i - 1] : 0), "meta/episode_ends is not increasing");
  return ends;
}

template <typename Function>
auto withFileName(const std::filesystem::path& file, Function function) {
  try {
    const Hdf5Session session;
    return function();
  } catch (const Hdf5Error& error) {
    throw Error(ErrorKind::kInput, file.string() + ": broken or foreign shard: " + error.what() + "; remove the file to generate it again");
  }
}

}  // namespace

FileContent shardImage(const Manifest& manifest, std::uint64_t shard, const ShardData& data, Compressor* compressor) {
  const std::vector<std::uint64_t> ends = endsOf(manifest, shard, data);
  std::vector<std::vector<StoredChunk>> chunks;
  if (manifest.compression > 0) chunks = compressed(manifest, data, ends.size(), ends.back(), *compressor);
  try {
    const Hdf5Session session;
    FileImage image(H5F_LIBVER_V18, metadataBytes(manifest));
    writeAttribute(image.file(), "format_version", kFormatVersion);
    writeAttribute(image.file(), "shard", shard);
    writeAttribute(image.file(), "first_episode", firstEpisode(manifest, shard));
    writeAttribute(image.file(), "num_episodes", ends.size());
    writeAttribute(image.file(), "seed", manifest.seed);
    writeAttribute(image.file(), "scene_sha256", sceneHash(manifest));
    writeAttribute(image.file(), "program_version", manifest.program_version);
    writeAttribute(image.file(), "device", manifest.device);
    writeEnds(image, ends);
    for (std::size_t i = 0; i < data.columns.size(); ++i) {
      const Column& column = manifest.columns[i];
      const std::uint64_t num_rows = column.per_episode ? ends.size() : ends.back();
      if (manifest.compression > 0) {
        writeChunks(image, column, num_rows, manifest.compression, data.columns[i], chunks[i]);
      } else {
        placeColumn(image, column, num_rows, data.columns[i]);
      }
    }
    return image.close();
  } catch (const Hdf5Error& error) {
    throw Error(ErrorKind::kIo, "cannot create " + shardName(shard) + ": " + error.what());
  }
}

std::vector<std::uint64_t> checkShard(const std::filesystem::path& file, const Manifest& manifest, std::uint64_t shard, bool contents) {
  return withFileName(file, [&] {
    const Handle handle = openForReading(file);
    const std::uint64_t version = readNumberAttribute(handle, "format_version");
    expect(version == kFormatVersion,
           "format_version is " + std::to_string(version) + ", this program reads " + std::to_string(kFormatVersion));
    expectText(handle, "scene_sha256", sceneHash(manifest));
    expectNumber(handle, "seed", manifest.seed);
    expectText(handle, "program_version", manifest.program_version);
    expectText(handle, "device", manifest.device);
    expectNumber(handle, "shard", shard);
    expectNumber(handle, "first_episode", firstEpisode(manifest, shard));
    expectNumber(handle, "num_episodes", numEpisodes(manifest, shard));
    std::vector<std::uint64_t> ends = readEnds(handle, numEpisodes(manifest, shard));
    for (const Column& column : manifest.columns) {
      const std::uint64_t num_rows = column.per_episode ? ends.size() : ends.back();
      const Handle data = openColumn(handle, column, num_rows);
      if (contents) readVerified(data, column, num_rows);
    }
    return ends;
  });
}

void readShardRows(const std::filesystem::path& file, const Column& column, std::uint64_t first, std::uint64_t count, std::byte* rows) {
  withFileName(file, [&] {
    const Handle handle = openForReading(file);
    const Handle data(H5Dopen2(handle, column.name.c_str(), H5P_DEFAULT), H5Dclose);
    readRows(data, column, first, count, rows);
  });
}

}  // namespace taxelsim::dataset
