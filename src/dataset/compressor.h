// Multithreaded compression of columns into HDF5 chunks. Produces the same bytes as HDF5's shuffle and deflate filters, which run on one
// thread. Writing chunks to a file is shard.cpp's task.
#pragma once

#include <cstddef>
#include <cstdint>
#include <mutex>
#include <span>
#include <vector>

#include "dataset/thread_pool.h"

namespace taxelsim::dataset {

// One chunk as stored in the file.
struct StoredChunk {
  std::vector<std::byte> bytes;
  std::uint32_t skipped_filters = 0;  // HDF5's filter mask: bit 0 for shuffle, bit 1 for deflate
};

// HDF5's shuffle filter: the first bytes of all scalars, then all second bytes, and so on. `rows` is padded with zeros to the size of
// `shuffled`. `scalar_bytes`: >= 1.
void shuffle(std::span<const std::byte> rows, std::size_t scalar_bytes, std::span<std::byte> shuffled);

class Compressor {
 public:
  // `level`: of deflate, 1 to 9. Throws std::bad_alloc, std::system_error.
  Compressor(int level, int num_threads);
  ~Compressor();
  Compressor(const Compressor&) = delete;
  Compressor& operator=(const Compressor&) = delete;

  struct Rows {
    std::span<const std::byte> bytes;
    std::size_t chunk_bytes = 0;   // size of a chunk, >= 1; the last one is padded
    std::size_t scalar_bytes = 0;  // divides chunk_bytes
  };

  // Returns the chunks of each column, in order. Chunks that deflate does not shrink are only shuffled, as HDF5 does for optional filters.
  // The result does not depend on the number of threads. Throws std::bad_alloc. Thread-safe: one call runs at a time.
  std::vector<std::vector<StoredChunk>> compress(std::span<const Rows> columns);

 private:
  class Deflater;

  std::mutex mutex_;                 // of compress()
  std::vector<Deflater> deflaters_;  // (num_threads)
  ThreadPool threads_;
};

}  // namespace taxelsim::dataset
