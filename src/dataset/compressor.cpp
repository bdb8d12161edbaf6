#include "dataset/compressor.h"

#include <libdeflate.h>

#include <algorithm>
#include <memory>
#include <new>

namespace taxelsim::dataset {
namespace {

constexpr std::uint32_t kDeflateFilter = 1u << 1;  // bit of the filter mask

// With the size as a constant the compiler vectorises the inner loop.
template <std::size_t scalar_bytes>
void shuffleScalars(const std::byte* rows, std::size_t num_scalars, std::size_t num_in_chunk, std::byte* shuffled) {
  for (std::size_t b = 0; b < scalar_bytes; ++b) {
    for (std::size_t i = 0; i < num_scalars; ++i) shuffled[b * num_in_chunk + i] = rows[i * scalar_bytes + b];
  }
}

}  // namespace

void shuffle(std::span<const std::byte> rows, std::size_t scalar_bytes, std::span<std::byte> shuffled) {
  const std::size_t num_scalars = rows.size() / scalar_bytes, num_in_chunk = shuffled.size() / scalar_bytes;
  switch (scalar_bytes) {
    case 1:
      shuffleScalars<1>(rows.data(), num_scalars, num_in_chunk, shuffled.data());
      break;
    case 2:
      shuffleScalars<2>(rows.data(), num_scalars, num_in_chunk, shuffled.data());
      break;
    case 4:
      shuffleScalars<4>(rows.data(), num_scalars, num_in_chunk, shuffled.data());
      break;
    case 8:
      shuffleScalars<8>(rows.data(), num_scalars, num_in_chunk, shuffled.data());
      break;
    default:  // text
      for (std::size_t i = 0; i < num_scalars; ++i)
        for (std::size_t b = 0; b < scalar_bytes; ++b) shuffled[b * num_in_chunk + i] = rows[i * scalar_bytes + b];
  }
  for (std::size_t b = 0; b < scalar_bytes; ++b) {
    std::fill(shuffled.begin() + static_cast<std::ptrdiff_t>(b * num_in_chunk + num_scalars),
              shuffled.begin() + static_cast<std::ptrdiff_t>((b + 1) * num_in_chunk), std::byte{0});
  }
}

// Used by one thread.
class Compressor::Deflater {
 public:
  explicit Deflater(int level) : compressor_(libdeflate_alloc_compressor(level), libdeflate_free_compressor) {
    if (!compressor_) throw std::bad_alloc();
  }

  StoredChunk store(std::span<const std::byte> rows, const Rows& column) {
    shuffled_.resize(column.chunk_bytes);
    shuffle(rows, column.scalar_bytes, shuffled_);
    deflated_.resize(column.chunk_bytes);
    // With one byte less than the input, success means that the chunk has shrunk.
    const std::size_t size =
        libdeflate_zlib_compress(compressor_.get(), shuffled_.data(), shuffled_.size(), deflated_.data(), deflated_.size() - 1);
    if (size == 0) return {.bytes = shuffled_, .skipped_filters = kDeflateFilter};
    return {.bytes = {deflated_.begin(), deflated_.begin() + static_cast<std::ptrdiff_t>(size)}, .skipped_filters = 0};
  }

 private:
  std::unique_ptr<libdeflate_compressor, decltype(&libdeflate_free_compressor)> compressor_;
  std::vector<std::byte> shuffled_, deflated_;
};

Compressor::Compressor(int level, int num_threads) : threads_(num_threads) {
  for (int thread = 0; thread < num_threads; ++thread) deflaters_.emplace_back(level);
}

Compressor::~Compressor() = default;

std::vector<std::vector<StoredChunk>> Compressor::compress(std::span<const Rows> columns) {
  struct Job {
    std::size_t column, chunk;
  };
  const std::lock_guard lock(mutex_);
  std::vector<Job> jobs;
  std::vector<std::vector<StoredChunk>> stored(columns.size());
  for (std::size_t c = 0; c < columns.size(); ++c) {
    stored[c].resize((columns[c].bytes.size() + columns[c].chunk_bytes - 1) / columns[c].chunk_bytes);
    for (std::size_t k = 0; k < stored[c].size(); ++k) jobs.push_back({c, k});
  }
  threads_.run(jobs.size(), [&](int thread, std::size_t index) {
    const auto [c, k] = jobs[index];
    const Rows& column = columns[c];
    const std::size_t first = k * column.chunk_bytes;
    const std::span rows = column.bytes.subspan(first, std::min(column.chunk_bytes, column.bytes.size() - first));
    stored[c][k] = deflaters_[static_cast<std::size_t>(thread)].store(rows, column);
  });
  return stored;
}

}  // namespace taxelsim::dataset
