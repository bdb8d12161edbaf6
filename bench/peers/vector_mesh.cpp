#include "peers/vector_mesh.h"

#include <algorithm>
#include <array>
#include <bit>
#include <numeric>

namespace taxelsim::bench {
namespace {

using Box = std::array<float, 6>;  // min x, y, z, max x, y, z; m

constexpr std::size_t kTopBoxes = 4 * kLanes;  // at most so many boxes, and no further level
constexpr int kMostInLanes = 16;               // samples in a triangle's box; one with more is done by itself
// Samples so little beside a triangle count as inside, so that none falls between two; in sample distances, some roundings of a float.
constexpr float kRim = 1e-5f;
constexpr float kFlat = 1e-9f;  // twice the area, in sample distances squared, under which a triangle is an edge seen from below
constexpr float kFar = 1e30f;
constexpr Box kNothing{kFar, kFar, kFar, -kFar, -kFar, -kFar};

void extend(Box& box, const Box& other) {
  for (std::size_t k = 0; k < 3; ++k) {
    box[k] = std::min(box[k], other[k]);
    box[3 + k] = std::max(box[3 + k], other[3 + k]);
  }
}

// Orders triangles so that every run of 16, 256, ... that starts at a multiple of its length lies close together: halves at whole runs.
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

// All samples of one large triangle, taxel by taxel.
void drawLarge(const std::array<float, 3>& u, const std::array<float, 3>& v, const std::array<float, 3>& z, int num_cols, int first_u,
               int last_u, int first_v, int last_v, Floats* tile) {
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
    // The last pack is filled up with its last triangle.
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
    // Past the last, a box that is inside out and touches nothing.
    const Box& box = k < boxes.size() ? boxes[k] : Box{1, 1, 1, -1, -1, -1};
    setLane(sixteen.x, lane, (box[0] + box[3]) / 2);
    setLane(sixteen.y, lane, (box[1] + box[4]) / 2);
    setLane(sixteen.z, lane, (box[2] + box[5]) / 2);
    // A rounding more, so that no corner is outside.
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

// Packs whose boxes reach under the skin's surface and over a sample: left in scratch.packs, their number in groups[0]. Returns the taxels
// under these boxes.
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

  const Ints last_sample_u = all(view.num_u - 1), last_sample_v = all(view.num_v - 1);
  for (std::uint32_t k = 0; k < num_packs; ++k) {
    const Pack& pack = packs_[scratch.packs[k]];
    Floats u[3], v[3], z[3];
    for (int c = 0; c < 3; ++c) z[c] = pack.x[c] * view.z[0] + pack.y[c] * view.z[1] + pack.z[c] * view.z[2] + view.z[3];
    const Floats low_z = smaller(z[0], smaller(z[1], z[2]));
    const Ints under = low_z < Floats{};
    if (bitsOf(under) == 0) continue;
    for (int c = 0; c < 3; ++c) {
      u[c] = pack.x[c] * view.u[0] + pack.y[c] * view.u[1] + pack.z[c] * view.u[2] + view.u[3];
      v[c] = pack.x[c] * view.v[0] + pack.y[c] * view.v[1] + pack.z[c] * view.v[2] + view.v[3];
    }
    const Floats low_u = smaller(u[0], smaller(u[1], u[2])), high_u = larger(u[0], larger(u[1], u[2]));
    const Floats low_v = smaller(v[0], smaller(v[1], v[2])), high_v = larger(v[0], larger(v[1], v[2]));
    const Ints first_u = larger(ceilOf(low_u - kRim), Ints{}), last_u = smaller(floorOf(high_u + kRim), last_sample_u);
    const Ints first_v = larger(ceilOf(low_v - kRim), Ints{}), last_v = smaller(floorOf(high_v + kRim), last_sample_v);
    Ints active = under & (first_u <= last_u) & (first_v <= last_v);
    if (bitsOf(active) == 0) continue;

    const Floats area = (u[1] - u[0]) * (v[2] - v[0]) - (v[1] - v[0]) * (u[2] - u[0]);
    active &= (area > kFlat) | (area < -kFlat);
    const Ints large = active & ((last_u - first_u + 1) * (last_v - first_v + 1) > kMostInLanes);
    for (unsigned bits = bitsOf(large); bits; bits &= bits - 1) {
      const auto t = static_cast<std::size_t>(std::countr_zero(bits));
      drawLarge({u[0][t], u[1][t], u[2][t]}, {v[0][t], v[1][t], v[2][t]}, {z[0][t], z[1][t], z[2][t]}, num_cols, first_u[t], last_u[t],
                first_v[t], last_v[t], tile);
    }
    active &= ~large;

    // Sample by sample of every triangle's box, sixteen triangles in step.
    const Floats high_z = larger(z[0], larger(z[1], z[2]));
    const Floats sign = select(area < Floats{}, all(-1.0f), all(1.0f));
    const Floats rim = (high_u - low_u + high_v - low_v) * -kRim;
    const Floats inverse_area = sign / area;
    Ints pu = first_u, pv = first_v;
    for (unsigned todo = bitsOf(active); todo; todo = bitsOf(active)) {
      const Floats fu = toFloats(pu), fv = toFloats(pv);
      const Floats u0 = u[0] - fu, u1 = u[1] - fu, u2 = u[2] - fu, v0 = v[0] - fv, v1 = v[1] - fv, v2 = v[2] - fv;
      const Floats w0 = (u1 * v2 - v1 * u2) * sign, w1 = (u2 * v0 - v2 * u0) * sign, w2 = (u0 * v1 - v0 * u1) * sign;
      const Ints inside = active & (smaller(w0, smaller(w1, w2)) >= rim);
      unsigned bits = bitsOf(inside);
      if (bits) {
        const Floats height = smaller(larger((w0 * z[0] + w1 * z[1] + w2 * z[2]) * inverse_area, low_z), high_z);
        const Ints place = (((pu >> 2) * num_cols + (pv >> 2)) << 4) + ((pu & 3) << 2) + (pv & 3);
        alignas(64) float heights[kLanes];
        alignas(64) std::int32_t places[kLanes];
        store(heights, height);
        std::memcpy(places, &place, sizeof place);
        float* samples = reinterpret_cast<float*>(tile);
        for (; bits; bits &= bits - 1) {
          const auto t = static_cast<std::size_t>(std::countr_zero(bits));
          float& sample = samples[places[t]];
          sample = std::min(sample, heights[t]);
        }
      }
      const Ints ends = pv >= last_v;
      pu -= ends;
      pv = select(ends, first_v, pv + 1);
      active &= pu <= last_u;
    }
  }

  TaxelSums sums(stage, taxels);
  for (int row = range.first_row; row <= range.last_row; ++row)
    for (int col = range.first_col; col <= range.last_col; ++col) sums.add(row, col, tile[row * num_cols + col]);
  return range;
}

}  // namespace taxelsim::bench
