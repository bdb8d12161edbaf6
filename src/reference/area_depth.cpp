#include "reference/area_depth.h"

#include <algorithm>
#include <limits>
#include <type_traits>

#include "base/constants.h"
#include "base/vector3.h"
#include "reference/friction.h"
#include "reference/load.h"
#include "reference/solid_bounds.h"
#include "reference/solids.h"
#include "reference/surface_faces.h"
#include "sensor/skin.h"

namespace taxelsim::reference {
namespace {

HeightAt heightOf(const Shape& shape, const Pose& X_PO, const Vector3& direction_P) {
  const Pose X_OP = inverse(X_PO);
  return std::visit(
      [&](const auto& solid) -> HeightAt {
        if constexpr (std::is_same_v<std::decay_t<decltype(solid)>, Mesh>) {
          return {};
        } else {
          return [&solid, X_OP, direction_O = rotate(X_OP.rotation, direction_P)](double x, double y) {
            return surfaceOver(solid, X_OP * Vector3{x, y, 0}, direction_O);
          };
        }
      },
      shape);
}

Rectangle overlap(const Rectangle& a, const Rectangle& b) {
  return {{std::max(a.min[0], b.min[0]), std::max(a.min[1], b.min[1])}, {std::min(a.max[0], b.max[0]), std::min(a.max[1], b.max[1])}};
}

CellDepth evenDepth(double depth) {
  return {.mean = depth, .share = 1, .square = depth * depth};
}

// Where the surface folds over itself, the sums are those of what covers the cell on average.
CellDepth cellDepth(const CellSums& sums, const Rectangle& cell, double thickness) {
  const double area = cell.area(), per_area = 1 / std::max(area, sums.covered);
  CellDepth depth{
      .mean = std::min(sums.mean(area), thickness), .share = std::min(sums.covered / area, 1.0), .square = sums.square * per_area};
  for (std::size_t axis = 0; axis < 2; ++axis) {
    depth.moment[axis] = (sums.moment[axis] - sums.volume * (cell.min[axis] + cell.max[axis]) / 2) * per_area;
  }
  return depth;
}

// The ray along `direction_P`, which is z of S, through the lowest point of a bounded solid. The point may be on a rim, which a ray can
// miss by rounding: the ray is moved towards the middle of the projection.
std::array<double, 2> lowestRay(const PlacedObject& placed, const GridPatch& patch, const Vector3& direction_P, const Rectangle& bounds) {
  constexpr double kInwards = 1e-9;  // of the way to the middle
  const Vector3 p_P = inverse(patch.X_SP) * (placed.X_SO * lowestPoint(*placed.object, placed.X_SO.rotation));
  std::array<double, 2> ray{};
  for (std::size_t axis = 0; axis < 2; ++axis) {
    ray[axis] = p_P[axis] - p_P[2] / direction_P[2] * direction_P[axis];
    ray[axis] += kInwards * ((bounds.min[axis] + bounds.max[axis]) / 2 - ray[axis]);
  }
  return ray;
}

}  // namespace

AreaDepth::AreaDepth(const Sensor& sensor, std::span<const PlacedObject> objects) : sensor_(sensor), view_depths_(viewDepths(sensor)) {
  for (const PlacedObject& placed : objects) objects_.push_back({placed, facesOf(placed.object->shape)});
}

std::vector<CellDepth> AreaDepth::cellDepths(const Placed& object, const GridPatch& patch, const DepthRange& range, double offset) const {
  constexpr Vector3 kAlongZ{0, 0, 1};
  const SampleGrid grid(patch, sensor_.samples_per_taxel);
  const std::vector<PlacedObject> moved = movedAlongZ({&object.placed, 1}, offset);
  const Pose X_PO = inverse(patch.X_SP) * moved.front().X_SO;
  const Shape& shape = object.placed.object->shape;
  std::vector<CellDepth> depths(grid.size());
  std::vector<Triangle> faces = object.faces ? inRays(*object.faces, X_PO, kAlongZ) : std::vector<Triangle>{};
  const HeightAt heightAt = heightOf(shape, X_PO, kAlongZ);
  if (std::holds_alternative<HalfSpace>(shape)) faces = planeOver(heightAt, grid.all());
  if (!faces.empty()) {
    std::vector<CellSums> sums(grid.size());
    addTriangles(faces, grid, range, sums);
    for (int u = 0; u < grid.rows; ++u) {
      for (int v = 0; v < grid.cols; ++v) depths[grid.index(u, v)] = cellDepth(sums[grid.index(u, v)], grid.cell(u, v), range.thickness);
    }
  } else if (std::holds_alternative<Mesh>(shape)) {
    std::vector<double> heights;
    appendHeights(patch, sensor_.samples_per_taxel, moved, {.view_depth = range.view_depth}, heights);
    for (std::size_t n = 0; n < heights.size(); ++n) depths[n] = evenDepth(range.depthAt(heights[n]));
  } else {
    const Rectangle bounds = pressedBounds(shape, X_PO);
    for (int u = 0; u < grid.rows; ++u) {
      for (int v = 0; v < grid.cols; ++v)
        depths[grid.index(u, v)] = meanDepth(heightAt, overlap(grid.cell(u, v), bounds), grid.cell(u, v), range, varies(sensor_));
    }
  }
  return depths;
}

AreaDepths AreaDepth::at(double offset) const {
  AreaDepths depths;
  const double most_deep = foundationOf(sensor_.skin).normal_exponent == 1 ? kMostDeep : kHalfDeep;
  for (std::size_t p = 0; p < sensor_.patches.size(); ++p) {
    const std::size_t first = depths.mean.size();
    const SampleGrid grid(sensor_.patches[p], sensor_.samples_per_taxel);
    const std::size_t end = first + grid.size();
    depths.mean.resize(end, 0);
    depths.share.resize(end, 0);
    depths.touching.resize(end, kNoContact);
    if (varies(sensor_)) depths.points.resize(end);
    for (std::size_t number = 0; number < objects_.size(); ++number) {
      const DepthRange range{.thickness = sensor_.skin.thickness, .view_depth = view_depths_[p]};
      const std::vector<CellDepth> cells = cellDepths(objects_[number], sensor_.patches[p], range, offset);
      for (std::size_t n = first; n < end; ++n) {
        const CellDepth& cell = cells[n - first];
        if (cell.mean <= depths.mean[n]) continue;
        depths.mean[n] = cell.mean;
        depths.share[n] = cell.share;
        depths.touching[n] = static_cast<int>(number);
        if (varies(sensor_)) depths.points[n] = cellPoints(cell, {grid.step_x, grid.step_y}, most_deep);
      }
    }
  }
  return depths;
}

std::vector<CellDepth> AreaDepth::cellsOf(std::size_t number, double offset) const {
  std::vector<CellDepth> cells;
  for (std::size_t p = 0; p < sensor_.patches.size(); ++p) {
    const DepthRange range{.thickness = sensor_.skin.thickness, .view_depth = view_depths_[p]};
    const std::vector<CellDepth> of_patch = cellDepths(objects_[number], sensor_.patches[p], range, offset);
    cells.insert(cells.end(), of_patch.begin(), of_patch.end());
  }
  return cells;
}

double AreaDepth::lowestAlong(const Placed& object, const GridPatch& patch, const Vector3& direction_P) const {
  const Pose X_PO = inverse(patch.X_SP) * object.placed.X_SO;
  const Shape& shape = object.placed.object->shape;
  const Rectangle skin = SampleGrid(patch, sensor_.samples_per_taxel).all();
  if (object.faces) return lowestOver(inRays(*object.faces, X_PO, direction_P), skin);
  if (std::holds_alternative<Mesh>(shape)) {
    std::vector<double> heights;
    appendHeights(patch, sensor_.samples_per_taxel, {&object.placed, 1}, {.direction_P = direction_P}, heights);
    return *std::min_element(heights.begin(), heights.end());
  }
  const Rectangle bounds = projectedBounds(shape, X_PO, direction_P);
  const auto guess = std::holds_alternative<HalfSpace>(shape) ? skin.min : lowestRay(object.placed, patch, direction_P, bounds);
  return lowestHeight(heightOf(shape, X_PO, direction_P), overlap(skin, bounds), guess);
}

double AreaDepth::firstTouch() const {
  double lowest = kInfinity;
  for (const GridPatch& patch : sensor_.patches) {
    const Vector3 direction_P = rotate(inverse(patch.X_SP).rotation, {0, 0, 1});
    if (direction_P[2] <= 0) continue;  // a patch that faces away is not touched first
    for (const Placed& object : objects_) lowest = std::min(lowest, lowestAlong(object, patch, direction_P));
  }
  return -lowest;
}

bool varies(const Sensor& sensor) {
  return sensor.depth_sampling == DepthSampling::kArea && (std::holds_alternative<ElasticLayer>(sensor.skin.law) ||
                                                           hasFriction(sensor.skin) || foundationOf(sensor.skin).normal_exponent != 1);
}

std::vector<double> meanPenetrations(const Sensor& sensor, std::span<const PlacedObject> objects) {
  return AreaDepth(sensor, objects).at().mean;
}

std::vector<double> coveredDepths(const AreaDepths& depths) {
  std::vector<double> covered(depths.mean.size(), 0);
  for (std::size_t n = 0; n < covered.size(); ++n) {
    if (depths.share[n] >= kLeastShareOfFull) covered[n] = depths.mean[n] / depths.share[n];
  }
  return covered;
}

double overPenetration(const Sensor& sensor, const AreaDepths& depths) {
  const std::vector<double> covered = coveredDepths(depths);
  const auto isFull = [&](double depth) { return depth >= kFullDepth * sensor.skin.thickness; };
  return static_cast<double>(std::count_if(covered.begin(), covered.end(), isFull)) / static_cast<double>(covered.size());
}

}  // namespace taxelsim::reference
