#include <urdf_model/model.h>

#include <algorithm>
#include <cmath>
#include <kdl/tree.hpp>
#include <map>

#include "base/field_checks.h"
#include "base/vector3.h"
#include "control/link_frames.h"
#include "control/robot_fields.h"
#include "control/urdf_model.h"

namespace taxelsim {
namespace {

constexpr std::size_t kMaxNamesShown = 10;

// Position of a joint as multiplier q + offset, q being the position of `leader`. A joint that mimics no other is its own leader.
struct MimicRelation {
  const urdf::Joint* leader;
  double multiplier = 1;
  double offset = 0;
};

Pose poseOf(const KDL::Frame& frame) {
  Pose X{{frame.p.x(), frame.p.y(), frame.p.z()}, {}};
  frame.M.GetQuaternion(X.rotation[1], X.rotation[2], X.rotation[3], X.rotation[0]);
  return X;
}

// The rotation by the smallest angle that takes z to `axis` (of unit length).
Quaternion rotationFromZTo(const Vector3& axis) {
  if (axis[2] < -0.5) {
    // The smallest rotation is ill-conditioned near -z: rotate by 180 degrees about x first.
    const Quaternion remainder = rotationFromZTo({axis[0], -axis[1], -axis[2]});
    return Quaternion{0, 1, 0, 0} * remainder;
  }
  const Vector3 z{0, 0, 1};
  const Vector3 across = cross(z, axis);
  return Quaternion{1 + axis[2], across[0], across[1], across[2]} * Quaternion{1, 0, 0, 0};  // normalises
}

class UrdfRobot {
 public:
  UrdfRobot(const std::filesystem::path& file, const UrdfOptions& options) : model_(file), options_(options) {}

  Manipulator build();
  std::vector<MountedSensor> linkFrames(const std::vector<Joint>& joints);

 private:
  void requireLink(const std::string& link) const;
  std::string baseLink() const;
  MountedSensor sensorOn(const std::string& base, const SensorMount& mount);
  MimicRelation resolveMimic(const urdf::Joint& joint) const;
  int jointIndex(const urdf::Joint& joint);
  void applyLimits(Joint& leader, const urdf::Joint& joint, const MimicRelation& relation) const;
  bool isHeld(const urdf::Joint& joint) const;
  void check(const urdf::Joint& joint, bool is_held = false) const;

