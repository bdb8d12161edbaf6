// Commands a slice by the tactile servos of the scene.
#pragma once

#include <optional>
#include <vector>

#include "control/tactile_servo.h"
#include "episodes/controller.h"

namespace taxelsim {

// The servos that a run uses, and what they read.
struct ServoPlan {
  // fixed_servo: index of the scene's controller for all episodes, instead of the drawn one.
  explicit ServoPlan(const Scene& scene, std::optional<int> fixed_servo = {});

  // Adds the outputs that the servos read.
  void addOutputs(OutputOptions& outputs) const;

  std::optional<int> servo;
  bool needs_contact_features = false;
  bool needs_jacobian = false;
  bool needs_true_angle = false;
};

class ServoController : public Controller {
 public:
  ServoController(const ServoPlan& servos, const EpisodePlan& episodes, int num_instances);

  void start(int instance, const EpisodeDraw& draw) override;
  void command(EpisodeBatch& batch) override;
  void describe(int instance, EpisodeRecord& record) const override;

 private:
  const ServoPlan servos_;
  TactileServoController controller_;

  // (num_instances)
  std::vector<int> servo_of_;  // index of the scene's controller
  std::vector<Twist> twists_;
  std::vector<float> true_angles_;  // rad; empty if no servo reads them
};

}  // namespace taxelsim
