// Compressor: same chunks as HDF5's filters, independent of the number of threads.
#include "dataset/compressor.h"

#include <libdeflate.h>

#include "dataset/example.h"
#include "dataset/shard.h"
#include "support/test.h"

namespace taxelsim::testing {
namespace {

using dataset::Compressor;
using dataset::StoredChunk;

constexpr std::size_t kChunk = 8000;

// Compressible values, or random bytes.
std::vector<std::byte> bytesOf(std::size_t size, bool noise) {
  std::mt19937 random(7);
  std::vector<std::byte> bytes(size);
  for (std::size_t i = 0; i < size; ++i)
    bytes[i] = noise ? static_cast<std::byte>(random()) : static_cast<std::byte>(i % 8 == 0 ? i / 64 : 1);
  return bytes;
}

std::vector<std::byte> inflated(const StoredChunk& chunk) {
  const std::unique_ptr<libdeflate_decompressor, decltype(&libdeflate_free_decompressor)> decompressor(libdeflate_alloc_decompressor(),
                                                                                                       libdeflate_free_decompressor);
  std::vector<std::byte> bytes(kChunk);
  EXPECT_EQ(libdeflate_zlib_decompress(decompressor.get(), chunk.bytes.data(), chunk.bytes.size(), bytes.data(), bytes.size(), nullptr),
            LIBDEFLATE_SUCCESS);
  return bytes;
}

std::vector<std::byte> unshuffled(std::span<const std::byte> bytes, std::size_t scalar_bytes) {
  std::vector<std::byte> rows(bytes.size());
  const std::size_t num_scalars = bytes.size() / scalar_bytes;
  for (std::size_t i = 0; i < bytes.size(); ++i) rows[i] = bytes[i % scalar_bytes * num_scalars + i / scalar_bytes];
  return rows;
}

TEST(Compressor, ChunksContainTheRowsPaddedWithZeros) {
  for (const std::size_t scalar_bytes : {1u, 2u, 4u, 5u, 8u}) {
    for (const std::size_t size : {kChunk, 3 * kChunk, 2 * kChunk + 40, std::size_t{40}}) {
      const std::vector<std::byte> rows = bytesOf(size, false);
      Compressor compressor(4, 2);
      const std::vector<Compressor::Rows> columns{{.bytes = rows, .chunk_bytes = kChunk, .scalar_bytes = scalar_bytes}};
      const auto stored = compressor.compress(columns);
      ASSERT_EQ(stored.size(), 1u);
      std::vector<std::byte> back;
      for (const StoredChunk& chunk : stored[0]) {
        EXPECT_EQ(chunk.skipped_filters, 0u);
        EXPECT_LT(chunk.bytes.size(), kChunk);
        const std::vector<std::byte> part = unshuffled(inflated(chunk), scalar_bytes);
        back.insert(back.end(), part.begin(), part.end());
      }
      std::vector<std::byte> expected = rows;
      expected.resize((size + kChunk - 1) / kChunk * kChunk, std::byte{0});
      EXPECT_EQ(back, expected) << scalar_bytes << " bytes a scalar, " << size << " in all";
    }
  }
}

TEST(Compressor, ChunksThatDoNotShrinkAreOnlyShuffled) {
  const std::vector<std::byte> rows = bytesOf(2 * kChunk, true);
  Compressor compressor(9, 2);
  const std::vector<Compressor::Rows> columns{{.bytes = rows, .chunk_bytes = kChunk, .scalar_bytes = 4}};
  const auto stored = compressor.compress(columns);
  ASSERT_EQ(stored[0].size(), 2u);
  for (std::size_t k = 0; k < 2; ++k) {
    EXPECT_EQ(stored[0][k].skipped_filters, 2u) << "the second filter, deflate";
    const std::vector<std::byte> chunk(rows.begin() + static_cast<std::ptrdiff_t>(k * kChunk),
                                       rows.begin() + static_cast<std::ptrdiff_t>((k + 1) * kChunk));
    EXPECT_EQ(unshuffled(stored[0][k].bytes, 4), chunk);
  }
}

// The bytes of a shard file.
std::vector<std::byte> fileOf(const Manifest& manifest, const ShardData& data, int num_threads) {
  Compressor compressor(manifest.compression, num_threads);
  const FileContent content = dataset::shardImage(manifest, 0, data, &compressor);
  std::vector<std::byte> bytes(content.size);
  for (const FilePiece& piece : content.pieces) {
    std::copy(piece.bytes.begin(), piece.bytes.end(), bytes.begin() + static_cast<std::ptrdiff_t>(piece.offset));
  }
  return bytes;
}

TEST(Compressor, FileIsIndependentOfTheNumberOfThreads) {
  Manifest manifest = exampleManifest();
  manifest.compression = 4;
  manifest.columns = {{"data/smooth", ScalarType::kFloat32, {50}, "N", "Shrinks.", false},
                      {"data/noise", ScalarType::kUint16, {40}, "counts", "Does not.", false},
                      {"meta/object", ScalarType::kInt32, {}, "1", "Short.", true}};
  constexpr std::uint64_t kNumFrames = 20000;  // several chunks, the last one partly filled
  const ShardData data{.episode_lengths = {1, kNumFrames - 3, 1, 1},
                       .columns = {bytesOf(200 * kNumFrames, false), bytesOf(80 * kNumFrames, true), bytesOf(16, false)}};
  const std::vector<std::byte> expected = fileOf(manifest, data, 1);
  for (const int num_threads : {2, 5}) EXPECT_EQ(fileOf(manifest, data, num_threads), expected) << num_threads << " threads";
}

}  // namespace
}  // namespace taxelsim::testing
