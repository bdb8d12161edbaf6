#include "peers/layer_products.h"

#include <algorithm>
#include <cstdlib>
#include <cstring>

#include "peers/lanes.h"

namespace taxelsim::bench {
namespace {

constexpr int kUnroll = 4;  // sources at once

using lanes::Eight;

Eight loadEight(const float* from) {
  Eight v;
  std::memcpy(&v, from, sizeof v);
  return v;
}

void storeEight(float* to, Eight v) {
  std::memcpy(to, &v, sizeof v);
}

fftwf_complex* complexOf(const FftwFloats& array) {
  return reinterpret_cast<fftwf_complex*>(array.get());
}

}  // namespace

DirectProduct::DirectProduct(const LayerGrid& grid, std::span<const float> influence)
    : grid_(grid), width_(grid.num_cols + grid.stride + kLanes), table_(static_cast<std::size_t>(grid.num_rows * width_), 0) {
  for (int u = 0; u < grid.num_rows; ++u) {
    float* row = table_.data() + static_cast<std::size_t>(u * width_ + grid.num_cols);
    for (int v = 1 - grid.num_cols; v < grid.num_cols; ++v) row[v] = influence[static_cast<std::size_t>(u * grid.num_cols + std::abs(v))];
  }
}

// kVectors vectors of results from `first` on in a row.
template <int kVectors>
void DirectProduct::ofRow(const Sources& sources, int row, int first, float* to) const {
  constexpr int kChains = kVectors == 1 ? 4 : kVectors == 2 ? 2 : 1;  // sums that do not wait for each other
  Floats sum[kChains][kVectors]{};
  for (const auto& [source_row, begin, end] : sources.rows) {
    const float* table = tableOf(std::abs(row - source_row)) + first;
    for (int s = begin; s < end; s += kUnroll) {
      for (int u = 0; u < kUnroll; ++u) {
        const float* entry = table - sources.col[static_cast<std::size_t>(s + u)];
        const float x = sources.value[static_cast<std::size_t>(s + u)];
        for (int k = 0; k < kVectors; ++k) sum[u % kChains][k] += x * load(entry + k * kLanes);
      }
    }
  }
  for (int k = 0; k < kVectors; ++k) {
    for (int chain = 1; chain < kChains; ++chain) sum[0][k] += sum[chain][k];
    store(to + k * kLanes, sum[0][k]);
  }
}

void DirectProduct::operator()(const LayerSolve& solve, const float* x, float* product, Sources& sources) const {
  sources.value.clear();
  sources.col.clear();
  sources.rows.clear();
  for (const RowPart& part : solve.parts()) {
    const int begin = static_cast<int>(sources.value.size());
    for (int k = 0; k < part.num_vectors; ++k) {
      const int first = part.first + k * kLanes;
      const float* values = x + grid_.at(part.row, first);
      const Floats v = load(values);
      for (unsigned left = bitsOf(v > Floats{}) | bitsOf(v < Floats{}); left != 0; left &= left - 1) {
        const int lane = __builtin_ctz(left);
        sources.value.push_back(values[lane]);
        sources.col.push_back(first + lane);
      }
    }
    if (static_cast<int>(sources.value.size()) == begin) continue;
    while (sources.value.size() % kUnroll != 0) {
      sources.value.push_back(0);
      sources.col.push_back(part.first);
    }
    sources.rows.push_back({part.row, begin, static_cast<int>(sources.value.size())});
  }
  for (const RowPart& part : solve.parts()) {
    for (int k = 0; k < part.num_vectors; k += 4) {
      const int first = part.first + k * kLanes;
      float* to = product + grid_.at(part.row, first);
      switch (std::min(part.num_vectors - k, 4)) {
        case 1:
          ofRow<1>(sources, part.row, first, to);
          break;
        case 2:
          ofRow<2>(sources, part.row, first, to);
          break;
        case 3:
          ofRow<3>(sources, part.row, first, to);
          break;
        default:
          ofRow<4>(sources, part.row, first, to);
      }
    }
  }
}

int paddedLength(int extent) {
  constexpr std::array kLengths{8, 12, 16, 20, 24, 28, 32, 40, 48, 56, 64, 80, 96, 112, 128, 144, 160, 192, 224, 256, 320, 384, 448, 512};
  for (const int length : kLengths) {
    if (length >= 2 * extent - 1) return length;
  }
  return 2 * extent;
}

// Calls `work(node, number)` for every eight nodes of the parts: index of the first in padded arrays, and of its real part among the
// complex numbers of the window.
template <typename Work>
void FftConvolution::overEights(const LayerSolve& solve, const Work& work) const {
  const LayerWindow& window = solve.window();
  for (const RowPart& part : solve.parts()) {
    const std::size_t node = grid_.at(part.row, part.first);
    const auto number = static_cast<std::size_t>(2 * ((part.row - window.first_row) * cols_ + part.first - window.first_col));
    for (int k = 0; k < std::min(part.num_vectors * kLanes, window.end_col - part.first); k += 8) {
      work(node + static_cast<std::size_t>(k), number + static_cast<std::size_t>(2 * k));
    }
  }
}

FftConvolution::Arrays::Arrays(std::size_t num_complex) {
  for (FftwFloats* array : {&a, &b, &c, &d}) {
    const std::size_t size = 2 * num_complex + 2 * kLanes;  // the last eight nodes may end past the last row
    array->reset(fftwf_alloc_real(size));
    std::fill_n(array->get(), size, 0.0f);
  }
}

FftConvolution::FftConvolution(const LayerGrid& grid, std::span<const float> influence, int rows, int cols)
    : grid_(grid), rows_(rows), cols_(cols), half_((rows + 1) / 2) {
  const auto size = static_cast<std::size_t>(rows) * static_cast<std::size_t>(cols);
  Arrays arrays(size);
  plan(arrays);
  const fftwf_plan forward = fftwf_plan_dft_2d(rows, cols, complexOf(arrays.b), complexOf(arrays.c), FFTW_FORWARD, FFTW_ESTIMATE);
  std::fill_n(arrays.b.get(), 2 * size, 0.0f);
  for (int i = 0; i < rows; ++i) {
    const int u = std::min(i, rows - i);
    for (int j = 0; j < cols; ++j) {
      const int v = std::min(j, cols - j);
      if (u >= grid.num_rows || v >= grid.num_cols) continue;
      arrays.b[static_cast<std::size_t>(2 * (i * cols + j))] = influence[static_cast<std::size_t>(u * grid.num_cols + v)];
    }
  }
  fftwf_execute(forward);
  fftwf_destroy_plan(forward);
  // Twice, as the numbers that it multiplies are pairs.
  for (std::size_t k = 0; k < size; ++k) spectrum_.insert(spectrum_.end(), 2, arrays.c[2 * k] / static_cast<float>(size));
}

FftConvolution::~FftConvolution() {
  for (const fftwf_plan p : plans_) fftwf_destroy_plan(p);
}

void FftConvolution::plan(Arrays& arrays) {
  const fftwf_iodim row{cols_, 1, 1}, all_rows{half_, cols_, cols_};
  const fftwf_iodim col{rows_, cols_, cols_}, all_cols{cols_, 1, 1};
  constexpr unsigned kEffort = FFTW_PATIENT;
  plans_ = {fftwf_plan_guru_dft(1, &row, 1, &all_rows, complexOf(arrays.a), complexOf(arrays.b), FFTW_FORWARD, kEffort),
            fftwf_plan_guru_dft(1, &col, 1, &all_cols, complexOf(arrays.b), complexOf(arrays.c), FFTW_FORWARD, kEffort),
            fftwf_plan_guru_dft(1, &col, 1, &all_cols, complexOf(arrays.c), complexOf(arrays.d), FFTW_BACKWARD, kEffort),
            fftwf_plan_guru_dft(1, &row, 1, &all_rows, complexOf(arrays.d), complexOf(arrays.a), FFTW_BACKWARD, kEffort)};
}

// Only what lies in the parts counts; nodes of a part past its window are 0.
void FftConvolution::pack(const std::array<LayerSolve*, 2>& pair, float* to) const {
  std::fill_n(to, static_cast<std::size_t>(2 * half_ * cols_), 0.0f);
  const Eight zero{};
  for (std::size_t which = 0; which < 2; ++which) {
    if (!pair[which]) continue;
    overEights(*pair[which], [&](std::size_t node, std::size_t number) {
      const Eight x = loadEight(pair[which]->input() + node);
      const Eight low = which == 0 ? __builtin_shufflevector(x, zero, 0, 8, 1, 8, 2, 8, 3, 8)
                                   : __builtin_shufflevector(x, zero, 8, 0, 8, 1, 8, 2, 8, 3),
                  high = which == 0 ? __builtin_shufflevector(x, zero, 4, 8, 5, 8, 6, 8, 7, 8)
                                    : __builtin_shufflevector(x, zero, 8, 4, 8, 5, 8, 6, 8, 7);
      storeEight(to + number, loadEight(to + number) + low);
      storeEight(to + number + 8, loadEight(to + number + 8) + high);
    });
  }
}

void FftConvolution::unpack(const std::array<LayerSolve*, 2>& pair, const float* from) const {
  for (std::size_t which = 0; which < 2; ++which) {
    if (!pair[which]) continue;
    overEights(*pair[which], [&](std::size_t node, std::size_t number) {
      const Eight low = loadEight(from + number), high = loadEight(from + number + 8);
      storeEight(pair[which]->product() + node, which == 0 ? __builtin_shufflevector(low, high, 0, 2, 4, 6, 8, 10, 12, 14)
                                                           : __builtin_shufflevector(low, high, 1, 3, 5, 7, 9, 11, 13, 15));
    });
  }
}

void FftConvolution::operator()(const std::array<LayerSolve*, 2>& pair, Arrays& arrays) const {
  const auto size = 2 * static_cast<std::size_t>(rows_) * static_cast<std::size_t>(cols_);
  if (arrays.padded_for != this) std::fill_n(arrays.b.get(), size, 0.0f);
  arrays.padded_for = this;
  pack(pair, arrays.a.get());
  fftwf_execute_dft(plans_[0], complexOf(arrays.a), complexOf(arrays.b));
  fftwf_execute_dft(plans_[1], complexOf(arrays.b), complexOf(arrays.c));
  float* c = arrays.c.get();
  for (std::size_t k = 0; k < size; ++k) c[k] *= spectrum_[k];
  fftwf_execute_dft(plans_[2], complexOf(arrays.c), complexOf(arrays.d));
  fftwf_execute_dft(plans_[3], complexOf(arrays.d), complexOf(arrays.a));
  unpack(pair, arrays.a.get());
}

}  // namespace taxelsim::bench
