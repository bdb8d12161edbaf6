// Shapes that press on a flat skin, with the volume that they displace in closed form.
#pragma once

#include "support/test.h"
#include "taxelsim/object.h"

namespace taxelsim::support {

struct PressedShape {
  Object object;
  double lift = 0;                         // m, height of the origin over the lowest point in `rotation`
  Quaternion rotation{1, 0, 0, 0};         // R_SO
  std::function<double(double)> volume{};  // m^3 under the skin's surface, by depth (m) of the lowest point
  bool is_closed = true;                   // a mesh that is not has points where areas are sampled
};

// Of the solids, the pose without rotation rests on an end, a face, the apex or the tube.
PressedShape pressed(const Sphere& sphere);
PressedShape pressed(const Cylinder& cylinder);
PressedShape pressed(const Capsule& capsule);
PressedShape pressed(const Box& box);
PressedShape pressed(const HalfSpace& half_space, double skin_area);
PressedShape pressed(const Cone& cone);
PressedShape pressed(const Torus& torus);
// With the axis along y.
PressedShape lying(const Cylinder& cylinder);
PressedShape lying(const Capsule& capsule);
// A cylinder along z as a mesh of 96 sides with the area of the circle. Its ends wind the wrong way, which area sampling has to find out.
PressedShape pressedPin(double radius, double length);

// Each alternative of Shape and each kind of mesh that the device treats in its own way. A shape without a row does not compile.
std::vector<PressedShape> everyPressedShape(double skin_area);

}  // namespace taxelsim::support
