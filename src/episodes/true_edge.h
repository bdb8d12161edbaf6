// Ground-truth edge of an object: a direction, or a closed contour.
#pragma once

#include <vector>

#include "taxelsim/scene.h"

namespace taxelsim {

// The edge projected onto the xy plane of S.
struct ProjectedEdge {
  double angle = 0;     // rad in (-pi/2, pi/2]; NaN if the object has no edge, or the edge is perpendicular to the plane
  double distance = 0;  // m, from the origin of S to the contour; NaN without contour
  double arc = 0;       // m, arc length from the first contour point to the point closest to the origin; NaN without contour
};

class TrueEdge {
 public:
  explicit TrueEdge(const SceneObject& object);

  ProjectedEdge project(const Pose& X_SO) const;

  // Point of the contour (m, in O) and unit tangent there.
  struct ContourPoint {
    Vector3 point, direction;
  };
  // Contour point at arc length `arc` (m, 0 to contourLength()). Requires a contour.
  ContourPoint at(double arc) const;

  double contourLength() const { return arc_.empty() ? 0 : arc_.back(); }  // m; 0 without contour

 private:
  std::optional<Vector3> direction_;
  std::vector<Vector3> contour_;  // m, in O; closed: the first point is repeated at the end
  std::vector<double> arc_;       // m, arc length at each point
};

}  // namespace taxelsim
