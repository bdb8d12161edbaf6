#include "cli/frame_objects.h"

#include <spdlog/fmt/fmt.h>

#include <cmath>

#include "cli/pose_argument.h"
#include "taxelsim/error.h"
#include "taxelsim/simulator.h"

namespace taxelsim::cli {
namespace {

[[noreturn]] void failArgument(const std::string& message) {
  throw Error(ErrorKind::kInput, message);
}

void checkCounts(const ObjectArguments& arguments) {
  const std::size_t num_objects = arguments.objects.size(), num_poses = arguments.poses.size(), num_rotations = arguments.rotations.size();
  if (num_objects == 0) failArgument("--object with --pose or --load, or --contacts, is required");
  if (num_objects > static_cast<std::size_t>(kMaxSlots))
    failArgument(fmt::format("{} --object: a sensor can touch at most {}", num_objects, kMaxSlots));
  if (num_poses != num_objects && !(num_poses == 0 && num_objects == 1)) {
    failArgument(fmt::format("{} --object but {} --pose: each object needs its pose, in the same order", num_objects, num_poses));
  }
  if (num_rotations != 0 && num_rotations != num_objects) {
    failArgument(
        fmt::format("{} --object but {} --rpy-deg: give none, or one for each object, in the same order", num_objects, num_rotations));
  }
  if (num_poses == 0 && !arguments.load) {
    failArgument(
        "--pose is missing: \"x y z\" or \"x y z qw qx qy qz\" of the object in the sensor frame, m and a unit quaternion; only with "
        "--load "
        "an object has a default");
  }
}

}  // namespace

ObjectPlan::ObjectPlan(const ObjectArguments& arguments) : arguments_(arguments), has_positions_(!arguments.poses.empty()) {
  checkCounts(arguments);
  if (arguments.load && !(std::isfinite(*arguments.load) && *arguments.load >= 0)) {
    failArgument(fmt::format("--load {}: must be a force of 0 N or more", *arguments.load));
  }
  X_SO_.resize(arguments.objects.size());
  for (std::size_t i = 0; i < arguments.poses.size(); ++i) {
    const PoseArgument pose = parsePose(arguments.poses[i]);
    if (pose.rotation && !arguments.rotations.empty()) {
      failArgument(fmt::format("--pose \"{}\" has a rotation: --rpy-deg excludes it", arguments.poses[i]));
    }
    X_SO_[i].position = pose.position;
    if (pose.rotation) X_SO_[i].rotation = *pose.rotation;
  }
  for (std::size_t i = 0; i < arguments.rotations.size(); ++i) X_SO_[i].rotation = parseRollPitchYaw(arguments.rotations[i]);
}

std::vector<Object> ObjectPlan::loadObjects(const Sensor& sensor) const {
  std::vector<Object> objects;
  MeshOptions mesh = arguments_.mesh;
  mesh.max_depth_error = maxDepthErrorOf(sensor.skin);
  bool any_mesh = false;
  for (const std::string& text : arguments_.objects) {
    objects.push_back(parseObject(text, mesh));
    any_mesh = any_mesh || std::holds_alternative<Mesh>(objects.back().shape);
  }
  if (arguments_.has_mesh_options && !any_mesh)
    failArgument("--scale and --up-axis belong to mesh files; the sizes of solids are in metres");
  return objects;
}

std::vector<Pose> ObjectPlan::posesOf(const std::vector<Object>& objects) const {
  std::vector<Pose> X_SO = X_SO_;
  for (std::size_t i = 0; i < objects.size() && !has_positions_; ++i) {
    const Vector3 lowest = rotate(X_SO[i].rotation, lowestPoint(objects[i], X_SO[i].rotation));
    X_SO[i].position = {-lowest[0], -lowest[1], -lowest[2]};
  }
  return X_SO;
}

}  // namespace taxelsim::cli
