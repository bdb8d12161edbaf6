#include <algorithm>
#include <cmath>
#include <map>

#include "base/text.h"
#include "base/vector3.h"
#include "control/urdf_model.h"
#include "control/values.h"
#include "taxelsim/robot.h"

namespace taxelsim {
namespace {

constexpr std::size_t kMaxNamesShown = 10;

// A joint that follows another one, or itself: it stands at multiplier q + offset.
struct Following {
  const urdf::Joint* leader;
  double multiplier = 1;
  double offset = 0;
};

Pose poseOf(const KDL::Frame& frame) {
  Pose X{{frame.p.x(), frame.p.y(), frame.p.z()}, {}};
  frame.M.GetQuaternion(X.rotation[1], X.rotation[2], X.rotation[3], X.rotation[0]);
  return X;
}

// The shortest turn that takes z to `axis` (of unit length).
Quaternion turnToAxis(const Vector3& axis) {
  if (axis[2] < -0.5) {
    // By way of -z, where the shortest turn is none in particular: half a turn about x, then the rest.
    const Quaternion rest = turnToAxis({axis[0], -axis[1], -axis[2]});
    return Quaternion{0, 1, 0, 0} * rest;
  }
  const Vector3 z{0, 0, 1};
  const Vector3 across = cross(z, axis);
  return Quaternion{1 + axis[2], across[0], across[1], across[2]} * Quaternion{1, 0, 0, 0};  // normalised
}

class UrdfRobot {
 public:
  UrdfRobot(const std::filesystem::path& file, const UrdfOptions& options) : model_(file), options_(options) {}

  Manipulator build();

 private:
  void requireLink(const std::string& link) const;
  MountedSensor sensorOn(const std::string& base, const SensorMount& mount);
  Following followingOf(const urdf::Joint& joint) const;
  int indexOf(const urdf::Joint& joint);
  void narrow(Joint& leader, const urdf::Joint& joint, const Following& following) const;
  void check(const urdf::Joint& joint) const;

