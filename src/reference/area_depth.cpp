#include "reference/area_depth.h"

#include <algorithm>
#include <limits>
#include <type_traits>

#include "base/vector3.h"
#include "geometry/outward.h"
#include "reference/friction.h"
#include "reference/load.h"
#include "reference/samples.h"
#include "reference/solids.h"
#include "sensor/skin.h"

namespace taxelsim::reference {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();

std::vector<Triangle> facesOf(const Mesh& outward) {
  std::vector<Triangle> faces;
  faces.reserve(outward.triangles.size());
  for (const std::array<std::uint32_t, 3>& corners : outward.triangles) {
    Triangle& face = faces.emplace_back();
    for (std::size_t n = 0; n < 3; ++n) {
      const auto& [x, y, z] = outward.vertices[corners[n]];
      face[n] = {x, y, z};
    }
  }
  return faces;
}

// In double: a mesh would round the size to float32.
std::vector<Triangle> facesOf(const Box& box) {
  std::vector<Triangle> faces;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    for (const double side : {-0.5, 0.5}) {
      const auto corner = [&](double u, double v) {
        Vector3 p;
        p[axis] = side * box.size[axis];
        p[(axis + 1) % 3] = u * box.size[(axis + 1) % 3];
        p[(axis + 2) % 3] = v * box.size[(axis + 2) % 3];
        return p;
      };
      // Counter-clockwise about +axis, the outward direction of the upper side.
      faces.push_back({corner(-0.5, -0.5), corner(side, -side), corner(0.5, 0.5)});
      faces.push_back({corner(-0.5, -0.5), corner(0.5, 0.5), corner(-side, side)});
    }
  }
  return faces;
}

std::optional<std::vector<Triangle>> facesOf(const Shape& shape) {
  if (const Box* box = std::get_if<Box>(&shape)) return facesOf(*box);
  const Mesh* mesh = std::get_if<Mesh>(&shape);
  const std::optional<Mesh> outward = mesh ? outwardMesh(*mesh) : std::nullopt;
  return outward ? std::optional(facesOf(*outward)) : std::nullopt;
}

// In coordinates in which rays along `direction_P` (z > 0) run along z, and heights are multiples of it.
Vector3 inRays(const Vector3& p_O, const Pose& X_PO, const Vector3& direction_P) {
  const Vector3 p_P = X_PO * p_O;
  const double t = p_P[2] / direction_P[2];
  return {p_P[0] - t * direction_P[0], p_P[1] - t * direction_P[1], t};
}

std::vector<Triangle> inRays(std::vector<Triangle> faces, const Pose& X_PO, const Vector3& direction_P) {
  for (Triangle& face : faces) {
    for (Vector3& p : face) p = inRays(p, X_PO, direction_P);
  }
  return faces;
}

HeightAt heightOf(const Shape& shape, const Pose& X_PO, const Vector3& direction_P) {
  const Pose X_OP = inverse(X_PO);
  return std::visit(
      [&](const auto& solid) -> HeightAt {
        if constexpr (std::is_same_v<std::decay_t<decltype(solid)>, Mesh>) {
          return {};
        } else {
          return [&solid, X_OP, direction_O = rotate(X_OP.rotation, direction_P)](double x, double y) {
            return firstHit(solid, X_OP * Vector3{x, y, 0}, direction_O);
          };
        }
      },
      shape);
}

// In the coordinates of inRays().
Bounds boundsInRays(const Object& object, const Pose& X_PO, const Vector3& direction_P) {
  Bounds all{{-kInfinity, -kInfinity, -kInfinity}, {kInfinity, kInfinity, kInfinity}};
  if (std::holds_alternative<HalfSpace>(object.shape)) return all;
  std::swap(all.min, all.max);
  const auto [min, max] = boundsOf(object);
  for (int corner = 0; corner < 8; ++corner) {
    const Vector3 p{(corner & 1 ? max : min)[0], (corner & 2 ? max : min)[1], (corner & 4 ? max : min)[2]};
    const Vector3 ray = inRays(p, X_PO, direction_P);
    for (std::size_t axis = 0; axis < 3; ++axis) {
      all.min[axis] = std::min(all.min[axis], ray[axis]);
      all.max[axis] = std::max(all.max[axis], ray[axis]);
    }
  }
  return all;
}

