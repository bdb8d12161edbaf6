#include "episodes/grasp_batch.h"

#include <algorithm>
#include <array>
#include <limits>
#include <numeric>

#include "base/philox.h"
#include "episodes/draw.h"

namespace taxelsim {
namespace {

std::vector<Object> objectsOf(const Scene& scene) {
  std::vector<Object> objects;
  for (const SceneObject& object : scene.objects) objects.push_back(object.object);
  return objects;
}

// The outputs that the control laws read, in addition to those of the caller.
OutputOptions controlOutputs(OutputOptions outputs, const Grasp& grasp) {
  outputs.tactile_jacobian = true;
  outputs.contact_features = outputs.contact_features || (grasp.servo && needsContactFeatures(grasp.servo->servo));
  return outputs;
}

}  // namespace

double closingSpeed(double force, double target, double slope, double gain, double disturbance) {
  const double error = target - force;
  if (slope > 0) return std::clamp((gain * error - disturbance) / slope, -1.0, 1.0);
  return error > 0 ? 1 : error < 0 ? -1 : 0;
}

GraspBatch::GraspBatch(const Device& device, const Scene& scene, const OutputOptions& outputs, int num_instances, Joints joints)
    : scene_(scene),
      grasp_(*scene.grasp),
      dt_(1 / scene.simulation_rate),
      robots_(device, std::get<Manipulator>(scene.robot), grasp_.sensors, objectsOf(scene),
              {.num_instances = num_instances,
               .seed = scene.seed,
               .outputs = joints == Joints::kByLaw ? controlOutputs(outputs, grasp_) : outputs,
               .max_regions = numRegions(scene)}) {
  const auto size = static_cast<std::size_t>(num_instances);
  frames_.assign(size, -1);
  episodes_.resize(size);
  X_WO_.resize(size * scene.objects.size());
  trajectories_.resize(X_WO_.size());
  variations_.resize(size * grasp_.sensors.size());
  target_forces_.resize(size * grasp_.fingers.size());
  touched_.resize(target_forces_.size());
  nearest_.resize(target_forces_.size());
  for (const GraspFinger& finger : grasp_.fingers)
    clearances_.emplace_back(grasp_.sensors[static_cast<std::size_t>(finger.sensor)].sensor, scene.objects);
  velocities_.resize(size * static_cast<std::size_t>(robots_.robots().numJoints()));
  arm_velocities_.resize(velocities_.size());
  if (grasp_.servo) servo_.emplace(*grasp_.servo, grasp_.sensors, robots_.robots().numJoints(), num_instances);
  no_twists_.resize(size);
  by_joints_.assign(size, 1);
}

void GraspBatch::begin(std::uint64_t first, int count) {
  std::vector<std::uint64_t> episodes(static_cast<std::size_t>(count));
  std::iota(episodes.begin(), episodes.end(), first);
  begin(episodes);
}

void GraspBatch::begin(std::span<const std::uint64_t> episodes) {
  if (servo_) servo_->begin();
  for (int i = 0; i < numInstances(); ++i) start(i, episodes[std::min(static_cast<std::size_t>(i), episodes.size() - 1)]);
}

void GraspBatch::start(int i, std::uint64_t episode) {
  const auto instance = static_cast<std::size_t>(i);
  const std::size_t num_fingers = grasp_.fingers.size();
  frames_[instance] = -1;
  episodes_[instance] = episode;
  EpisodeRandom random(scene_.seed, episode);
  const double factor = random.uniform(1 - grasp_.force_spread, 1 + grasp_.force_spread);
  for (std::size_t k = 0; k < scene_.objects.size(); ++k) {
    const Pose& X = scene_.objects[k].pose;
    std::array<double, 3> offset{};
    for (double& value : offset) value = random.uniform(-grasp_.offset, grasp_.offset);
    const Quaternion yaw = axisAngle({0, 0, 1}, random.uniform(-grasp_.yaw, grasp_.yaw));
    const std::size_t slot = instance * scene_.objects.size() + k;
    X_WO_[slot] = {{X.position[0] + offset[0], X.position[1] + offset[1], X.position[2] + offset[2]}, yaw * X.rotation};
    trajectories_[slot].reset();
    const MotionKey key{.seed = scene_.seed, .episode = episode, .slot = static_cast<std::uint32_t>(k)};
    if (const std::optional<Motion>& motion = scene_.objects[k].motion) trajectories_[slot].emplace(*motion, X_WO_[slot], key);
  }
  for (std::size_t f = instance * num_fingers; f < (instance + 1) * num_fingers; ++f) {
    target_forces_[f] = factor * grasp_.fingers[f % num_fingers].force;
    touched_[f] = 0;
    nearest_[f] = std::numeric_limits<double>::infinity();
  }
  const auto num_sensors = static_cast<std::size_t>(robots_.numSensors());
  const std::span<ReadoutVariation> variations = std::span(variations_).subspan(instance * num_sensors, num_sensors);
  const Randomization& ranges = scene_.randomization;
  for (ReadoutVariation& variation : variations) {
    variation.gain = static_cast<float>(random.uniform(ranges.gain.min, ranges.gain.max));
    variation.gain_spread = static_cast<float>(random.uniform(ranges.gain_spread.min, ranges.gain_spread.max));
    variation.noise = static_cast<float>(random.uniform(ranges.noise.min, ranges.noise.max));
  }
  robots_.reset(i, episode, variations);
}

void GraspBatch::step() {
  if (frames_.front() >= 0) command();
  computeFrame({});
}

void GraspBatch::step(std::span<const double> velocities) {
  robots_.robots().command(no_twists_, velocities, by_joints_, dt_);
  computeFrame({});
}

void GraspBatch::firstFrames(std::span<const std::uint8_t> instances) {
  computeFrame(instances);
}

void GraspBatch::computeFrame(std::span<const std::uint8_t> instances) {
  const std::size_t num_objects = scene_.objects.size();
  for (int i = 0; i < numInstances(); ++i) {
    const auto instance = static_cast<std::size_t>(i);
    if (!instances.empty() && !instances[instance]) continue;
    ++frames_[instance];
    for (std::size_t slot = instance * num_objects; slot < (instance + 1) * num_objects; ++slot) {
      if (trajectories_[slot]) X_WO_[slot] = trajectories_[slot]->at(time(i));
    }
  }
  robots_.step(dt_, X_WO_, instances);
  noteContacts(instances);
}

// Distances in some frames suffice for a message.
void GraspBatch::noteContacts(std::span<const std::uint8_t> instances) {
  constexpr int kPeriod = 16;
  const auto num_sensors = static_cast<std::size_t>(robots_.numSensors());
  const std::size_t num_fingers = grasp_.fingers.size(), num_objects = scene_.objects.size();
  for (std::size_t k = 0; k < touched_.size(); ++k) {
    const std::size_t instance = k / num_fingers, finger = k % num_fingers;
    if (!instances.empty() && !instances[instance]) continue;
    const int sensor = grasp_.fingers[finger].sensor;
    touched_[k] |= robots_.frame(sensor).ground_truth.total_force[robots_.row(sensor, static_cast<int>(instance))] > 0;
    if (touched_[k] || frames_[instance] % kPeriod != 0) continue;
    const Pose X_SW = inverse(robots_.robots().X_WS()[instance * num_sensors + static_cast<std::size_t>(sensor)]);
    for (std::size_t object = 0; object < num_objects; ++object)
      nearest_[k] = std::min(nearest_[k], clearances_[finger].of(object, X_SW * X_WO_[instance * num_objects + object]));
  }
}

void GraspBatch::addMisses(int count, std::span<ContactMisses> misses) const {
  for (std::size_t k = 0; k < static_cast<std::size_t>(count) * misses.size(); ++k) {
    ContactMisses& of_finger = misses[k % misses.size()];
    ++of_finger.num_episodes;
    if (touched_[k]) continue;
    ++of_finger.num_misses;
    of_finger.nearest = std::min(of_finger.nearest, nearest_[k]);
  }
}

// N/s: change of the total force that a sensor reads, by its measured tactile Jacobian.
double GraspBatch::forceRate(int instance, int sensor, std::span<const double> joint_velocities) const {
  const Twist twist = robots_.robots().twistOf(instance, sensor, joint_velocities);
  const FrameView& frame = robots_.frame(sensor);
  const float* const by_twist =
      &frame.jacobian.total_force[robots_.row(sensor, instance) * static_cast<std::size_t>(frame.jacobian.num_rows) * 6];
  double rate = 0;
  for (std::size_t k = 0; k < 3; ++k) rate += by_twist[k] * twist.v[k] + by_twist[3 + k] * twist.w[k];
  return rate;
}

// Moves arm and fingers by one frame, from the forces and the tactile Jacobians of the last one.
void GraspBatch::command() {
  Robots& robots = robots_.robots();
  const auto num_joints = static_cast<std::size_t>(robots.numJoints());
  if (servo_) servo_->command(robots_, dt_, arm_velocities_);
  std::array<double, kMaxJoints> closing;
  for (int i = 0; i < numInstances(); ++i) {
    const std::span<const double> arm =
        std::span<const double>(arm_velocities_).subspan(static_cast<std::size_t>(i) * num_joints, num_joints);
    double* const velocities = velocities_.data() + static_cast<std::size_t>(i) * num_joints;
    std::copy(arm.begin(), arm.end(), velocities);
    for (std::size_t f = 0; f < grasp_.fingers.size(); ++f) {
      const GraspFinger& finger = grasp_.fingers[f];
      closing.fill(0);
      for (const FingerJoint& joint : finger.joints) closing[static_cast<std::size_t>(joint.joint)] = joint.velocity;
      const double slope = forceRate(i, finger.sensor, std::span(closing).first(num_joints));
      const double target = target_forces_[static_cast<std::size_t>(i) * grasp_.fingers.size() + f];
      const double force = robots_.frame(finger.sensor).total_force[robots_.row(finger.sensor, i)];
      const double speed = closingSpeed(force, target, slope, grasp_.gain, servo_ ? forceRate(i, finger.sensor, arm) : 0);
      for (const FingerJoint& joint : finger.joints) velocities[joint.joint] = speed * joint.velocity;
    }
  }
  robots.command(no_twists_, velocities_, by_joints_, dt_);
}

}  // namespace taxelsim
