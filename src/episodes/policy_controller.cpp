#include "episodes/policy_controller.h"

#include <algorithm>
#include <limits>
#include <string>

#include "base/constants.h"
#include "episodes/environment_view.h"
#include "scene/scene_checks.h"
#include "taxelsim/error.h"

namespace taxelsim {
namespace {

// A row that the policy does not write is refused like any other value that is not finite.
constexpr Twist kUnwrittenTwist{.v = {kNaN, kNaN, kNaN}, .w = {kNaN, kNaN, kNaN}};

[[noreturn]] void refuse(const Policy& policy, const std::string& reason) {
  throw Error(ErrorKind::kInput, "policy " + policy.name + ": " + reason);
}

}  // namespace

void checkPolicy(const Policy& policy, const Scene& scene) {
  if (policy.name.empty()) throw Error(ErrorKind::kInput, "policy: the name is empty");
  const auto has_name = [&](const SceneController& controller) { return controller.name == policy.name; };
  if (std::any_of(scene.controllers.begin(), scene.controllers.end(), has_name)) {
    refuse(policy, "a controller of the scene has the same name");
  }
  if (scene.kind != Scene::Kind::kServo && scene.kind != Scene::Kind::kGrasp) {
    refuse(policy, "the scene has kind " + wordOf(scene.kind) + ", a policy needs servo or grasp");
  }
  if (policy.max_regions != 0 && !hasContactFeatures(policy.outputs)) {
    refuse(policy, "max_regions: " + std::to_string(policy.max_regions) + " is not allowed: 0 without contact features");
  }
  if (scene.grasp) {
    if (!policy.act_grasp || policy.act || policy.act_joints) refuse(policy, "act_grasp alone must be set in a scene of kind grasp");
    return;
  }
  if (!policy.act == !policy.act_joints || policy.act_grasp) refuse(policy, "exactly one of act and act_joints must be set");
  if (policy.act_joints && numJoints(scene) == 0) refuse(policy, "act_joints is set, but the robot of the scene has no joints");
}

PolicyController::PolicyController(const Policy& policy, const EpisodePlan& plan, int num_instances, int first_instance)
    : policy_(policy), first_instance_(first_instance), exploration_velocity_(num_instances, 0.0) {
  due_.reserve(static_cast<std::size_t>(num_instances));
  if (policy.act) {
    twists_.resize(static_cast<std::size_t>(num_instances));
  } else {
    joint_velocities_.resize(static_cast<std::size_t>(num_instances) * static_cast<std::size_t>(plan.num_joints));
  }
}

void PolicyController::start(int instance, const EpisodeDraw& draw) {
  exploration_velocity_[instance] = draw.exploration_velocity.value_or(0);
}

void PolicyController::describe(int instance, EpisodeRecord& record) const {
  record.controller = kPolicyActs;
  record.exploration_velocity = static_cast<float>(exploration_velocity_[instance]);
}

void PolicyController::command(EpisodeBatch& batch) {
  due_.clear();
  for (int i = 0; i < batch.numInstances(); ++i) {
    if (batch.controlDue()[i]) due_.push_back(i);
  }
  if (due_.empty()) return;
  const PolicyInput input{.view = viewOf(batch), .instances = due_, .first_instance = first_instance_};
  std::fill(twists_.begin(), twists_.end(), kUnwrittenTwist);
  std::fill(joint_velocities_.begin(), joint_velocities_.end(), kNaN);
  if (policy_.act) {
    policy_.act(input, twists_);
  } else {
    policy_.act_joints(input, joint_velocities_);
  }
  try {
    if (policy_.act) {
      batch.checkActions(twists_, first_instance_);
    } else {
      batch.checkJointActions(joint_velocities_, first_instance_);
    }
  } catch (const Error& error) {
    refuse(policy_, error.what());
  }
  if (policy_.act) {
    batch.act(twists_);
  } else {
    batch.actJoints(joint_velocities_);
  }
}

}  // namespace taxelsim