  UrdfModel model_;
  const UrdfOptions& options_;
  Manipulator robot_;
  std::map<std::string, int> indices_;  // by name, of joints in robot_.joints
  bool holds_others_ = false;           // whether joints without an index stay at position 0
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
  model_.fail("no link " + link + ": the links are " + names);
}

bool UrdfRobot::isHeld(const urdf::Joint& joint) const {
  return joint.type == urdf::Joint::FIXED || (holds_others_ && !indices_.contains(resolveMimic(joint).leader->name));
}

void UrdfRobot::check(const urdf::Joint& joint, bool is_held) const {
  const auto require = [&](bool holds, const std::string& field, double value, const std::string& allowed) {
    if (!holds) model_.fail("joint " + joint.name + ": " + field + ": " + numberText(value) + " is not allowed: " + allowed);
  };
  if (!is_held && (joint.type == urdf::Joint::FLOATING || joint.type == urdf::Joint::PLANAR)) {
    model_.fail("joint " + joint.name + " is " + (joint.type == urdf::Joint::PLANAR ? "planar" : "floating") +
                ": revolute, continuous, prismatic or fixed is allowed on the path to a sensor");
  }
  const urdf::Vector3& p = joint.parent_to_joint_origin_transform.position;
  const urdf::Rotation& q = joint.parent_to_joint_origin_transform.rotation;
  for (const double value : {p.x, p.y, p.z, q.x, q.y, q.z, q.w}) require(std::isfinite(value), "origin", value, "finite numbers");
  if (is_held || joint.type == urdf::Joint::FIXED) return;
  const double axis = length({joint.axis.x, joint.axis.y, joint.axis.z});
  require(std::isfinite(axis) && axis > 0, "axis", axis, "a vector of finite length > 0");
  if (joint.limits) {
    const urdf::JointLimits& limits = *joint.limits;
    require(std::isfinite(limits.lower), "limit lower", limits.lower, "a finite position");
    require(std::isfinite(limits.upper), "limit upper", limits.upper, "a finite position");
    require(limits.lower <= limits.upper, "limit lower", limits.lower, "at most upper (" + numberText(limits.upper) + ")");
    require(std::isfinite(limits.velocity) && limits.velocity > 0, "limit velocity", limits.velocity, "a velocity > 0");
  }
}

MimicRelation UrdfRobot::resolveMimic(const urdf::Joint& joint) const {
  MimicRelation relation{&joint};
  for (std::size_t steps = 0; relation.leader->mimic; ++steps) {
    const urdf::JointMimic& mimic = *relation.leader->mimic;
    if (steps > model_.urdf().joints_.size()) model_.fail("joint " + joint.name + ": mimic: the joint mimics itself");
    if (!std::isfinite(mimic.multiplier) || !std::isfinite(mimic.offset)) {
      model_.fail("joint " + joint.name + ": mimic: multiplier and offset must be finite");
    }
    const urdf::JointConstSharedPtr next = model_.urdf().getJoint(mimic.joint_name);
    if (!next) model_.fail("joint " + relation.leader->name + ": mimic: no joint " + mimic.joint_name + "");
    if (next->type == urdf::Joint::FIXED)
      model_.fail("joint " + relation.leader->name + ": mimic: joint " + next->name + " is fixed and cannot be mimicked");
    relation = {next.get(), relation.multiplier * mimic.multiplier, relation.multiplier * mimic.offset + relation.offset};
    check(*next);
  }
  return relation;
}

// Narrows the limits of the leader such that `joint` stays within its own.
void UrdfRobot::applyLimits(Joint& leader, const urdf::Joint& joint, const MimicRelation& relation) const {
  if (!joint.limits || relation.multiplier == 0) return;
  leader.max_velocity =
      std::min(leader.max_velocity, options_.velocity_limit_scale * joint.limits->velocity / std::abs(relation.multiplier));
  if (joint.type == urdf::Joint::CONTINUOUS) return;
  const double a = (joint.limits->lower - relation.offset) / relation.multiplier;
  const double b = (joint.limits->upper - relation.offset) / relation.multiplier;
  leader.lower = std::max(leader.lower, std::min(a, b));
  leader.upper = std::min(leader.upper, std::max(a, b));
  if (leader.lower > leader.upper) {
    model_.fail("joint " + joint.name + ": no position of joint " + leader.name + ", which it mimics, is within the limits of both");
  }
  leader.initial_position = std::clamp(0.0, leader.lower, leader.upper);
}

int UrdfRobot::jointIndex(const urdf::Joint& joint) {
  const auto [entry, is_new] = indices_.emplace(joint.name, static_cast<int>(robot_.joints.size()));
  if (is_new) {
    if (entry->second == kMaxJoints) model_.fail("more than " + std::to_string(kMaxJoints) + " joints on the paths to the sensors");
    robot_.joints.push_back(
        {.name = joint.name, .type = joint.type == urdf::Joint::PRISMATIC ? JointType::kPrismatic : JointType::kRevolute});
    applyLimits(robot_.joints.back(), joint, {&joint});
  }
  return entry->second;
}

// Builds the chain from `base` to the sensor. Joint frames J are rotated such that the joint's axis is z; fixed transforms are merged into
// the next joint.
MountedSensor UrdfRobot::sensorOn(const std::string& base, const SensorMount& mount) {
  requireLink(mount.link);
  KDL::Chain chain;
  if (!model_.tree().getChain(base, mount.link, chain)) model_.fail("no path from link " + base + " to link " + mount.link);
  MountedSensor sensor{.link = mount.link, .chain = {}, .X_JS = {}};
  Pose X_PL;  // current link in the frame that moves with the previous joint
  for (const KDL::Segment& segment : chain.segments) {
    const KDL::Joint& joint = segment.getJoint();
    const urdf::JointConstSharedPtr urdf_joint = model_.urdf().getJoint(joint.getName());
    const bool is_held = isHeld(*urdf_joint);
    check(*urdf_joint, is_held);
    const Pose X_LN = poseOf(segment.pose(0));  // next link in the current one
    if (is_held) {
      X_PL = X_PL * X_LN;
      continue;
    }
    if (sensor.chain.size() == static_cast<std::size_t>(kMaxChainJoints)) {
      model_.fail("more than " + std::to_string(kMaxChainJoints) + " joints on the path to link " + mount.link);
    }
    const MimicRelation relation = resolveMimic(*urdf_joint);
    const int index = jointIndex(*relation.leader);
    applyLimits(robot_.joints[index], *urdf_joint, relation);
    const KDL::Vector origin = joint.JointOrigin(), axis = joint.JointAxis();
    const Pose X_LJ{{origin.x(), origin.y(), origin.z()}, rotationFromZTo(unit({axis.x(), axis.y(), axis.z()}))};
    sensor.chain.push_back({.X_PJ = X_PL * X_LJ,
                            .type = urdf_joint->type == urdf::Joint::PRISMATIC ? JointType::kPrismatic : JointType::kRevolute,
                            .joint = index,
                            .multiplier = relation.multiplier,
                            .offset = relation.offset});
    X_PL = inverse(X_LJ) * X_LN;
  }
  sensor.X_JS = X_PL * mount.X_LS;
  return sensor;
}

std::string UrdfRobot::baseLink() const {
  const std::string base = options_.base_link.empty() ? model_.urdf().getRoot()->name : options_.base_link;
  requireLink(base);
  return base;
}

std::vector<MountedSensor> UrdfRobot::linkFrames(const std::vector<Joint>& joints) {
  holds_others_ = true;
  robot_.joints = joints;
  for (std::size_t j = 0; j < joints.size(); ++j) indices_.emplace(joints[j].name, static_cast<int>(j));
  const std::string base = baseLink();
  std::vector<MountedSensor> links;
  for (const auto& [name, unused] : model_.urdf().links_) links.push_back(sensorOn(base, {.link = name, .X_LS = {}}));
  return links;
}

Manipulator UrdfRobot::build() {
  robot_.name = model_.urdf().getName();
  const std::string base = baseLink();
  for (const SensorMount& mount : options_.sensors) robot_.sensors.push_back(sensorOn(base, mount));
  if (robot_.joints.empty()) model_.fail("no joint moves between link " + base + " and the sensors");
  checkRobot(robot_);
  return std::move(robot_);
}

}  // namespace

Manipulator loadUrdf(const std::filesystem::path& file, const UrdfOptions& options) {
  checkFields("", kUrdfFields, options);
  if (options.sensors.empty()) failField("sensors", "an empty list", "at least one sensor");
  return UrdfRobot(file, options).build();
}

std::vector<MountedSensor> linkFrames(const std::filesystem::path& file, const std::string& base_link, const std::vector<Joint>& joints) {
  const UrdfOptions options{.base_link = base_link, .sensors = {}};
  return UrdfRobot(file, options).linkFrames(joints);
}

}  // namespace taxelsim
