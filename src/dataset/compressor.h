// Columns cut into chunks as HDF5's filters shuffle and deflate make them, several threads at once. Not how they come into a file.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "dataset/workers.h"

namespace taxelsim::dataset {

// One chunk as it lies in the file.
struct StoredChunk {
  std::vector<std::byte> bytes;
  std::uint32_t skipped_filters = 0;  // HDF5's filter mask: bit i for filter i, counted from 0: shuffle, deflate
};

// The bytes of `rows`, filled up with zeros to chunk_bytes, by their place in a scalar: all first ones, all second ones, ... (chunk_bytes).
void shuffle(std::span<const std::byte> rows, std::size_t scalar_bytes, std::span<std::byte> shuffled);

class Compressor {
 public:
  // level: of gzip, 1 to 9. Throws std::bad_alloc, std::system_error.
  Compressor(int level, int num_threads);
  ~Compressor();
  Compressor(const Compressor&) = delete;
  Compressor& operator=(const Compressor&) = delete;

  struct Rows {
    std::span<const std::byte> bytes;
    std::size_t chunk_bytes = 0;   // of a whole chunk, >= 1; the last one is filled up
    std::size_t scalar_bytes = 0;  // of chunk_bytes a divisor
  };

  // The chunks of each column, in order. What does not shrink is shuffled only, as HDF5 itself has it for a filter that may be left out.
  // The result depends on level and columns only. Throws std::bad_alloc.
  std::vector<std::vector<StoredChunk>> compress(std::span<const Rows> columns);

 private:
  class Deflater;

  std::vector<Deflater> deflaters_;  // one for each thread
  Workers workers_;
};

}  // namespace taxelsim::dataset
