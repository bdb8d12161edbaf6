#include "peers/layer_solve.h"

#include <algorithm>
#include <bit>
#include <cmath>

#include "peers/lanes.h"

namespace taxelsim::bench {
namespace {

constexpr float kFitting = 0.25f;  // as in shaders/elastic_layer/initial_guess.glsl

// Calls `work(place)` for every vector of the parts, `place` an index into padded arrays.
template <typename Work>
inline void overParts(const LayerGrid& grid, const std::vector<RowPart>& parts, const Work& work) {
  for (const RowPart& part : parts) {
    const std::size_t first = grid.at(part.row, part.first);
    for (int k = 0; k < part.num_vectors; ++k) work(first + static_cast<std::size_t>(k * kLanes));
  }
}

inline Floats where(Ints mask, Floats value) {
  return select(mask, value, Floats{});
}

}  // namespace

LayerGrid::LayerGrid(int rows, int cols) : num_rows(rows), num_cols(cols), stride((cols + kLanes - 1) / kLanes * kLanes + kLanes) {}

float partsInReach(const LayerGrid& grid, const float* overlaps, float reach, std::vector<RowPart>& parts, LayerWindow& window) {
  parts.clear();
  window = {grid.num_rows, 0, grid.num_cols, 0};
  Floats largest = all(kNoOverlap);
  for (std::size_t k = 0; k < grid.size(); k += kLanes) largest = larger(largest, load(overlaps + k));
  const float deepest = largestOf(largest);
  if (deepest <= 0) return deepest;
  const Floats limit = all(-reach * deepest);
  for (int row = 0; row < grid.num_rows; ++row) {
    int first = grid.stride, end = 0;
    for (int col = 0; col < grid.num_cols; col += kLanes) {
      const unsigned touched = bitsOf(load(overlaps + grid.at(row, col)) > limit);
      if (touched == 0) continue;
      first = std::min(first, col + std::countr_zero(touched));
      end = col + std::bit_width(touched);
    }
    if (end == 0) continue;
    parts.push_back({row, first, (end - first + kLanes - 1) / kLanes});
    window = {std::min(window.first_row, row), row + 1, std::min(window.first_col, first), std::max(window.end_col, end)};
  }
  return deepest;
}

LayerSolve::LayerSolve(const LayerGrid& grid, const LayerLimits& limits)
    : grid_(grid),
      limits_(limits),
      overlap_(grid.size(), kNoOverlap),
      r_(grid.size(), 0),
      t_(grid.size(), 0),
      change_(grid.size(), 0),
      product_(grid.size(), 0) {}

bool LayerSolve::begin(const float* overlaps, float* pressures, bool cold) {
  x_ = pressures;
  iteration_ = 0;
  residual_ = 0;
  before_ = 0;
  deepest_ = partsInReach(grid_, overlaps, limits_.reach, parts_, window_);
  if (parts_.empty()) {
    std::fill(x_, x_ + grid_.size(), 0.0f);
    return false;
  }
  const Floats limit = all(-limits_.reach * deepest_);
  overParts(grid_, parts_, [&](std::size_t k) {
    const Floats d = load(overlaps + k);
    const Ints touched = d > limit;
    store(overlap_.data() + k, select(touched, d, all(kNoOverlap)));
    store(t_.data() + k, where(touched, load(x_ + k)));  // the pressures before, until they are copied
  });
  std::fill(x_, x_ + grid_.size(), 0.0f);
  overParts(grid_, parts_, [&](std::size_t k) { store(x_ + k, load(t_.data() + k)); });
  if (cold || !fits(deepest_)) {
    const float above = limits_.beyond_contact * deepest_;
    overParts(grid_, parts_, [&](std::size_t k) { store(x_ + k, larger(load(overlap_.data() + k) - above, Floats{})); });
  }
  overParts(grid_, parts_, [&](std::size_t k) {
    store(t_.data() + k, Floats{});
    store(change_.data() + k, Floats{});
  });
  stage_ = Stage::kGuess;
  input_ = x_;
  return true;
}

// Whether the pressures of the frame before fit: the mean overlap under them.
bool LayerSolve::fits(float deepest) const {
  Floats work{}, sum{};
  overParts(grid_, parts_, [&](std::size_t k) {
    const Floats x = load(x_ + k);
    work += x * load(overlap_.data() + k);
    sum += x;
  });
  const float total = sumOf(sum);
  return total > 0 && sumOf(work) > kFitting * deepest * total;
}

bool LayerSolve::advance() {
  switch (stage_) {
    case Stage::kGuess:
      scaleGuess();
      return check();
    case Stage::kDirection:
      if (takeStep()) {
        stage_ = Stage::kCorrection;
        input_ = change_.data();
        return true;
      }
      return check();
    case Stage::kCorrection:
      correct();
      return check();
  }
  return false;
}

// Scales the first pressures so that the energy along them is least.
void LayerSolve::scaleGuess() {
  Floats work{}, energy{};
  overParts(grid_, parts_, [&](std::size_t k) {
    const Floats x = load(x_ + k);
    work += x * load(overlap_.data() + k);
    energy += x * load(product_.data() + k);
  });
  const float factor = std::max(sumOf(work), 0.0f) / std::max(sumOf(energy), 1e-30f);
  overParts(grid_, parts_, [&](std::size_t k) {
    store(x_ + k, factor * load(x_ + k));
    store(r_.data() + k, factor * load(product_.data() + k) - load(overlap_.data() + k));
  });
}

// The step along t, with the nodes that it releases and presses. Returns whether there are any: the change needs a product.
bool LayerSolve::takeStep() {
  Floats curvature{};
  overParts(grid_, parts_, [&](std::size_t k) { curvature += load(product_.data() + k) * load(t_.data() + k); });
  const float sum = sumOf(curvature), step = sum > 0 ? std::max(slope_ / sum, 0.0f) : 0.0f, press = step > 0 ? step : 1.0f;
  Ints changed{}, pressed{};
  overParts(grid_, parts_, [&](std::size_t k) {
    const Floats r = load(r_.data() + k), plain = load(x_ + k) - step * load(t_.data() + k);
    const Floats entering = select(plain > Floats{}, Floats{}, larger(-r, Floats{}));
    const Floats x = larger(plain, Floats{}) + press * entering;
    const Floats change = x - plain;
    changed |= change > Floats{};
    pressed |= entering > Floats{};
    store(x_ + k, x);
    store(change_.data() + k, change);
    store(r_.data() + k, r - step * load(product_.data() + k));
  });
  if (bitsOf(pressed) != 0) before_ = 0;
  return bitsOf(changed) != 0;
}

void LayerSolve::correct() {
  overParts(grid_, parts_, [&](std::size_t k) { store(r_.data() + k, load(r_.data() + k) + load(product_.data() + k)); });
}

// The residual; if it is too large, the next direction.
bool LayerSolve::check() {
  Floats inside{}, outside{}, number{};
  overParts(grid_, parts_, [&](std::size_t k) {
    const Floats r = load(r_.data() + k);
    const Ints pressed = load(x_ + k) > Floats{};
    const Floats in = where(pressed, r), out = select(pressed, Floats{}, smaller(r, Floats{}));
    inside += in * in;
    outside += out * out;
    number += where(pressed, all(1.0f));
  });
  const float squares = sumOf(inside);
  residual_ = std::sqrt((squares + sumOf(outside)) / std::max(sumOf(number), 1.0f)) / deepest_;
  if (residual_ <= limits_.tolerance || iteration_ >= limits_.max_iterations) return false;
  ++iteration_;
  const float beta = before_ > 0 ? squares / before_ : 0;
  before_ = squares;
  Floats slope{};
  overParts(grid_, parts_, [&](std::size_t k) {
    const Ints pressed = load(x_ + k) > Floats{};
    const Floats r = where(pressed, load(r_.data() + k));
    const Floats t = r + where(pressed, beta * load(t_.data() + k));
    store(t_.data() + k, t);
    slope += r * t;
  });
  slope_ = sumOf(slope);
  stage_ = Stage::kDirection;
  input_ = t_.data();
  return true;
}

}  // namespace taxelsim::bench
