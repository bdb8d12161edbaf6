// A sensor and the objects that touch it in 3-D, by painter's algorithm: taxels as tiles in the colours of the tactile image, the objects
// translucent over them.
//
//   viewer at azimuth 0: x of S points to the viewer, y to the right, z up, as in a tactile image that is tilted away
//
//   for each taxel from the farthest: draw the sides that face the viewer, then its tile
//   draw the objects' faces from the farthest, opaque, on a layer of its own; then that layer, translucent, so that no face shows another
#pragma once

#include <array>
#include <span>
#include <vector>

#include "figures/object_surface.h"
#include "figures/tactile_panel.h"
#include "taxelsim/sensor.h"

namespace taxelsim::figures {

// Orthographic projection of S.
class Camera {
 public:
  // m; `near` grows towards the viewer.
  struct Point {
    double right = 0, down = 0, near = 0;
  };

  // rad: direction of the viewer, about z from x towards y, and above the xy plane.
  Camera(double azimuth, double elevation);

  Point operator()(const Vector3& p_S) const;
  const Vector3& towardsViewer() const { return near_; }  // unit, in S

 private:
  Vector3 right_, up_, near_;
};

// A convex face with three or four corners, and its unit normal towards the viewer, in S.
struct ViewFace {
  std::array<Vector3, 4> corners{};
  std::size_t num_corners = 0;
  Vector3 normal{0, 0, 1};
  double near = 0;  // m, of the mean of its corners
};

// The faces of an object with pose X_SO that the viewer can see, without those that are hidden behind the object itself if its surface is
// outward, from the farthest on. `is_cut`: only what lies above the xy plane of S.
std::vector<ViewFace> facesInOrder(const ObjectSurface& surface, const Pose& X_SO, const Camera& camera, bool is_cut);

// Views of one sensor and objects. All have the same scale.
class SceneView {
 public:
  // Fits into a box of `width` x `height` points: the sensor, and the objects in all `poses` (X_SO; num_frames x num_objects) as far as
  // they are near the sensor.
  SceneView(const Sensor& sensor, std::span<const Shape> shapes, std::span<const Pose> poses, double width, double height);

  // The origin is the upper left corner of the box. X_SO (num_objects). `values`: (num_taxels) or more; NaN for a grey tile.
  void draw(const Canvas& canvas, std::span<const Pose> X_SO, std::span<const double> values, const ColourScale& scale) const;

 private:
  std::array<double, 2> place(const Vector3& p_S) const;  // points
  void fit(std::span<const Pose> poses);
  void fill(const Canvas& canvas, std::span<const Vector3> corners, const Colour& colour) const;
  void drawTile(const Canvas& canvas, std::size_t taxel, const Colour& colour) const;
  void drawObject(const Canvas& canvas, const std::vector<ViewFace>& faces) const;
  void drawFrame(const Canvas& canvas) const;

  Camera camera_;
  std::vector<std::array<Vector3, 4>> tiles_;  // tilesOf(sensor)
  std::vector<Vector3> normals_;               // by taxel, in S
  std::vector<std::size_t> order_;             // taxels from the farthest on
  std::vector<ObjectSurface> surfaces_;        // (num_objects)
  bool is_flat_;
  double extent_, depth_;  // m, of the taxels; of the sides that are drawn
  double width_, height_;  // points
  double scale_ = 1;       // points per m
  std::array<double, 2> middle_{0, 0};
};

}  // namespace taxelsim::figures
