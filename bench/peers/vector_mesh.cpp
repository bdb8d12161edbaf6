#include "peers/vector_mesh.h"

#include <algorithm>
#include <array>
#include <bit>
#include <numeric>

namespace taxelsim::bench {
namespace {

using Box = std::array<float, 6>;  // m: min x, y, z, max x, y, z

constexpr std::size_t kTopBoxes = 4 * kLanes;  // largest number of boxes of the top level
constexpr int kMostInLanes = 16;               // largest number of samples in the box of a small triangle
// In sample spacings, a few roundings of a float: a sample this close to a triangle counts as inside, so that none falls between two.
constexpr float kRim = 1e-5f;
constexpr float kFlat = 1e-9f;  // in sample spacings squared: smaller triangles are seen edge-on
constexpr float kFar = 1e30f;
constexpr Box kNothing{kFar, kFar, kFar, -kFar, -kFar, -kFar};

void extend(Box& box, const Box& other) {
  for (std::size_t k = 0; k < 3; ++k) {
    box[k] = std::min(box[k], other[k]);
    box[3 + k] = std::max(box[3 + k], other[3 + k]);
  }
}

// Sorts triangles so that every aligned run of 16, 256, ... of them is compact.
struct Order {
  const std::vector<std::array<float, 3>>& middles;
  std::vector<std::uint32_t>& triangles;

