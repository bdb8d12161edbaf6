#include "figures/scene_view.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>

#include "base/vector3.h"
#include "figures/taxel_chart.h"

namespace taxelsim::figures {
namespace {

constexpr double kAzimuth = -0.42, kElevation = 0.66;  // rad
constexpr double kTileShare = 0.9;                     // of the side of a taxel, so that the grid is visible
constexpr double kSideShare = 0.07;                    // depth of the sides, of the extent of the taxels
constexpr double kReach = 1.15;                        // the picture shows the object up to this distance from the middle, in extents
constexpr double kFlatness = 1e-6;                     // m, and sine of normals: less counts as flat
constexpr double kObjectAlpha = 0.6;
constexpr double kSeam = 0.6;  // points, width of lines around faces, which close the gaps between them
const Vector3 kToLight = unit(Vector3{-0.25, 0.35, 1});
constexpr Colour kObjectColour = rgb(0x8ea3bd), kSideColour = rgb(0x39414f), kTopColour = rgb(0x4a5364);

Vector3 meanOf(std::span<const Vector3> points) {
  Vector3 sum{0, 0, 0};
  for (const Vector3& point : points) sum = add(sum, point);
  return scale(1 / static_cast<double>(points.size()), sum);
}

// The part of a triangle with z >= 0.
ViewFace aboveSkin(const Triangle3& triangle) {
  ViewFace face;
  for (std::size_t k = 0; k < 3; ++k) {
    const Vector3 &from = triangle[k], &to = triangle[(k + 1) % 3];
    if (from[2] >= 0) face.corners[face.num_corners++] = from;
    if ((from[2] >= 0) != (to[2] >= 0)) {
      Vector3 cut = add(from, scale(from[2] / (from[2] - to[2]), subtract(to, from)));
      cut[2] = 0;
      face.corners[face.num_corners++] = cut;
    }
  }
  return face;
}

// Colour of a matt face with some gloss.
Colour shaded(const Colour& colour, const Vector3& normal, const Vector3& towards_viewer) {
  const double matt = 0.62 + 0.42 * std::max(0.0, dot(normal, kToLight));
  const double gloss = 0.22 * std::pow(std::max(0.0, dot(normal, unit(add(kToLight, towards_viewer)))), 24);
  const auto of = [&](double value) { return std::min(1.0, value * matt + gloss); };
  return {of(colour.red), of(colour.green), of(colour.blue)};
}

// Whether all taxels lie in the xy plane of S.
bool areFlat(const std::vector<Vector3>& positions, const std::vector<Vector3>& normals) {
  for (std::size_t t = 0; t < normals.size(); ++t) {
    const Vector3& n = normals[t];
    if (std::hypot(n[0], n[1]) > kFlatness || n[2] < 0 || std::abs(positions[t][2]) > kFlatness) return false;
  }
  return true;
}

// m, of the longest side of the box around all corners.
double extentOf(const std::vector<std::array<Vector3, 4>>& tiles) {
  Vector3 low = tiles[0][0], high = low;
  for (const auto& tile : tiles) {
    for (const Vector3& corner : tile) {
      for (std::size_t axis = 0; axis < 3; ++axis) {
        low[axis] = std::min(low[axis], corner[axis]);
        high[axis] = std::max(high[axis], corner[axis]);
      }
    }
  }
  const Vector3 size = subtract(high, low);
  return std::max({size[0], size[1], size[2]});
}

// From the farthest on.
void sortFaces(std::vector<ViewFace>& faces) {
  std::ranges::stable_sort(faces, {}, &ViewFace::near);
}

}  // namespace

Camera::Camera(double azimuth, double elevation)
    : right_{-std::sin(azimuth), std::cos(azimuth), 0},
      up_{-std::sin(elevation) * std::cos(azimuth), -std::sin(elevation) * std::sin(azimuth), std::cos(elevation)},
      near_{std::cos(elevation) * std::cos(azimuth), std::cos(elevation) * std::sin(azimuth), std::sin(elevation)} {}

Camera::Point Camera::operator()(const Vector3& p_S) const {
  return {dot(right_, p_S), -dot(up_, p_S), dot(near_, p_S)};
}

std::vector<ViewFace> facesInOrder(const ObjectSurface& surface, const Pose& X_SO, const Camera& camera, bool is_cut) {
  std::vector<ViewFace> faces;
  for (const Triangle3& triangle_O : surface.triangles) {
    const Triangle3 triangle{X_SO * triangle_O[0], X_SO * triangle_O[1], X_SO * triangle_O[2]};
    const Vector3 across = cross(subtract(triangle[1], triangle[0]), subtract(triangle[2], triangle[0]));
    const double facing = dot(across, camera.towardsViewer());
    if (length(across) == 0 || (surface.is_outward && facing <= 0)) continue;
    ViewFace face = is_cut ? aboveSkin(triangle) : ViewFace{.corners = {triangle[0], triangle[1], triangle[2]}, .num_corners = 3};
    if (face.num_corners == 0) continue;
    face.normal = unit(facing < 0 ? scale(-1, across) : across);
    face.near = camera(meanOf({face.corners.data(), face.num_corners})).near;
    faces.push_back(face);
  }
  sortFaces(faces);
  return faces;
}

SceneView::SceneView(const Sensor& sensor, std::span<const Shape> shapes, std::span<const Pose> poses, double width, double height)
    : camera_(kAzimuth, kElevation),
      tiles_(tilesOf(sensor)),
      normals_(taxelNormals(sensor)),
      order_(tiles_.size()),
      is_flat_(areFlat(taxelPositions(sensor), normals_)),
      extent_(extentOf(tiles_)),
      depth_(kSideShare * extent_),
      width_(width),
      height_(height) {
  for (const Shape& shape : shapes) surfaces_.push_back(surfaceOf(shape, extent_));
  std::iota(order_.begin(), order_.end(), std::size_t{0});
  std::stable_sort(order_.begin(), order_.end(),
                   [this](std::size_t a, std::size_t b) { return camera_(meanOf(tiles_[a])).near < camera_(meanOf(tiles_[b])).near; });
  fit(poses);
}

void SceneView::fit(std::span<const Pose> poses) {
  constexpr double kInfinity = std::numeric_limits<double>::infinity();
  std::array<double, 2> low{kInfinity, kInfinity}, high{-kInfinity, -kInfinity};
  Vector3 middle{0, 0, 0};
  for (const auto& tile : tiles_) middle = add(middle, scale(1 / static_cast<double>(tiles_.size()), meanOf(tile)));
  const auto include = [&](const Vector3& p_S) {
    const Vector3 offset = subtract(p_S, middle);
    const Camera::Point point = camera_(add(middle, scale(std::min(1.0, kReach * extent_ / std::max(length(offset), 1e-9)), offset)));
    low = {std::min(low[0], point.right), std::min(low[1], point.down)};
    high = {std::max(high[0], point.right), std::max(high[1], point.down)};
  };
  for (std::size_t t = 0; t < tiles_.size(); ++t) {
    for (const Vector3& corner : tiles_[t]) include(corner), include(add(corner, scale(-depth_, normals_[t])));
  }
  for (std::size_t k = 0; k < poses.size(); ++k) {
    for (const Triangle3& triangle : surfaces_[k % surfaces_.size()].triangles) include(poses[k] * triangle[0]);
  }
  scale_ = std::min(width_ / (high[0] - low[0]), height_ / (high[1] - low[1]));
  middle_ = {(low[0] + high[0]) / 2, (low[1] + high[1]) / 2};
}

std::array<double, 2> SceneView::place(const Vector3& p_S) const {
  const Camera::Point point = camera_(p_S);
  return {width_ / 2 + (point.right - middle_[0]) * scale_, height_ / 2 + (point.down - middle_[1]) * scale_};
}

void SceneView::fill(const Canvas& canvas, std::span<const Vector3> corners, const Colour& colour) const {
  for (const Vector3& corner : corners) {
    const auto [x, y] = place(corner);
    cairo_line_to(canvas, x, y);
  }
  cairo_close_path(canvas);
  canvas.colour(colour);
  cairo_fill_preserve(canvas);
  cairo_set_line_width(canvas, kSeam);
  cairo_stroke(canvas);
}

void SceneView::drawTile(const Canvas& canvas, std::size_t taxel, const Colour& colour) const {
  const auto& tile = tiles_[taxel];
  const Vector3 inwards = scale(-depth_, normals_[taxel]), middle = meanOf(tile);
  for (std::size_t k = 0; k < 4; ++k) {
    const Vector3 &from = tile[k], &to = tile[(k + 1) % 4], outwards = unit(cross(normals_[taxel], subtract(to, from)));
    if (dot(outwards, camera_.towardsViewer()) <= 0) continue;
    fill(canvas, std::array{from, to, add(to, inwards), add(from, inwards)}, shaded(kSideColour, outwards, camera_.towardsViewer()));
  }
  if (dot(normals_[taxel], camera_.towardsViewer()) <= 0) return;
  fill(canvas, tile, kTopColour);
  std::array<Vector3, 4> inner;
  for (std::size_t k = 0; k < 4; ++k) inner[k] = add(middle, scale(kTileShare, subtract(tile[k], middle)));
  fill(canvas, inner, colour);
}

void SceneView::drawObject(const Canvas& canvas, const std::vector<ViewFace>& faces) const {
  cairo_push_group(canvas);
  for (const ViewFace& face : faces) {
    fill(canvas, {face.corners.data(), face.num_corners}, shaded(kObjectColour, face.normal, camera_.towardsViewer()));
  }
  cairo_pop_group_to_source(canvas);
  cairo_paint_with_alpha(canvas, kObjectAlpha);
}

// The directions of x, y and z of S, in the lower left corner.
void SceneView::drawFrame(const Canvas& canvas) const {
  static constexpr double kLength = 17, kLetter = 24, kLeft = 14, kFoot = 12;
  static constexpr std::array kNames{"x", "y", "z"};
  canvas.font(kSmall);
  cairo_set_line_width(canvas, 1.3);
  canvas.colour(kGrey);
  for (std::size_t axis = 0; axis < 3; ++axis) {
    Vector3 direction{0, 0, 0};
    direction[axis] = 1;
    const Camera::Point tip = camera_(direction);
    cairo_move_to(canvas, kLeft, height_ - kFoot);
    cairo_line_to(canvas, kLeft + kLength * tip.right, height_ - kFoot + kLength * tip.down);
    cairo_stroke(canvas);
    canvas.text(kLeft + kLetter * tip.right, height_ - kFoot + kLetter * tip.down + 0.32 * kSmall, kNames[axis], 0.5);
  }
}

void SceneView::draw(const Canvas& canvas, std::span<const Pose> X_SO, std::span<const double> values, const ColourScale& scale) const {
  std::vector<ViewFace> faces;
  for (std::size_t k = 0; k < surfaces_.size(); ++k) {
    const std::vector<ViewFace> more = facesInOrder(surfaces_[k], X_SO[k], camera_, is_flat_);
    faces.insert(faces.end(), more.begin(), more.end());
  }
  sortFaces(faces);
  cairo_save(canvas);
  cairo_rectangle(canvas, 0, 0, width_, height_);
  cairo_clip(canvas);
  for (const std::size_t taxel : order_) drawTile(canvas, taxel, std::isfinite(values[taxel]) ? scale.at(values[taxel]) : kGap);
  drawObject(canvas, faces);
  cairo_restore(canvas);
  drawFrame(canvas);
}

}  // namespace taxelsim::figures
