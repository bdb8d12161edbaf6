#include "episodes/servo_controller.h"

#include "episodes/sensor_features.h"

namespace taxelsim {
namespace {

std::vector<TactileServo> servosOf(const Scene& scene) {
  std::vector<TactileServo> servos;
  for (const SceneController& controller : scene.controllers) servos.push_back(controller.servo);
  return servos;
}

}  // namespace

ServoPlan::ServoPlan(const Scene& scene, std::optional<int> fixed_servo) : servo(fixed_servo) {
  for (int c = 0; c < static_cast<int>(scene.controllers.size()); ++c) {
    if (servo && *servo != c) continue;
    const TactileServo& candidate = scene.controllers[static_cast<std::size_t>(c)].servo;
    needs_contact_features = needs_contact_features || needsContactFeatures(candidate);
    needs_jacobian = needs_jacobian || needsTactileJacobian(candidate);
    needs_true_angle = needs_true_angle || candidate.edge_angle_source == EdgeAngleSource::kExact;
  }
}

void ServoPlan::addOutputs(OutputOptions& outputs) const {
  outputs.contact_features = outputs.contact_features || needs_contact_features;
  outputs.tactile_jacobian = outputs.tactile_jacobian || needs_jacobian;
}

ServoController::ServoController(const ServoPlan& servos, const EpisodePlan& episodes, int num_instances)
    : servos_(servos),
      controller_(servosOf(episodes.scene), episodes.scene.sensor, num_instances),
      servo_of_(num_instances, 0),
      twists_(num_instances),
      true_angles_(servos.needs_true_angle ? num_instances : 0) {}

void ServoController::start(int instance, const EpisodeDraw& draw) {
  servo_of_[instance] = servos_.servo.value_or(draw.controller);
  twists_[instance] = {};
  controller_.reset(instance, servo_of_[instance], draw.exploration_velocity);
}

void ServoController::describe(int instance, EpisodeRecord& record) const {
  record.controller = servo_of_[instance];
  record.exploration_velocity = static_cast<float>(controller_.explorationVelocity(instance));
}

void ServoController::command(EpisodeBatch& batch) {
  const EpisodePlan& plan = batch.plan();
  if (servos_.needs_true_angle) {
    for (int i = 0; i < batch.numInstances(); ++i) {
      if (!batch.controlDue()[i]) continue;
      const TrueEdge& edge = plan.edges[static_cast<std::size_t>(batch.draw(i).object)];
      true_angles_[i] = static_cast<float>(edge.project(batch.X_SO()[i * plan.num_sensors]).angle);
    }
  }
  ServoInput input = featuresOfSensor(batch.frame(), plan.num_sensors, 0, servos_.needs_contact_features);
  input.exact_edge_angle = true_angles_;
  input.start_force = batch.startForces();
  input.due = batch.controlDue();
  batch.team().run(batch.numInstances(), [&](int first, int last) {
    controller_.command(input, plan.control_period * plan.dt, twists_, first, last);
    batch.act(twists_, first, last);
  });
}

}  // namespace taxelsim
