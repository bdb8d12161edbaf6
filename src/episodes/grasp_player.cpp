#include "episodes/grasp_player.h"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <string>

#include "base/constants.h"
#include "episodes/policy_controller.h"
#include "taxelsim/error.h"

namespace taxelsim {

GraspView viewOf(const GraspBatch& batch, const Scene& scene) {
  const SensedRobots& robots = batch.robots();
  GraspView view{.sensors = {},
                 .episodes = batch.episodes(),
                 .frame_numbers = batch.frames(),
                 .dt = batch.dt(),
                 .X_WO = batch.X_WO(),
                 .X_WS = robots.robots().X_WS(),
                 .joint_positions = robots.robots().jointPositions(),
                 .joint_velocities = robots.robots().jointVelocities(),
                 .robot_status = robots.robots().status(),
                 .target_forces = batch.targetForces()};
  for (const RobotSensor& sensor : scene.grasp->sensors) {
    const auto s = static_cast<int>(&sensor - scene.grasp->sensors.data());
    view.sensors.push_back({.sensor = &sensor, .frame = &robots.frame(s), .num_rows = robots.numRows(s), .first_row = robots.row(s, 0)});
  }
  return view;
}

int controlPeriod(const Scene& scene) {
  return static_cast<int>(std::lround(scene.simulation_rate / scene.control_rate));
}

void checkJointVelocities(const GraspBatch& batch, std::span<const double> velocities, std::span<const int> instances) {
  const auto num_joints = static_cast<std::size_t>(batch.robots().robots().numJoints());
  for (const int instance : instances) {
    const std::span<const double> row = velocities.subspan(static_cast<std::size_t>(instance) * num_joints, num_joints);
    const auto wrong = std::ranges::find_if(row, [](double value) { return !std::isfinite(value); });
    if (wrong == row.end()) continue;
    throw Error(ErrorKind::kInput, "joint velocities: " + std::to_string(*wrong) + " found in episode " +
                                       std::to_string(batch.episodes()[static_cast<std::size_t>(instance)]) + " (instance " +
                                       std::to_string(instance) + "), joint " + std::to_string(wrong - row.begin()) + "; must be finite");
  }
}

GraspPlayer::GraspPlayer(const Scene& scene, const std::optional<Policy>& policy) : scene_(scene), policy_(policy ? &*policy : nullptr) {
  if (policy) checkPolicy(*policy, scene);
}

OutputOptions GraspPlayer::outputs(const OutputOptions& caller) const {
  return policy_ ? caller | policy_->outputs : caller;
}

void GraspPlayer::step(GraspBatch& batch, int count) {
  if (policy_ == nullptr) return batch.step();
  const int frame = batch.frames().front();
  if (frame < 0) return batch.step();
  if (frame % controlPeriod(scene_) == 0) {
    const auto num_joints = static_cast<std::size_t>(batch.robots().robots().numJoints());
    velocities_.assign(static_cast<std::size_t>(batch.numInstances()) * num_joints, kNaN);
    instances_.resize(static_cast<std::size_t>(count));
    std::iota(instances_.begin(), instances_.end(), 0);
    policy_->act_grasp({.view = viewOf(batch, scene_), .instances = instances_}, velocities_);
    checkJointVelocities(batch, velocities_, instances_);
    const std::size_t num_values = static_cast<std::size_t>(count) * num_joints;
    for (std::size_t k = num_values; k < velocities_.size(); ++k) velocities_[k] = velocities_[k - num_joints];
  }
  batch.step(velocities_);
}

}  // namespace taxelsim