  void split(std::size_t begin, std::size_t end) const {
    const std::size_t count = end - begin;
    if (count <= kLanes) return;
    std::size_t run = kLanes;
    while (run * kLanes < count) run *= kLanes;
    Box box = kNothing;
    for (std::size_t k = begin; k < end; ++k) {
      const auto& [x, y, z] = middles[triangles[k]];
      extend(box, {x, y, z, x, y, z});
    }
    std::size_t axis = 0;
    for (std::size_t k = 1; k < 3; ++k)
      if (box[3 + k] - box[k] > box[3 + axis] - box[axis]) axis = k;
    const std::size_t middle = begin + std::max<std::size_t>(1, count / 2 / run) * run;
    const auto place = [&](std::size_t k) { return triangles.begin() + static_cast<std::ptrdiff_t>(k); };
    std::nth_element(place(begin), place(middle), place(end),
                     [&](std::uint32_t a, std::uint32_t b) { return middles[a][axis] < middles[b][axis]; });
    split(begin, middle);
    split(middle, end);
  }
};

// Sixteen triangles in sample coordinates.
struct Triangles {
  Floats u[3], v[3], z[3];  // corners
  Floats low_u, high_u, low_v, high_v, low_z;
  Floats area;                            // twice the signed area
  Ints first_u, last_u, first_v, last_v;  // samples in each triangle's box
  Ints active;                            // mask of the triangles that may cover a sample under the skin's surface
};

// False if no triangle of the pack may cover a sample.
bool project(const Floats (&x)[3], const Floats (&y)[3], const Floats (&z)[3], const SampleView& view, Triangles& t) {
  for (int c = 0; c < 3; ++c) t.z[c] = x[c] * view.z[0] + y[c] * view.z[1] + z[c] * view.z[2] + view.z[3];
  t.low_z = smaller(t.z[0], smaller(t.z[1], t.z[2]));
  const Ints under = t.low_z < Floats{};
  if (bitsOf(under) == 0) return false;
  for (int c = 0; c < 3; ++c) {
    t.u[c] = x[c] * view.u[0] + y[c] * view.u[1] + z[c] * view.u[2] + view.u[3];
    t.v[c] = x[c] * view.v[0] + y[c] * view.v[1] + z[c] * view.v[2] + view.v[3];
  }
  t.low_u = smaller(t.u[0], smaller(t.u[1], t.u[2])), t.high_u = larger(t.u[0], larger(t.u[1], t.u[2]));
  t.low_v = smaller(t.v[0], smaller(t.v[1], t.v[2])), t.high_v = larger(t.v[0], larger(t.v[1], t.v[2]));
  t.first_u = larger(ceilOf(t.low_u - kRim), Ints{}), t.last_u = smaller(floorOf(t.high_u + kRim), all(view.num_u - 1));
  t.first_v = larger(ceilOf(t.low_v - kRim), Ints{}), t.last_v = smaller(floorOf(t.high_v + kRim), all(view.num_v - 1));
  t.active = under & (t.first_u <= t.last_u) & (t.first_v <= t.last_v);
  if (bitsOf(t.active) == 0) return false;
  t.area = (t.u[1] - t.u[0]) * (t.v[2] - t.v[0]) - (t.v[1] - t.v[0]) * (t.u[2] - t.u[0]);
  t.active &= (t.area > kFlat) | (t.area < -kFlat);
  return true;
}

// Rasters one large triangle: sixteen samples of a taxel at once.
void drawLarge(const Triangles& t, std::size_t lane, int num_cols, Floats* tile) {
  const std::array<float, 3> u{t.u[0][lane], t.u[1][lane], t.u[2][lane]}, v{t.v[0][lane], t.v[1][lane], t.v[2][lane]};
  const std::array<float, 3> z{t.z[0][lane], t.z[1][lane], t.z[2][lane]};
  const int first_u = t.first_u[lane], last_u = t.last_u[lane], first_v = t.first_v[lane], last_v = t.last_v[lane];
  const float sign = (u[1] - u[0]) * (v[2] - v[0]) - (v[1] - v[0]) * (u[2] - u[0]) < 0 ? -1.0f : 1.0f;
  const auto [low, high] = std::minmax({z[0], z[1], z[2]});
  const float size = *std::max_element(u.begin(), u.end()) - *std::min_element(u.begin(), u.end()) + *std::max_element(v.begin(), v.end()) -
                     *std::min_element(v.begin(), v.end());
  const float rim = -kRim * size;
  for (int row = first_u / kSide; row <= last_u / kSide; ++row) {
    for (int col = first_v / kSide; col <= last_v / kSide; ++col) {
      const Floats pu = kLaneU + static_cast<float>(kSide * row), pv = kLaneV + static_cast<float>(kSide * col);
      const Floats u0 = u[0] - pu, u1 = u[1] - pu, u2 = u[2] - pu, v0 = v[0] - pv, v1 = v[1] - pv, v2 = v[2] - pv;
      const Floats w0 = (u1 * v2 - v1 * u2) * sign, w1 = (u2 * v0 - v2 * u0) * sign, w2 = (u0 * v1 - v0 * u1) * sign;
      const Ints inside = smaller(w0, smaller(w1, w2)) >= rim;
      const Floats height = smaller(larger((w0 * z[0] + w1 * z[1] + w2 * z[2]) / (w0 + w1 + w2), all(low)), all(high));
      Floats& taxel = tile[row * num_cols + col];
      taxel = smaller(taxel, select(inside, height, taxel));
    }
  }
}

// Rasters the active triangles, all small: sixteen triangles at once, sample by sample of their boxes.
void drawSmall(const Triangles& t, int num_cols, Floats* tile) {
  const Floats high_z = larger(t.z[0], larger(t.z[1], t.z[2]));
  const Floats sign = select(t.area < Floats{}, all(-1.0f), all(1.0f));
  const Floats rim = (t.high_u - t.low_u + t.high_v - t.low_v) * -kRim;
  const Floats inverse_area = sign / t.area;
  Ints active = t.active, pu = t.first_u, pv = t.first_v;
  for (unsigned todo = bitsOf(active); todo; todo = bitsOf(active)) {
    const Floats fu = toFloats(pu), fv = toFloats(pv);
    const Floats u0 = t.u[0] - fu, u1 = t.u[1] - fu, u2 = t.u[2] - fu, v0 = t.v[0] - fv, v1 = t.v[1] - fv, v2 = t.v[2] - fv;
    const Floats w0 = (u1 * v2 - v1 * u2) * sign, w1 = (u2 * v0 - v2 * u0) * sign, w2 = (u0 * v1 - v0 * u1) * sign;
    const Ints inside = active & (smaller(w0, smaller(w1, w2)) >= rim);
    unsigned bits = bitsOf(inside);
    if (bits) {
      const Floats height = smaller(larger((w0 * t.z[0] + w1 * t.z[1] + w2 * t.z[2]) * inverse_area, t.low_z), high_z);
      const Ints place = (((pu >> 2) * num_cols + (pv >> 2)) << 4) + ((pu & 3) << 2) + (pv & 3);
      alignas(64) float heights[kLanes];
      alignas(64) std::int32_t places[kLanes];
      store(heights, height);
      std::memcpy(places, &place, sizeof place);
      float* samples = reinterpret_cast<float*>(tile);
      for (; bits; bits &= bits - 1) {
        const auto lane = static_cast<std::size_t>(std::countr_zero(bits));
        float& sample = samples[places[lane]];
        sample = std::min(sample, heights[lane]);
      }
    }
    const Ints ends = pv >= t.last_v;
    pu -= ends;
    pv = select(ends, t.first_v, pv + 1);
    active &= pu <= t.last_u;
  }
}

}  // namespace

VectorMesh::VectorMesh(const Mesh& mesh) {
  const std::size_t num_triangles = mesh.triangles.size();
  std::vector<std::array<float, 3>> middles(num_triangles);
  std::vector<std::uint32_t> order(num_triangles);
  std::iota(order.begin(), order.end(), 0u);
  for (std::size_t t = 0; t < num_triangles; ++t)
    for (std::size_t k = 0; k < 3; ++k)
      for (const std::uint32_t corner : mesh.triangles[t]) middles[t][k] += mesh.vertices[corner][k] / 3;
  Order{middles, order}.split(0, num_triangles);

  const std::size_t num_packs = (num_triangles + kLanes - 1) / kLanes;
  packs_.resize(num_packs);
  std::vector<Box> boxes(num_packs, kNothing);
  for (std::size_t k = 0; k < num_packs * kLanes; ++k) {
    // Pads the last pack with its last triangle.
    const auto& corners = mesh.triangles[order[std::min(k, num_triangles - 1)]];
    Pack& pack = packs_[k / kLanes];
    for (std::size_t c = 0; c < 3; ++c) {
      const auto& [x, y, z] = mesh.vertices[corners[c]];
      setLane(pack.x[c], k % kLanes, x);
      setLane(pack.y[c], k % kLanes, y);
      setLane(pack.z[c], k % kLanes, z);
      extend(boxes[k / kLanes], {x, y, z, x, y, z});
    }
  }
  while (true) {
    addBoxes(levels_.emplace_back(), boxes);
    if (boxes.size() <= kTopBoxes) return;
    std::vector<Box> above((boxes.size() + kLanes - 1) / kLanes, kNothing);
    for (std::size_t k = 0; k < boxes.size(); ++k) extend(above[k / kLanes], boxes[k]);
    boxes = std::move(above);
  }
}

void VectorMesh::addBoxes(std::vector<Boxes>& level, const std::vector<Box>& boxes) const {
  level.resize((boxes.size() + kLanes - 1) / kLanes);
  for (std::size_t k = 0; k < level.size() * kLanes; ++k) {
    Boxes& sixteen = level[k / kLanes];
    const std::size_t lane = k % kLanes;
    // Pads with an inverted box, which overlaps nothing.
    const Box& box = k < boxes.size() ? boxes[k] : Box{1, 1, 1, -1, -1, -1};
    setLane(sixteen.x, lane, (box[0] + box[3]) / 2);
    setLane(sixteen.y, lane, (box[1] + box[4]) / 2);
    setLane(sixteen.z, lane, (box[2] + box[5]) / 2);
    // Covers the rounding of the middle.
    constexpr float kMore = 1 + 1e-6f;
    setLane(sixteen.half_x, lane, k < boxes.size() ? (box[3] - box[0]) / 2 * kMore + 1e-9f : -kFar);
    setLane(sixteen.half_y, lane, k < boxes.size() ? (box[4] - box[1]) / 2 * kMore + 1e-9f : -kFar);
    setLane(sixteen.half_z, lane, k < boxes.size() ? (box[5] - box[2]) / 2 * kMore + 1e-9f : -kFar);
  }
}

VectorMesh::Scratch VectorMesh::scratch(const TaxelStage& stage) const {
  Scratch scratch;
  scratch.tile.resize(static_cast<std::size_t>(stage.numTaxels()));
  scratch.packs.resize(packs_.size() + kLanes);
  scratch.groups.resize(packs_.size() + kLanes);
  return scratch;
}

// Lists in scratch.packs the packs whose boxes lie partly below the skin's surface and over a sample, and their number in
// scratch.groups[0]. Returns the taxels under these boxes.
TaxelRange VectorMesh::cull(const SampleView& view, Scratch& scratch) const {
  const auto magnitude = [](float value) { return value < 0 ? -value : value; };
  const Ints last_sample_u = all(view.num_u - 1), last_sample_v = all(view.num_v - 1);
  Ints low_u = last_sample_u + 1, high_u = all(-1), low_v = last_sample_v + 1, high_v = all(-1);
  std::uint32_t *from = scratch.groups.data(), *to = scratch.packs.data();
  std::size_t count = levels_.back().size();
  for (std::size_t k = 0; k < count; ++k) from[k] = static_cast<std::uint32_t>(k);
  for (std::size_t level = levels_.size(); level-- > 0;) {
    std::size_t kept = 0;
    for (std::size_t k = 0; k < count; ++k) {
      const Boxes& b = levels_[level][from[k]];
      const Floats z = b.x * view.z[0] + b.y * view.z[1] + b.z * view.z[2] + view.z[3];
      const Floats half_z = b.half_x * magnitude(view.z[0]) + b.half_y * magnitude(view.z[1]) + b.half_z * magnitude(view.z[2]);
      Ints live = z < half_z;
      if (bitsOf(live) == 0) continue;
      const Floats u = b.x * view.u[0] + b.y * view.u[1] + b.z * view.u[2] + view.u[3];
      const Floats v = b.x * view.v[0] + b.y * view.v[1] + b.z * view.v[2] + view.v[3];
      const Floats half_u = b.half_x * magnitude(view.u[0]) + b.half_y * magnitude(view.u[1]) + b.half_z * magnitude(view.u[2]) + kRim;
      const Floats half_v = b.half_x * magnitude(view.v[0]) + b.half_y * magnitude(view.v[1]) + b.half_z * magnitude(view.v[2]) + kRim;
      const Ints first_u = larger(ceilOf(u - half_u), Ints{}), last_u = smaller(floorOf(u + half_u), last_sample_u);
      const Ints first_v = larger(ceilOf(v - half_v), Ints{}), last_v = smaller(floorOf(v + half_v), last_sample_v);
      live &= (first_u <= last_u) & (first_v <= last_v);
      if (level == 0) {
        low_u = select(live, smaller(low_u, first_u), low_u);
        high_u = select(live, larger(high_u, last_u), high_u);
        low_v = select(live, smaller(low_v, first_v), low_v);
        high_v = select(live, larger(high_v, last_v), high_v);
      }
      for (unsigned bits = bitsOf(live); bits; bits &= bits - 1)
        to[kept++] = from[k] * kLanes + static_cast<std::uint32_t>(std::countr_zero(bits));
    }
    std::swap(from, to);
    count = kept;
  }
  if (from != scratch.packs.data()) std::swap(scratch.packs, scratch.groups);
  scratch.groups[0] = static_cast<std::uint32_t>(count);
  if (count == 0) return {};
  return {static_cast<int>(smallestOf(toFloats(low_u))) / kSide, static_cast<int>(largestOf(toFloats(high_u))) / kSide,
          static_cast<int>(smallestOf(toFloats(low_v))) / kSide, static_cast<int>(largestOf(toFloats(high_v))) / kSide};
}

TaxelRange VectorMesh::press(const SampleView& view, const TaxelStage& stage, Scratch& scratch, TaxelStage::Scratch& taxels) const {
  const TaxelRange range = cull(view, scratch);
  const std::uint32_t num_packs = scratch.groups[0];
  if (num_packs == 0) return {};
  const int num_cols = stage.numCols();
  Floats* tile = scratch.tile.data();
  for (int row = range.first_row; row <= range.last_row; ++row)
    for (int col = range.first_col; col <= range.last_col; ++col) tile[row * num_cols + col] = Floats{};

  for (std::uint32_t k = 0; k < num_packs; ++k) {
    const Pack& pack = packs_[scratch.packs[k]];
    Triangles t;
    if (!project(pack.x, pack.y, pack.z, view, t)) continue;
    const Ints large = t.active & ((t.last_u - t.first_u + 1) * (t.last_v - t.first_v + 1) > kMostInLanes);
    for (unsigned bits = bitsOf(large); bits; bits &= bits - 1)
      drawLarge(t, static_cast<std::size_t>(std::countr_zero(bits)), num_cols, tile);
    t.active &= ~large;
    drawSmall(t, num_cols, tile);
  }

  TaxelSums sums(stage, taxels);
  for (int row = range.first_row; row <= range.last_row; ++row)
    for (int col = range.first_col; col <= range.last_col; ++col) sums.add(row, col, tile[row * num_cols + col]);
  return range;
}

}  // namespace taxelsim::bench
