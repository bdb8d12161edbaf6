#include "reference/layer_cells.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "reference/area_depth.h"
#include "reference/friction.h"

namespace taxelsim::reference {
namespace {

constexpr double kSureEdge = 0.05, kNoEdge = 0.15;  // variance of the depth over the square of its mean
constexpr double kNearlyWhole = 20;
constexpr double kLeastCovered = 8.0 / 1048576;
constexpr double kLeastCompliance = 0.5;

double edgeOf(const CellDepth& cell) {
  const double mean = cell.mean / cell.share, variance = cell.square / cell.share / (mean * mean) - 1;
  return std::clamp((kNoEdge - variance) / (kNoEdge - kSureEdge), 0.0, 1.0) * std::clamp(kNearlyWhole * (1 - cell.share), 0.0, 1.0);
}

// Displacement of the middle of a round cloud of force under another at distance r, times pi E* over the force, 1/m. Gaussian clouds whose
// squared widths add up to w^2 / 2; the first term is the potential of one in the middle of the other.
double mutual(double r, double w, double image_depth) {
  const double between = r / w > 1e-3 ? std::erf(r / w) / r : 2 / (std::sqrt(std::numbers::pi) * w);
  return between - (image_depth > 0 ? 1 / std::hypot(r, image_depth) : 0);
}

// Own compliance of a part of a cell over that of a whole cell.
double ownCompliance(const CellCompliance& c, double share) {
  const double whole = std::pow(share, 8);
  return 1 + (c.disc * (1 - whole) + c.free * whole) / std::sqrt(share) - c.free + c.base * (1 - share);
}

// Compliance of node (u, v) over that of a whole cell, with what its neighbours add.
double complianceOf(const LayerCells& cells, const LayerNodes& nodes, const CellCompliance& c, int u, int v) {
  const auto index = [&](int row, int col) { return static_cast<std::size_t>(row * nodes.num_cols + col); };
  const double share = cells.share[index(u, v)];
  if (share == 0) return 1;
  // The width of a cloud is that with which a disc of its area would be as soft as a rigid one.
  const auto width = [&](double shares) { return std::sqrt(8 * shares * nodes.area()) / (std::numbers::pi * std::numbers::pi); };
  double sum = 0;
  for (int i = std::max(u - 1, 0); i <= std::min(u + 1, nodes.num_rows - 1); ++i) {
    for (int j = std::max(v - 1, 0); j <= std::min(v + 1, nodes.num_cols - 1); ++j) {
      const double other = cells.share[index(i, j)], covered = cells.covered[index(i, j)];
      if ((i == u && j == v) || other == 0) continue;
      const double x = (i - u) * nodes.spacing[0], y = (j - v) * nodes.spacing[1];
      const auto &from = cells.place[index(u, v)], &to = cells.place[index(i, j)];
      const double distance = std::hypot(x + to[0] - from[0], y + to[1] - from[1]);
      sum += std::sqrt(covered / share) *
             (mutual(distance, width(share + other), c.image_depth) - mutual(std::hypot(x, y), width(2), c.image_depth));
    }
  }
  return std::max(ownCompliance(c, share) + c.point * sum, kLeastCompliance);
}

void setCell(LayerCells& cells, std::size_t n, const CellDepth& cell, int number, double offset) {
  const double edge = edgeOf(cell);
  cells.height[n] = -cell.mean / cell.share - offset;
  cells.edge[n] = edge;
  cells.covered[n] = cell.share;
  cells.share[n] = 1 + edge * (cell.share - 1);
  for (std::size_t axis = 0; axis < 2; ++axis) cells.place[n][axis] = edge * cell.moment[axis] / cell.mean;
  cells.touching[n] = number;
}

// Cells of the samples of a sensor, under the objects after a translation by `offset` (m) along z of S, with the heights of their poses; by
// exact clipping and rays, area_depth.h. Without compliances. Empty without area sampling.
LayerCells sampleCells(const Sensor& sensor, std::span<const PlacedObject> objects, double offset) {
  LayerCells cells;
  if (sensor.depth_sampling != DepthSampling::kArea) return cells;
  const AreaDepth area(sensor, objects);
  const std::size_t size = samplesOf(sensor).size();
  cells.height.resize(size, 0);
  cells.covered.resize(size, 0);
  cells.share.resize(size, 0);
  cells.edge.resize(size, 0);
  cells.place.resize(size);
  cells.touching.resize(size, kNoContact);
  std::vector<double> deepest(size, 0);
  for (std::size_t number = 0; number < objects.size(); ++number) {
    const std::vector<CellDepth> of_object = area.cellsOf(number, offset);
    for (std::size_t n = 0; n < size; ++n) {
      const CellDepth& cell = of_object[n];
      if (cell.share <= kLeastCovered || cell.mean / cell.share <= deepest[n]) continue;
      deepest[n] = cell.mean / cell.share;
      setCell(cells, n, cell, static_cast<int>(number), offset);
    }
  }
  return cells;
}

}  // namespace

NodeCompliance nodeCompliance(const Sensor& sensor, const LayerNodes& nodes) {
  const auto& law = std::get<ElasticLayer>(sensor.skin.law);
  const double thickness = sensor.skin.thickness;
  return {layerInfluence(law, thickness, nodes.spacing, 1, 1).front(), cellCompliance(law, thickness, nodes.spacing)};
}

std::vector<double> cellCompliances(const LayerCells& cells, const LayerNodes& nodes, const NodeCompliance& compliance) {
  std::vector<double> more;
  for (int u = 0; u < nodes.num_rows; ++u) {
    for (int v = 0; v < nodes.num_cols; ++v) more.push_back(compliance.whole * (complianceOf(cells, nodes, compliance.of_parts, u, v) - 1));
  }
  return more;
}

LayerCells layerCells(const Sensor& sensor, const LayerNodes& nodes, std::span<const PlacedObject> objects, double offset) {
  LayerCells cells = sampleCells(sensorOfNodes(sensor, nodes), objects, offset);
  if (!cells.covered.empty()) cells.compliance = cellCompliances(cells, nodes, nodeCompliance(sensor, nodes));
  return cells;
}

LayerCells layerCellsAtFullDepth(const Sensor& sensor, const LayerNodes& nodes, std::span<const PlacedObject> objects) {
  if (sensor.depth_sampling != DepthSampling::kArea) return {};
  const Sensor of_nodes = sensorOfNodes(sensor, nodes);
  const double first_touch = AreaDepth(of_nodes, objects).firstTouch();
  constexpr double kJustBelow = 1 - 1e-9;  // a level face at exactly the thickness has no sure side of it
  return layerCells(sensor, nodes, objects, std::isfinite(first_touch) ? first_touch - kJustBelow * sensor.skin.thickness : 0);
}

std::vector<double> heightsOfCells(const LayerCells& cells, std::vector<double> heights) {
  for (std::size_t n = 0; n < cells.height.size(); ++n) {
    const double edge = cells.edge[n];
    if (edge > 0) heights[n] = std::isfinite(heights[n]) ? heights[n] + edge * (cells.height[n] - heights[n]) : cells.height[n];
  }
  return heights;
}

}  // namespace taxelsim::reference
