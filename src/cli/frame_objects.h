// Objects of `taxelsim frame`.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "taxelsim/object.h"
#include "taxelsim/pose.h"
#include "taxelsim/sensor.h"

namespace taxelsim::cli {

// Arguments that describe objects and their poses, as given.
struct ObjectArguments {
  std::vector<std::string> objects, poses, rotations;  // --object, --pose, --rpy-deg
  std::optional<double> load;                          // N
  std::string slide;                                   // --slide, empty for none
  MeshOptions mesh;
  bool has_mesh_options = false;  // --scale or --up-axis
};

// An object, and its pose in S; if the pose is not given, at rest on the plane z = 0 of S, with its lowest point in the origin.
class ObjectPlan {
 public:
  // Checks counts, poses and load; opens no file. Throws Error(kInput).
  explicit ObjectPlan(const ObjectArguments& arguments);

  // Reads the objects, meshes with the error that suits the sensor. Throws Error(kInput) if there are options of meshes but no mesh.
  std::vector<Object> loadObjects(const Sensor& sensor) const;
  // Poses of these objects.
  std::vector<Pose> posesOf(const std::vector<Object>& objects) const;

 private:
  const ObjectArguments& arguments_;
  std::vector<Pose> X_SO_;
  bool has_positions_;
};

}  // namespace taxelsim::cli
