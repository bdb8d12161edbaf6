// Products with the influence matrix of an elastic layer, in single precision: by the sum over the nodes with pressure, and by FFTs.
#pragma once

#include <fftw3.h>

#include <array>
#include <cstddef>
#include <map>
#include <memory>
#include <span>
#include <vector>

#include "peers/layer_solve.h"

namespace taxelsim::bench {

// A x by its definition, sixteen results of a row at once; only over the nodes where x is not 0.
class DirectProduct {
 public:
  // `influence` (num_rows x num_cols): of a node on those u rows and v columns away.
  DirectProduct(const LayerGrid& grid, std::span<const float> influence);

  // The nodes with x, in one thread.
  struct Sources {
    std::vector<float> value;
    std::vector<int> col;
    std::vector<std::array<int, 3>> rows;  // row, first and end of value[], a multiple of four
  };

  void operator()(const LayerSolve& solve, const float* x, float* product, Sources& sources) const;

 private:
  template <int kVectors>
  void ofRow(const Sources& sources, int row, int first, float* to) const;
  const float* tableOf(int distance) const { return table_.data() + static_cast<std::size_t>(distance * width_ + grid_.num_cols); }

  LayerGrid grid_;
  int width_;                 // of a row of the table
  std::vector<float> table_;  // by distance of the rows, then of the columns from -num_cols up
};

struct FreeFftw {
  void operator()(float* memory) const { fftwf_free(memory); }
};
using FftwFloats = std::unique_ptr<float[], FreeFftw>;

// Circular convolution over rows x cols complex numbers, which hold two instances, one in the real and one in the imaginary part: the
// influence is even in both directions, so that its spectrum is real and mixes nothing. Transforms along the rows skip those that are only
// padding.
class FftConvolution {
 public:
  // Plans for windows of up to (rows + 1) / 2 x (cols + 1) / 2 nodes. One thread at a time plans.
  FftConvolution(const LayerGrid& grid, std::span<const float> influence, int rows, int cols);
  ~FftConvolution();
  FftConvolution(const FftConvolution&) = delete;
  FftConvolution& operator=(const FftConvolution&) = delete;

  // Arrays of a thread, for the largest convolution. `a` holds rows of the window, `b` and `c` are padded.
  struct Arrays {
    explicit Arrays(std::size_t num_complex);
    FftwFloats a, b, c, d;
    const FftConvolution* padded_for = nullptr;  // the convolution whose padding `b` has
  };

  // For each of the two solves that is not null: product() = A input() over the window.
  void operator()(const std::array<LayerSolve*, 2>& pair, Arrays& arrays) const;

 private:
  void plan(Arrays& arrays);
  template <typename Work>
  void overEights(const LayerSolve& solve, const Work& work) const;
  void pack(const std::array<LayerSolve*, 2>& pair, float* to) const;
  void unpack(const std::array<LayerSolve*, 2>& pair, const float* from) const;

  LayerGrid grid_;
  int rows_, cols_, half_;  // half_: rows of a window at most
  std::vector<float> spectrum_;
  std::array<fftwf_plan, 4> plans_{};  // rows, columns; back columns, rows
};

// A length that FFTs are fast at, for windows of `extent` nodes.
int paddedLength(int extent);

}  // namespace taxelsim::bench