Rectangle overlap(Rectangle rectangle, const Bounds& bounds) {
  for (std::size_t axis = 0; axis < 2; ++axis) {
    rectangle.min[axis] = std::max(rectangle.min[axis], bounds.min[axis]);
    rectangle.max[axis] = std::min(rectangle.max[axis], bounds.max[axis]);
  }
  return rectangle;
}

// The plane of a half-space over a rectangle, wound to look down. Empty if it has no lower surface.
std::vector<Triangle> planeOver(const HeightAt& heightAt, const Rectangle& rectangle) {
  const auto corner = [&](double x, double y) { return Vector3{x, y, heightAt(x, y)}; };
  const Vector3 a = corner(rectangle.min[0], rectangle.min[1]), b = corner(rectangle.min[0], rectangle.max[1]);
  const Vector3 c = corner(rectangle.max[0], rectangle.max[1]), d = corner(rectangle.max[0], rectangle.min[1]);
  for (const Vector3& p : {a, b, c, d}) {
    if (!std::isfinite(p[2])) return {};
  }
  return {{a, b, c}, {a, c, d}};
}

}  // namespace

AreaDepth::AreaDepth(const Sensor& sensor, std::span<const PlacedObject> objects) : sensor_(sensor) {
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
    for (std::size_t n = 0; n < sums.size(); ++n)
      depths[n] = {std::min(sums[n].mean(grid.cell(0, 0).area()), range.thickness), sums[n].deepest};
  } else if (std::holds_alternative<Mesh>(shape)) {
    std::vector<double> heights;
    appendHeights(patch, sensor_.samples_per_taxel, moved, {.view_depth = range.view_depth}, heights);
    for (std::size_t n = 0; n < heights.size(); ++n) depths[n] = {range.depthAt(heights[n]), range.depthAt(heights[n])};
  } else {
    const Bounds bounds = boundsInRays(*object.placed.object, X_PO, kAlongZ);
    if (bounds.min[2] >= 0) return depths;
    for (int u = 0; u < grid.rows; ++u) {
      for (int v = 0; v < grid.cols; ++v)
        depths[grid.index(u, v)] = meanDepth(heightAt, overlap(grid.cell(u, v), bounds), grid.cell(u, v).area(), range);
    }
  }
  return depths;
}

AreaDepths AreaDepth::at(double offset) const {
  const std::vector<double> view_depths = viewDepths(sensor_);
  AreaDepths depths;
  for (std::size_t p = 0; p < sensor_.patches.size(); ++p) {
    const std::size_t first = depths.mean.size();
    const std::size_t end = first + SampleGrid(sensor_.patches[p], sensor_.samples_per_taxel).size();
    depths.mean.resize(end, 0);
    depths.deepest.resize(end, 0);
    depths.touching.resize(end, kNoContact);
    for (std::size_t number = 0; number < objects_.size(); ++number) {
      const DepthRange range{.thickness = sensor_.skin.thickness, .view_depth = view_depths[p]};
      const std::vector<CellDepth> cells = cellDepths(objects_[number], sensor_.patches[p], range, offset);
      for (std::size_t n = first; n < end; ++n) {
        const auto& [mean, deepest] = cells[n - first];
        depths.deepest[n] = std::max(depths.deepest[n], deepest);
        if (mean <= depths.mean[n]) continue;
        depths.mean[n] = mean;
        depths.touching[n] = static_cast<int>(number);
      }
    }
  }
  return depths;
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
  return lowestHeight(heightOf(shape, X_PO, direction_P), overlap(skin, boundsInRays(*object.placed.object, X_PO, direction_P)));
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

std::vector<double> meanPenetrations(const Sensor& sensor, std::span<const PlacedObject> objects) {
  return AreaDepth(sensor, objects).at().mean;
}

double overPenetration(const Sensor& sensor, const AreaDepths& depths) {
  const auto isFull = [&](double depth) { return depth >= sensor.skin.thickness; };
  return static_cast<double>(std::count_if(depths.deepest.begin(), depths.deepest.end(), isFull)) /
         static_cast<double>(depths.deepest.size());
}

}  // namespace taxelsim::reference