  UrdfModel model_;
  const UrdfOptions& options_;
  Manipulator robot_;
  std::map<std::string, int> indices_;  // of joints that lead
};

void UrdfRobot::requireLink(const std::string& link) const {
  if (model_.urdf().links_.count(link) > 0) return;
  std::string names;
  std::size_t num_names = 0;
  for (const auto& [name, unused] : model_.urdf().links_) {
    if (num_names++ == kMaxNamesShown) break;
    names += (names.empty() ? "" : ", ") + name;
  }
  if (num_names > kMaxNamesShown) names += ", ...";
  model_.fail("no link " + link + ": it has " + names);
}

void UrdfRobot::check(const urdf::Joint& joint) const {
  const auto require = [&](bool holds, const std::string& field, double value, const std::string& allowed) {
    if (!holds) model_.fail("joint " + joint.name + ": " + field + ": " + numberText(value) + " is not allowed: " + allowed);
  };
  if (joint.type == urdf::Joint::FLOATING || joint.type == urdf::Joint::PLANAR) {
    model_.fail("joint " + joint.name + " is " + (joint.type == urdf::Joint::PLANAR ? "planar" : "floating") +
                ": revolute, continuous, prismatic or fixed is allowed on the way to a sensor");
  }
  const urdf::Vector3& p = joint.parent_to_joint_origin_transform.position;
  const urdf::Rotation& q = joint.parent_to_joint_origin_transform.rotation;
  for (const double value : {p.x, p.y, p.z, q.x, q.y, q.z, q.w}) require(std::isfinite(value), "origin", value, "finite numbers");
  if (joint.type == urdf::Joint::FIXED) return;
  const double axis = length({joint.axis.x, joint.axis.y, joint.axis.z});
  require(isPositive(axis), "axis", axis, "a vector of finite length > 0");
  if (joint.limits) {
    const urdf::JointLimits& limits = *joint.limits;
    require(std::isfinite(limits.lower), "limit lower", limits.lower, "a finite position");
    require(std::isfinite(limits.upper), "limit upper", limits.upper, "a finite position");
    require(limits.lower <= limits.upper, "limit lower", limits.lower, "at most upper (" + numberText(limits.upper) + ")");
    require(isPositive(limits.velocity), "limit velocity", limits.velocity, "a velocity > 0");
  }
}

Following UrdfRobot::followingOf(const urdf::Joint& joint) const {
  Following following{&joint};
  for (std::size_t steps = 0; following.leader->mimic; ++steps) {
    const urdf::JointMimic& mimic = *following.leader->mimic;
    if (steps > model_.urdf().joints_.size()) model_.fail("joint " + joint.name + ": mimic: it follows itself");
    if (!std::isfinite(mimic.multiplier) || !std::isfinite(mimic.offset)) {
      model_.fail("joint " + joint.name + ": mimic: finite multiplier and offset are allowed");
    }
    const urdf::JointConstSharedPtr next = model_.urdf().getJoint(mimic.joint_name);
    if (!next) model_.fail("joint " + following.leader->name + ": mimic: no joint " + mimic.joint_name + ", which it follows");
    if (next->type == urdf::Joint::FIXED)
      model_.fail("joint " + following.leader->name + ": mimic: joint " + next->name + ", which it follows, is fixed");
    following = {next.get(), following.multiplier * mimic.multiplier, following.multiplier * mimic.offset + following.offset};
    check(*next);
  }
  return following;
}

// Where the leader may be for `joint` to keep its own limits.
void UrdfRobot::narrow(Joint& leader, const urdf::Joint& joint, const Following& following) const {
  if (!joint.limits || following.multiplier == 0) return;
  leader.max_velocity =
      std::min(leader.max_velocity, options_.velocity_limit_scale * joint.limits->velocity / std::abs(following.multiplier));
  if (joint.type == urdf::Joint::CONTINUOUS) return;
  const double a = (joint.limits->lower - following.offset) / following.multiplier;
  const double b = (joint.limits->upper - following.offset) / following.multiplier;
  leader.lower = std::max(leader.lower, std::min(a, b));
  leader.upper = std::min(leader.upper, std::max(a, b));
  if (leader.lower > leader.upper) {
    model_.fail("joint " + joint.name + ": no position of joint " + leader.name + ", which it follows, is within the limits of both");
  }
  leader.initial_position = std::clamp(0.0, leader.lower, leader.upper);
}

int UrdfRobot::indexOf(const urdf::Joint& joint) {
  const auto [place, is_new] = indices_.emplace(joint.name, static_cast<int>(robot_.joints.size()));
  if (is_new) {
    if (place->second == kMaxJoints) model_.fail("more than " + std::to_string(kMaxJoints) + " joints move the sensors");
    robot_.joints.push_back(
        {.name = joint.name, .type = joint.type == urdf::Joint::PRISMATIC ? JointType::kPrismatic : JointType::kRevolute});
    narrow(robot_.joints.back(), joint, {&joint});
  }
  return place->second;
}

// Each joint's frame is turned so that its axis is z; what is fixed behind it belongs to the next one.
MountedSensor UrdfRobot::sensorOn(const std::string& base, const SensorMount& mount) {
  requireLink(mount.link);
  KDL::Chain chain;
  if (!model_.tree().getChain(base, mount.link, chain)) model_.fail("no way from link " + base + " to link " + mount.link);
  MountedSensor sensor{.link = mount.link, .chain = {}, .X_JS = {}};
  Pose X_PL;  // the link so far, behind the last joint
  for (const KDL::Segment& segment : chain.segments) {
    const KDL::Joint& joint = segment.getJoint();
    const urdf::JointConstSharedPtr urdf_joint = model_.urdf().getJoint(joint.getName());
    check(*urdf_joint);
    const Pose X_LN = poseOf(segment.pose(0));  // the next link
    if (urdf_joint->type == urdf::Joint::FIXED) {
      X_PL = X_PL * X_LN;
      continue;
    }
    if (sensor.chain.size() == static_cast<std::size_t>(kMaxChainJoints)) {
      model_.fail("more than " + std::to_string(kMaxChainJoints) + " joints on the way to link " + mount.link);
    }
    const Following following = followingOf(*urdf_joint);
    const int index = indexOf(*following.leader);
    narrow(robot_.joints[index], *urdf_joint, following);
    const KDL::Vector origin = joint.JointOrigin(), axis = joint.JointAxis();
    const Pose X_LJ{{origin.x(), origin.y(), origin.z()}, turnToAxis(unit({axis.x(), axis.y(), axis.z()}))};
    sensor.chain.push_back({.X_PJ = X_PL * X_LJ,
                            .type = urdf_joint->type == urdf::Joint::PRISMATIC ? JointType::kPrismatic : JointType::kRevolute,
                            .joint = index,
                            .multiplier = following.multiplier,
                            .offset = following.offset});
    X_PL = inverse(X_LJ) * X_LN;
  }
  sensor.X_JS = X_PL * mount.X_LS;
  return sensor;
}

Manipulator UrdfRobot::build() {
  robot_.name = model_.urdf().getName();
  const std::string base = options_.base_link.empty() ? model_.urdf().getRoot()->name : options_.base_link;
  requireLink(base);
  for (const SensorMount& mount : options_.sensors) robot_.sensors.push_back(sensorOn(base, mount));
  if (robot_.joints.empty()) model_.fail("no joint moves between link " + base + " and the sensors");
  checkRobot(robot_);
  return std::move(robot_);
}

}  // namespace

Manipulator loadUrdf(const std::filesystem::path& file, const UrdfOptions& options) {
  requireValue(options.velocity_limit_scale > 0 && options.velocity_limit_scale <= 1, "robot", "velocity_limit_scale",
               options.velocity_limit_scale, "a number > 0 and <= 1");
  requireValue(!options.sensors.empty(), "robot", "sensors", 0, "at least one");
  return UrdfRobot(file, options).build();
}

}  // namespace taxelsim
