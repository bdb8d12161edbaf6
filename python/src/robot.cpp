// Robots with joints: where joint positions place their sensors and links.
#include "taxelsim/robot.h"

#include <nanobind/stl/array.h>
#include <nanobind/stl/filesystem.h>
#include <nanobind/stl/optional.h>
#include <nanobind/stl/pair.h>
#include <nanobind/stl/string.h>
#include <nanobind/stl/tuple.h>
#include <nanobind/stl/vector.h>
#include <spdlog/fmt/fmt.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <new>
#include <optional>
#include <string>
#include <tuple>
#include <utility>
#include <vector>

#include "bind.h"
#include "control/chain.h"
#include "control/link_frames.h"
#include "scene/robot_file.h"
#include "taxelsim/error.h"

namespace taxelsim::python {
namespace {

// Forward kinematics of the robot of a file. q: joint positions (num_joints), rad or m.
class RobotKinematics {
 public:
  explicit RobotKinematics(const std::filesystem::path& file) : loaded_(loadRobotFile(file)) {
    const auto* const found = std::get_if<Manipulator>(&loaded_.robot);
    if (found == nullptr) throw Error(ErrorKind::kInput, file.generic_string() + ": a free-flying sensor has no joints");
    robot_ = *found;
    if (!loaded_.urdf.empty()) links_ = linkFrames(loaded_.urdf, loaded_.base_link, robot_.joints);
  }

  const LoadedRobot& loaded() const { return loaded_; }
  const Manipulator& robot() const { return robot_; }
  const std::vector<MountedSensor>& links() const { return links_; }

  // X_WS (frames.size()).
  std::vector<Pose> posesOf(const std::vector<MountedSensor>& frames, const std::vector<double>& q) const {
    if (q.size() != robot_.joints.size() || !std::ranges::all_of(q, [](double value) { return std::isfinite(value); })) {
      throw Error(ErrorKind::kInput,
                  fmt::format("positions: {} numbers are not allowed: {} finite positions, rad or m", q.size(), robot_.joints.size()));
    }
    std::vector<Pose> poses;
    for (const MountedSensor& frame : frames) {
      poses.push_back(robot_.X_WB * Chain(frame, static_cast<int>(q.size())).poseAt(q.data()));
    }
    return poses;
  }

  // m, in W, of one sensor: the base, the joints of its chain, the sensor.
  std::vector<Vector3> chainPoints(const MountedSensor& sensor, const std::vector<double>& q) const {
    std::vector<MountedSensor> frames;
    for (std::size_t k = 0; k < sensor.chain.size(); ++k)
      frames.push_back({.link = {}, .chain = {sensor.chain.begin(), sensor.chain.begin() + k}, .X_JS = sensor.chain[k].X_PJ});
    frames.push_back(sensor);
    std::vector<Vector3> points{robot_.X_WB.position};
    for (const Pose& pose : posesOf(frames, q)) points.push_back(pose.position);
    return points;
  }

 private:
  LoadedRobot loaded_;
  Manipulator robot_;
  std::vector<MountedSensor> links_;
};

using JointRow = std::tuple<std::string, bool, double, double, double>;

std::vector<JointRow> jointRowsOf(const RobotKinematics& self) {
  std::vector<JointRow> joints;
  for (const Joint& joint : self.robot().joints)
    joints.emplace_back(joint.name, joint.type == JointType::kRevolute, joint.lower, joint.upper, joint.initial_position);
  return joints;
}

std::vector<std::pair<std::string, std::optional<Sensor>>> namedSensorsOf(const RobotKinematics& self) {
  const LoadedRobot& loaded = self.loaded();
  std::vector<std::pair<std::string, std::optional<Sensor>>> sensors;
  for (std::size_t s = 0; s < loaded.names.size(); ++s)
    sensors.emplace_back(loaded.names[s], loaded.sensors.empty() ? std::nullopt : std::optional(loaded.sensors[s].sensor));
  return sensors;
}

std::vector<std::string> linkNamesOf(const RobotKinematics& self) {
  std::vector<std::string> links;
  for (const MountedSensor& link : self.links()) links.push_back(link.link);
  return links;
}

}  // namespace

void bindRobot(nb::module_& module) {
  nb::class_<RobotKinematics>(
      module, "Robot", "Forward kinematics of the robot of a robot file, or of a scene. positions: (num_joints), rad or m. W: world.")
      .def(nb::init<const std::filesystem::path&>(), "file"_a,
           "Reads the robot. Raises InputError for a file without one, and for a free-flying sensor, which has no joints.")
      .def_prop_ro("joints", &jointRowsOf,
                   "Name, whether it is revolute, lower and upper limit, and initial position (rad or m) of each joint.")
      .def_prop_ro("sensors", &namedSensorsOf, "Name and Sensor of each mount; None for a mount that names no sensor file.")
      .def_prop_ro(
          "urdf", [](const RobotKinematics& self) { return self.loaded().urdf.empty() ? std::nullopt : std::optional(self.loaded().urdf); },
          "The URDF that describes its links; None without one.")
      .def_prop_ro("links", &linkNamesOf, "Names of all links of the URDF; empty without one.")
      .def(
          "sensor_poses", [](const RobotKinematics& self, const std::vector<double>& q) { return self.posesOf(self.robot().sensors, q); },
          "positions"_a, "X_WS of each sensor. Raises InputError for another number of positions, or one that is not finite.")
      .def(
          "link_poses", [](const RobotKinematics& self, const std::vector<double>& q) { return self.posesOf(self.links(), q); },
          "positions"_a, "X_WL of each link. Joints that move no sensor stay at position 0. Raises as sensor_poses().")
      .def(
          "chain_points",
          [](const RobotKinematics& self, const std::vector<double>& q) {
            std::vector<std::vector<Vector3>> points;
            for (const MountedSensor& sensor : self.robot().sensors) points.push_back(self.chainPoints(sensor, q));
            return points;
          },
          "positions"_a, "Points of W (m) for each sensor: the base, each joint on the way, and the sensor. Raises as sensor_poses().");
  module.def("is_scene_file", &isSceneFile, "file"_a,
             "Whether a YAML file is a scene. Raises InputError for one that is missing or malformed.");
}

}  // namespace taxelsim::python
