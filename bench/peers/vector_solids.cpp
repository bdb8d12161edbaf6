#include "peers/vector_solids.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>

namespace taxelsim::bench {
namespace {

constexpr float kUpright = 1e-7f;  // smallest deviation of a face or an axis from the vertical
constexpr float kFar = 1e30f;

// Taxels under a box of O; none if the box lies above the skin.
TaxelRange taxelsUnder(const Bounds& box, const SampleView& view, const TaxelStage& stage) {
  const auto rangeOf = [&](const std::array<float, 4>& row) {
    float middle = row[3], half = 0;
    for (std::size_t k = 0; k < 3; ++k) {
      middle += row[k] * static_cast<float>((box.min[k] + box.max[k]) / 2);
      half += std::abs(row[k]) * static_cast<float>((box.max[k] - box.min[k]) / 2);
    }
    return std::array<float, 2>{middle - half, middle + half};
  };
  if (rangeOf(view.z)[0] >= 0) return {};
  const auto [low_u, high_u] = rangeOf(view.u);
  const auto [low_v, high_v] = rangeOf(view.v);
  const auto first = [](float low) { return std::max(0, static_cast<int>(std::ceil(low))) / kSide; };
  const auto last = [](float high, int count) {
    return static_cast<int>(std::floor(std::min(high, static_cast<float>(count - 1)) / kSide));
  };
  return {first(low_u), std::min(last(high_u, view.num_u), stage.numRows() - 1), first(low_v),
          std::min(last(high_v, view.num_v), stage.numCols() - 1)};
}

// Calls `sixteen(u, v)` for the middles of sixteen taxels of a row, then `one(row, col)` for each taxel of its mask. Returns the range.
template <typename Sixteen, typename One>
TaxelRange forTaxels(const TaxelRange& range, const Sixteen& sixteen, const One& one) {
  TaxelRange touched{range.last_row + 1, range.first_row - 1, range.first_col, range.last_col};
  for (int row = range.first_row; row <= range.last_row; ++row) {
    for (int first = range.first_col; first <= range.last_col; first += kLanes) {
      const Floats v = (kCount + static_cast<float>(first)) * static_cast<float>(kSide) + kHalfTaxel;
      unsigned kept = bitsOf(sixteen(static_cast<float>(kSide * row) + kHalfTaxel, v));
      const int count = range.last_col - first + 1;
      if (count < kLanes) kept &= (1u << count) - 1;
      if (!kept) continue;
      touched.first_row = std::min(touched.first_row, row);
      touched.last_row = row;
      for (; kept; kept &= kept - 1) one(row, first + std::countr_zero(kept));
    }
  }
  return touched;
}

}  // namespace

VectorPolyhedron::VectorPolyhedron(const std::vector<Face>& faces, const Bounds& bounds)
    : faces_((1u << faces.size()) - 1), bounds_(bounds) {
  for (std::size_t k = 0; k < faces.size(); ++k) {
    setLane(normal_x_, k, static_cast<float>(faces[k].normal[0]));
    setLane(normal_y_, k, static_cast<float>(faces[k].normal[1]));
    setLane(normal_z_, k, static_cast<float>(faces[k].normal[2]));
    setLane(offset_, k, static_cast<float>(faces[k].offset));
  }
}

TaxelRange VectorPolyhedron::press(const SampleView& view, const TaxelStage& stage, TaxelStage::Scratch& taxels) const {
  const TaxelRange range = taxelsUnder(bounds_, view, stage);
  if (range.first_row > range.last_row || range.first_col > range.last_col) return {};

  // Height of every face's plane: a u + b v + c. A line enters the body at the highest downward face and leaves it at the lowest upward
  // face.
  const std::array<float, 9>& R = view.R;
  const Floats nx = normal_x_ * R[0] + normal_y_ * R[1] + normal_z_ * R[2];
  const Floats ny = normal_x_ * R[3] + normal_y_ * R[4] + normal_z_ * R[5];
  Floats nz = normal_x_ * R[6] + normal_y_ * R[7] + normal_z_ * R[8];
  const Floats offset = offset_ + nx * (view.p[0] - view.first_x) + ny * (view.p[1] - view.first_y) + nz * view.p[2];
  nz = select((nz < kUpright) & (nz > -kUpright), all(kUpright), nz);
  const Floats per_nz = 1.0f / nz;
  const Floats a = nx * per_nz * -view.pitch_u, b = ny * per_nz * -view.pitch_v, c = offset * per_nz;
  const Floats slack = (larger(a, -a) + larger(b, -b)) * kHalfTaxel;
  const unsigned down = bitsOf(nz < Floats{}) & faces_, up = faces_ & ~down;

  const auto sixteen = [&](float u, Floats v) {
    Floats enter = all(-kFar), leave = all(kFar);
    for (unsigned bits = down; bits; bits &= bits - 1) {
      const auto f = static_cast<std::size_t>(std::countr_zero(bits));
      enter = larger(enter, v * b[f] + (c[f] - slack[f] + a[f] * u));
    }
    for (unsigned bits = up; bits; bits &= bits - 1) {
      const auto f = static_cast<std::size_t>(std::countr_zero(bits));
      leave = smaller(leave, v * b[f] + (c[f] + slack[f] + a[f] * u));
    }
    return (enter < Floats{}) & (enter <= leave);
  };
  std::array<Floats, kMaxFaces> across;
  for (unsigned bits = faces_; bits; bits &= bits - 1) {
    const auto f = static_cast<std::size_t>(std::countr_zero(bits));
    across[f] = kLaneU * a[f] + kLaneV * b[f] + c[f];
  }
  TaxelSums sums(stage, taxels);
  const auto one = [&](int row, int col) {
    const auto u = static_cast<float>(kSide * row), v = static_cast<float>(kSide * col);
    Floats enter = all(-kFar), leave = all(kFar);
    for (unsigned bits = down; bits; bits &= bits - 1) {
      const auto f = static_cast<std::size_t>(std::countr_zero(bits));
      enter = larger(enter, across[f] + (a[f] * u + b[f] * v));
    }
    for (unsigned bits = up; bits; bits &= bits - 1) {
      const auto f = static_cast<std::size_t>(std::countr_zero(bits));
      leave = smaller(leave, across[f] + (a[f] * u + b[f] * v));
    }
    sums.add(row, col, select(enter <= leave, enter, Floats{}));
  };
  return forTaxels(range, sixteen, one);
}

VectorCylinder::VectorCylinder(const Cylinder& cylinder)
    : radius_(static_cast<float>(cylinder.radius)), half_length_(static_cast<float>(cylinder.length / 2)), bounds_(boundsOf(cylinder)) {}

TaxelRange VectorCylinder::press(const SampleView& view, const TaxelStage& stage, TaxelStage::Scratch& taxels) const {
  const TaxelRange range = taxelsUnder(bounds_, view, stage);
  if (range.first_row > range.last_row || range.first_col > range.last_col) return {};

  // A sample's line in O: start, affine in u and v, and direction, z of S.
  const std::array<float, 9>& R = view.R;
  const float x = view.first_x - view.p[0], y = view.first_y - view.p[1], z = -view.p[2];
  std::array<float, 3> start, along_u, along_v, direction;
  for (std::size_t k = 0; k < 3; ++k) {
    start[k] = R[k] * x + R[3 + k] * y + R[6 + k] * z;
    along_u[k] = R[k] * view.pitch_u;
    along_v[k] = R[3 + k] * view.pitch_v;
    direction[k] = R[6 + k];
  }
  const float square = std::max(direction[0] * direction[0] + direction[1] * direction[1], kUpright * kUpright);
  const float along = std::abs(direction[2]) < kUpright ? kUpright : direction[2];
  const float per_square = 1 / square, per_along = 1 / along;
  const auto height = [&](Floats ox, Floats oy, Floats oz, float radius, float half_length) {
    const Floats middle = ox * direction[0] + oy * direction[1];
    const Floats inside = middle * middle - (ox * ox + oy * oy - radius * radius) * square;
    const Floats root = rootOf(larger(inside, Floats{}));
    const Floats end = oz * -per_along;
    const float half_end = half_length * std::abs(per_along);
    const Floats enter = larger((-middle - root) * per_square, end - half_end);
    const Floats leave = smaller((root - middle) * per_square, end + half_end);
    return select((inside >= Floats{}) & (enter <= leave), enter, all(kFar));
  };
  // Culls a taxel if its middle misses a cylinder enlarged by half the taxel's diagonal.
  const float more = kHalfTaxel * std::hypot(view.pitch_u, view.pitch_v);
  const auto sixteen = [&](float u, Floats v) {
    return height(v * along_v[0] + (start[0] + along_u[0] * u), v * along_v[1] + (start[1] + along_u[1] * u),
                  v * along_v[2] + (start[2] + along_u[2] * u), radius_ + more, half_length_ + more) < Floats{};
  };
  Floats across[3];
  for (std::size_t k = 0; k < 3; ++k) across[k] = kLaneU * along_u[k] + kLaneV * along_v[k] + start[k];
  TaxelSums sums(stage, taxels);
  const auto one = [&](int row, int col) {
    const auto u = static_cast<float>(kSide * row), v = static_cast<float>(kSide * col);
    sums.add(row, col,
             height(across[0] + (along_u[0] * u + along_v[0] * v), across[1] + (along_u[1] * u + along_v[1] * v),
                    across[2] + (along_u[2] * u + along_v[2] * v), radius_, half_length_));
  };
  return forTaxels(range, sixteen, one);
}

}  // namespace taxelsim::bench
