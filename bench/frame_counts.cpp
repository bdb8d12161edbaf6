#include "frame_counts.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "taxelsim/simulator.h"

namespace taxelsim::bench {
namespace {

using Corner = std::array<double, 3>;  // in samples along x and y from the first corner of the array; height over the skin, m

constexpr std::size_t kBatch = 64;  // frames computed at once

// One frame: the samples of a patch and of its margin.
struct Grid {
  int num_rows = 0, num_cols = 0;
  std::span<const float> values;  // (num_rows x num_cols)

  bool isTouched(int row, int col) const {
    return values[static_cast<std::size_t>(row) * static_cast<std::size_t>(num_cols) + static_cast<std::size_t>(col)] > 0;
  }
  bool hasUntouchedNeighbour(int row, int col) const {
    for (int r = std::max(row - 1, 0); r <= std::min(row + 1, num_rows - 1); ++r) {
      for (int c = std::max(col - 1, 0); c <= std::min(col + 1, num_cols - 1); ++c) {
        if (!isTouched(r, c)) return true;
      }
    }
    return false;
  }
};

double numTouched(const Grid& grid) {
  return static_cast<double>(std::count_if(grid.values.begin(), grid.values.end(), [](float value) { return value > 0; }));
}

// Samples that are touched in either grid.
double numInEither(const Grid& a, const Grid& b) {
  double count = 0;
  for (std::size_t k = 0; k < a.values.size(); ++k) count += a.values[k] > 0 || b.values[k] > 0;
  return count;
}

double numOnEdge(const Grid& grid) {
  double count = 0;
  for (int row = 0; row < grid.num_rows; ++row) {
    for (int col = 0; col < grid.num_cols; ++col) count += grid.isTouched(row, col) && grid.hasUntouchedNeighbour(row, col);
  }
  return count;
}

struct TaxelCounts {
  double touched = 0, spread = 0;
};

// `kernel`: taxels per side of the point spread.
TaxelCounts countTaxels(const Grid& grid, const LayerNodes& nodes, int num_rows, int num_cols, int kernel) {
  const int per_row = (nodes.num_rows - 2 * nodes.margin_rows) / num_rows, per_col = (nodes.num_cols - 2 * nodes.margin_cols) / num_cols;
  std::vector<char> touched(static_cast<std::size_t>(num_rows) * static_cast<std::size_t>(num_cols), 0), spread = touched;
  const auto at = [&](int i, int j) {
    return static_cast<std::size_t>(i) * static_cast<std::size_t>(num_cols) + static_cast<std::size_t>(j);
  };
  TaxelCounts counts;
  for (int row = 0; row < grid.num_rows; ++row) {
    for (int col = 0; col < grid.num_cols; ++col) {
      if (!grid.isTouched(row, col)) continue;
      const int u = row - nodes.margin_rows, v = col - nodes.margin_cols;
      if (u >= 0 && v >= 0 && u < per_row * num_rows && v < per_col * num_cols) touched[at(u / per_row, v / per_col)] = 1;
    }
  }
  const int radius = kernel / 2;
  for (int i = 0; i < num_rows; ++i) {
    for (int j = 0; j < num_cols; ++j) {
      if (touched[at(i, j)] == 0) continue;
      for (int a = std::max(i - radius, 0); a <= std::min(i + radius, num_rows - 1); ++a) {
        for (int b = std::max(j - radius, 0); b <= std::min(j + radius, num_cols - 1); ++b) spread[at(a, b)] = 1;
      }
    }
  }
  counts.touched = static_cast<double>(std::count(touched.begin(), touched.end(), 1));
  counts.spread = static_cast<double>(std::count(spread.begin(), spread.end(), 1));
  return counts;
}

// The part of a triangle below the skin's surface.
std::vector<Corner> partBelow(const std::array<Corner, 3>& triangle) {
  std::vector<Corner> part;
  for (std::size_t k = 0; k < 3; ++k) {
    const Corner &p = triangle[k], &q = triangle[(k + 1) % 3];
    if (p[2] < 0) part.push_back(p);
    if ((p[2] < 0) == (q[2] < 0)) continue;
    const double share = p[2] / (p[2] - q[2]);
    part.push_back({p[0] + share * (q[0] - p[0]), p[1] + share * (q[1] - p[1]), 0});
  }
  return part;
}

// Twice the area of the triangle seen from above; negative for one that looks down.
double areaOf(const std::array<Corner, 3>& t) {
  return (t[1][0] - t[0][0]) * (t[2][1] - t[0][1]) - (t[2][0] - t[0][0]) * (t[1][1] - t[0][1]);
}

// Whether a convex polygon, clockwise from above, has a part in the cell of the sample (row, col). Its bounding box does.
bool overlapsCell(std::span<const Corner> polygon, double row, double col) {
  for (std::size_t k = 0; k < polygon.size(); ++k) {
    const Corner &p = polygon[k], &q = polygon[(k + 1) % polygon.size()];
    const double along_x = q[0] - p[0], along_y = q[1] - p[1];
    if (along_x == 0 && along_y == 0) continue;
    // The corner of the cell that lies farthest on the inner side of the edge.
    const double x = along_y > 0 ? row + 1 : row, y = along_x > 0 ? col : col + 1;
    if (along_y * (x - p[0]) - along_x * (y - p[1]) <= 0) return false;
  }
  return true;
}

double numCells(std::span<const Corner> polygon, const LayerNodes& nodes) {
  std::array<double, 2> low{INFINITY, INFINITY}, high{-INFINITY, -INFINITY};
  for (const Corner& corner : polygon) {
    for (std::size_t axis = 0; axis < 2; ++axis)
      low[axis] = std::min(low[axis], corner[axis]), high[axis] = std::max(high[axis], corner[axis]);
  }
  double count = 0;
  for (int row = std::max(static_cast<int>(std::floor(low[0])), 0); row < nodes.num_rows && row < high[0]; ++row) {
    for (int col = std::max(static_cast<int>(std::floor(low[1])), 0); col < nodes.num_cols && col < high[1]; ++col) {
      count += overlapsCell(polygon, row, col);
    }
  }
  return count;
}

// Whether the bounding box of a triangle holds a sample.
bool isOverSample(const std::array<Corner, 3>& t) {
  bool is_over = true;
  for (std::size_t axis = 0; axis < 2; ++axis) {
    const auto [low, high] = std::minmax({t[0][axis], t[1][axis], t[2][axis]});
    is_over = is_over && std::ceil(low - 0.5) <= high - 0.5;
  }
  return is_over;
}

bool isOver(std::span<const Corner> polygon, const LayerNodes& nodes) {
  const auto [low_x, high_x] =
      std::minmax_element(polygon.begin(), polygon.end(), [](const Corner& a, const Corner& b) { return a[0] < b[0]; });
  const auto [low_y, high_y] =
      std::minmax_element(polygon.begin(), polygon.end(), [](const Corner& a, const Corner& b) { return a[1] < b[1]; });
  return (*high_x)[0] > 0 && (*low_x)[0] < nodes.num_rows && (*high_y)[1] > 0 && (*low_y)[1] < nodes.num_cols;
}

// What `output` of a simulator gives in every frame, (num_frames x num_taxels).
std::vector<float> computeFrames(const Device& device, const Sensor& sensor, const Object& object, std::span<const Pose> X_SO,
                                 const OutputOptions& outputs, std::span<const float> GroundTruthView::*output) {
  const std::size_t num_instances = std::min(kBatch, X_SO.size());
  Simulator simulator(Model(device, {.sensor = sensor, .objects = {object}}),
                      {.num_instances = static_cast<int>(num_instances), .outputs = outputs});
  const std::vector<int> ids(num_instances, 0);
  std::vector<float> values;
  for (std::size_t first = 0; first < X_SO.size(); first += num_instances) {
    std::vector<Pose> poses(num_instances, X_SO.back());
    const std::size_t count = std::min(num_instances, X_SO.size() - first);
    std::copy_n(X_SO.begin() + static_cast<std::ptrdiff_t>(first), count, poses.begin());
    for (std::size_t i = 0; i < num_instances; ++i) simulator.reset(static_cast<int>(i), 0);
    simulator.setObjects(ids, poses);
    simulator.step(1e-3);
    const std::span<const float> frames = simulator.read().ground_truth.*output;
    values.insert(values.end(), frames.begin(), frames.begin() + static_cast<std::ptrdiff_t>(count * frames.size() / num_instances));
  }
  return values;
}

}  // namespace

nlohmann::ordered_json toJson(const FrameCounts& counts) {
  return {{"taxels", counts.taxels},
          {"touched_taxels", counts.touched_taxels},
          {"spread_taxels", counts.spread_taxels},
          {"samples", counts.samples},
          {"touched_samples", counts.touched_samples},
          {"edge_samples", counts.edge_samples},
          {"triangles", counts.triangles},
          {"triangles_over_samples", counts.triangles_over_samples},
          {"facet_samples", counts.facet_samples},
          {"pressed_nodes", counts.pressed_nodes},
          {"products", counts.products},
          {"iterations", counts.iterations},
          {"regions", counts.regions},
          {"reporting_taxels", counts.reporting_taxels}};
}

FrameCounter::FrameCounter(const Device& device, Object object, std::vector<Pose> X_SO)
    : device_(device), object_(std::move(object)), X_SO_(std::move(X_SO)) {}

const std::vector<float>& FrameCounter::depths(const Sensor& sensor, const LayerNodes& nodes) {
  const auto [entry, is_new] =
      depths_.try_emplace({nodes.num_rows, nodes.num_cols, nodes.spacing[0], nodes.spacing[1], sensor.depth_sampling});
  std::vector<float>& depths = entry->second;
  if (!is_new) return depths;
  const auto num_rows = static_cast<std::size_t>(nodes.num_rows), num_cols = static_cast<std::size_t>(nodes.num_cols);
  depths.resize(X_SO_.size() * num_rows * num_cols);
  OutputOptions outputs = kNoOutputs;
  outputs.penetration_depth = true;
  // A patch has at most kMaxTaxelsPerSide taxels along a side.
  for (int row = 0; row < nodes.num_rows; row += kMaxTaxelsPerSide) {
    for (int col = 0; col < nodes.num_cols; col += kMaxTaxelsPerSide) {
      Sensor samples = sensorOfNodes(sensor, nodes);
      samples.skin = {.thickness = sensor.skin.thickness, .law = Winkler{.normal_contact_stiffness = 1e8}};
      GridPatch& part = samples.patches.front();
      part.num_rows = std::min(kMaxTaxelsPerSide, nodes.num_rows - row);
      part.num_cols = std::min(kMaxTaxelsPerSide, nodes.num_cols - col);
      part.X_SP = part.X_SP * Pose{.position = {(row + 0.5 * (part.num_rows - nodes.num_rows)) * nodes.spacing[0],
                                                (col + 0.5 * (part.num_cols - nodes.num_cols)) * nodes.spacing[1], 0}};
      const std::vector<float> values = computeFrames(device_, samples, object_, X_SO_, outputs, &GroundTruthView::penetration_depth);
      const auto part_cols = static_cast<std::ptrdiff_t>(part.num_cols);
      auto from = values.begin();
      for (std::size_t i = 0; i < X_SO_.size(); ++i) {
        for (int a = 0; a < part.num_rows; ++a, from += part_cols) {
          const std::size_t to = (i * num_rows + static_cast<std::size_t>(row + a)) * num_cols + static_cast<std::size_t>(col);
          std::copy_n(from, part_cols, depths.begin() + static_cast<std::ptrdiff_t>(to));
        }
      }
    }
  }
  return depths;
}

std::vector<float> FrameCounter::pressures(const Sensor& sensor, const LayerNodes& nodes) const {
  Sensor layer = sensorOfNodes(sensor, nodes);
  layer.skin = {.thickness = sensor.skin.thickness, .law = sensor.skin.law};
  layer.depth_sampling = sensor.depth_sampling;
  OutputOptions outputs = kNoOutputs;
  outputs.tactile_normal_force = true;
  return computeFrames(device_, layer, object_, X_SO_, outputs, &GroundTruthView::tactile_normal_force);
}

void FrameCounter::countTriangles(const Sensor& sensor, const LayerNodes& nodes, FrameCounts& counts) const {
  const auto* mesh = std::get_if<Mesh>(&object_.shape);
  if (mesh == nullptr) return;
  const bool is_area = sensor.depth_sampling == DepthSampling::kArea;
  for (const Pose& pose : X_SO_) {
    const Pose X_PO = inverse(sensor.patches.front().X_SP) * pose;
    const std::array<double, 9> R = rotationMatrix(X_PO.rotation);
    std::vector<Corner> corners;
    for (const std::array<float, 3>& v : mesh->vertices) {
      const auto coordinate = [&](std::size_t axis) {
        return X_PO.position[axis] + R[3 * axis] * v[0] + R[3 * axis + 1] * v[1] + R[3 * axis + 2] * v[2];
      };
      corners.push_back({coordinate(0) / nodes.spacing[0] + 0.5 * nodes.num_rows, coordinate(1) / nodes.spacing[1] + 0.5 * nodes.num_cols,
                         coordinate(2)});
    }
    for (const std::array<std::uint32_t, 3>& triangle : mesh->triangles) {
      const std::array<Corner, 3> t{corners[triangle[0]], corners[triangle[1]], corners[triangle[2]]};
      if (t[0][2] >= 0 && t[1][2] >= 0 && t[2][2] >= 0) continue;
      const std::vector<Corner> part = partBelow(t);
      if (!isOver(part, nodes)) continue;
      ++counts.triangles;
      counts.triangles_over_samples += isOverSample(t);
      if (is_area && areaOf(t) < 0) counts.facet_samples += numCells(part, nodes);
    }
  }
  const auto num_frames = static_cast<double>(X_SO_.size());
  counts.triangles /= num_frames;
  counts.triangles_over_samples /= num_frames;
  counts.facet_samples /= num_frames;
}

std::optional<FrameCounts> FrameCounter::count(const Sensor& sensor) {
  const LayerNodes nodes = layerNodes(sensor);
  const GridPatch& patch = sensor.patches.front();
  const auto taxelsOf = [&](const Grid& grid) { return countTaxels(grid, nodes, patch.num_rows, patch.num_cols, sensor.psf.size); };
  const bool is_layer = std::holds_alternative<ElasticLayer>(sensor.skin.law);
  if (is_layer && std::max(nodes.num_rows, nodes.num_cols) > kMaxTaxelsPerSide) return {};
  const std::vector<float>& depth = depths(sensor, nodes);
  std::vector<float> pressure;
  if (is_layer) pressure = pressures(sensor, nodes);
  const auto num_nodes = static_cast<std::size_t>(nodes.num_rows) * static_cast<std::size_t>(nodes.num_cols);
  const double samples_of_taxel = static_cast<double>(num_nodes) / (patch.num_rows * patch.num_cols);
  FrameCounts sums;
  for (std::size_t i = 0; i < X_SO_.size(); ++i) {
    const Grid grid{nodes.num_rows, nodes.num_cols, std::span(depth).subspan(i * num_nodes, num_nodes)};
    TaxelCounts taxels = taxelsOf(grid);
    double samples = taxels.touched * samples_of_taxel;
    sums.touched_samples += numTouched(grid);
    sums.edge_samples += numOnEdge(grid);
    if (is_layer) {
      const Grid pressed{nodes.num_rows, nodes.num_cols, std::span(pressure).subspan(i * num_nodes, num_nodes)};
      taxels = taxelsOf(pressed);
      samples = numInEither(grid, pressed);
      sums.pressed_nodes += numTouched(pressed);
      sums.products += samples * numTouched(pressed);
    }
    sums.samples += samples;
    sums.touched_taxels += taxels.touched;
    sums.spread_taxels += taxels.spread;
  }
  const auto num_frames = static_cast<double>(X_SO_.size());
  for (double* sum : {&sums.samples, &sums.touched_samples, &sums.edge_samples, &sums.pressed_nodes, &sums.products, &sums.touched_taxels,
                      &sums.spread_taxels}) {
    *sum /= num_frames;
  }
  sums.taxels = patch.num_rows * patch.num_cols;
  countTriangles(sensor, nodes, sums);
  return sums;
}

}  // namespace taxelsim::bench
