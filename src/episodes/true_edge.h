// Where an object's edge truly is: what exact angles and errors of contours are taken from.
#pragma once

#include <vector>

#include "taxelsim/scene.h"

namespace taxelsim {

// The edge as the sensor would see it along z of S.
struct ProjectedEdge {
  double angle = 0;     // rad in (-pi/2, pi/2], in the xy plane of S; NaN where the object has no edge, or it stands on that plane
  double distance = 0;  // m, in the xy plane of S, from the origin to the contour; NaN without contour
  double arc = 0;       // m, along the contour to the point next to the origin, from its first point; NaN without contour
};

class TrueEdge {
 public:
  explicit TrueEdge(const SceneObject& object);

  ProjectedEdge project(const Pose& X_SO) const;
  // At `arc` (m, 0 to contourLength()) along the contour: a point in O, and the direction there.
  struct Place {
    Vector3 point, direction;
  };
  Place at(double arc) const;
  double contourLength() const { return arc_.empty() ? 0 : arc_.back(); }  // m

 private:
  std::optional<Vector3> direction_;
  std::vector<Vector3> contour_;  // closed: the first point again at the end
  std::vector<double> arc_;       // m, to each of them
};

}  // namespace taxelsim
