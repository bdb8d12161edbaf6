#include "scene/keys/object.h"

#include <array>
#include <string_view>

#include "control/motion_fields.h"
#include "geometry/object_fields.h"
#include "scene/keys/sensor.h"
#include "scene/scene_fields.h"

namespace taxelsim {
namespace {

const Block& waypointKeys() {
  static const Block block{.name = "",
                           .keys = {{"file", Text{"a CSV file of waypoints"}, kNeeded, "Poses and times, relative to the first ones"},
                                    {"interpolation", Words{kInterpolationNames}, "cubic",
                                     "linear: at constant speed from one to the next; cubic: Hermite splines whose slope is that of the "
                                     "parabola through a waypoint and its neighbours, at rest at both ends"},
                                    sha256Key()}};
  return block;
}

const Block& motionKeys() {
  static const Block block{
      .name = "motion",
      .keys = {{"constant_twist", Nested{fieldBlock<kConstantTwistFields>}, "", "A screw: a constant twist in the axes of M"},
               {"sinusoid", Nested{fieldBlock<kSinusoidFields>}, "",
                "Oscillation: (sin(2 pi frequency t + phase) - sin(phase)) times `amplitude` along the axis and `angle` about it"},
               {"waypoints", Nested{waypointKeys}, "", "Through the poses of a file; the object rests after the last one"},
               {"hand_held", Nested{fieldBlock<kHandHeldFields>}, "",
                "Motion of a hand: sums of sines with random frequencies and phases along and about x, y and z of M"}},
      .one_of = {"constant_twist", "sinusoid", "waypoints", "hand_held"}};
  return block;
}

const Block& contourKeys() {
  static const Block block{
      .name = "",
      .keys = {{"file", Text{"a CSV file of points"}, kNeeded, "Points in O; the last one is joined to the first"}, sha256Key()}};
  return block;
}

constexpr std::array<std::string_view, 8> kShapes{"mesh", "sphere", "cylinder", "capsule", "box", "half_space", "cone", "torus"};

KeyTable shapeKeys() {
  return {{"mesh", Text{"a mesh file"}, "", "OBJ, STL, PLY or GLB"},
          {"sphere", Nested{fieldBlock<kSphereFields>}, "", "Sphere, centred on the origin"},
          {"cylinder", Nested{fieldBlock<kCylinderFields>}, "", "Cylinder along z with flat ends, centred"},
          {"capsule", Nested{fieldBlock<kCapsuleFields>}, "", "Capsule along z, centred"},
          {"box", Nested{fieldBlock<kBoxFields>}, "", "Box, centred"},
          {"half_space", Nested{noKeys}, "", "All points with z >= 0"},
          {"cone", Nested{fieldBlock<kConeFields>}, "", "Cone with its apex at the origin and its base at z = height"},
          {"torus", Nested{fieldBlock<kTorusFields>}, "", "Torus about z"}};
}

Key objectNameKey() {
  return {"name", Text{"a name"}, "of the file or shape, with _2, _3, ... if taken", "Name, unlike those of the other objects"};
}

KeyTable meshKeys() {
  return joinKeys(KeyTable{{"motion", Nested{motionKeys}, "at rest", "Motion from the first pose"}}, keysOfFields(kMeshScaleFields),
                  KeyTable{upAxisKey()}, keysOfFields(kMeshErrorFields), KeyTable{sha256Key()});
}

}  // namespace

const Block& objectKeys() {
  static const Block block{
      .name = "object",
      .keys = joinKeys(
          shapeKeys(), KeyTable{objectNameKey()}, keysOfFields(kObjectFields),
          KeyTable{
              {"orientation", Nested{rotationKeys}, "identity", "Rotation before yaw and tilt; -z of the rotated object faces the skin"},
              {"edge", Numbers{Allowed::any(""), 3}, "none", "Direction in O of an edge or axis, for the exact edge angle"},
              {"contour", Nested{contourKeys}, "none", "A closed edge instead; episodes begin at random points of it, uniform in length"},
              {"anchor[_mm]", Numbers{Allowed::any("m"), 3}, "the lowest point", "Point in O that is placed at x and y"}},
          meshKeys()),
      .one_of = {kShapes.begin(), kShapes.end()}};
  return block;
}

const Block& placedObjectKeys() {
  static const Block block{
      .name = "placed_object",
      .keys = joinKeys(shapeKeys(), KeyTable{objectNameKey(), {"pose", Nested{poseKeys}, "identity", "X_WO, the pose at the start"}},
                       meshKeys()),
      .one_of = {kShapes.begin(), kShapes.end()}};
  return block;
}

}  // namespace taxelsim
