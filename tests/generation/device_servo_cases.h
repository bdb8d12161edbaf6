// Scenes and servos for tests that compare loops on the device with those on the host.
#pragma once

#include "episodes/device_servos.h"
#include "episodes/example_scene.h"
#include "generation/columns.h"
#include "generation/generate_loops.h"
#include "support/test.h"

namespace taxelsim {

using Loops = SlicePlan::Loops;

inline constexpr double kDegree = std::numbers::pi / 180;

inline const Device& device() {
  static const Device opened = Device::open();
  return opened;
}

inline void generateWith(const Scene& scene, const std::filesystem::path& directory, int batch_size, int num_slices, Loops loops) {
  EXPECT_TRUE(
      generate(device(), scene, directory, {.batch_size = batch_size, .num_slices = num_slices, .on_progress = {}, .stop = nullptr}, loops)
          .complete);
}

inline void expectSameBytes(const Scene& scene, std::vector<std::pair<int, int>> batches = {{64, 2}}) {
  ASSERT_EQ(whyOnHost(SlicePlan(scene, outputsOf(scene))), "");
  const TestDirectory directory;
  const std::filesystem::path host = directory.path() / "host";
  generateWith(scene, host, 64, 1, Loops::kHost);
  for (const auto& [batch_size, num_slices] : batches) {
    const std::filesystem::path on_device = directory.path() / (std::to_string(batch_size) + "_" + std::to_string(num_slices));
    generateWith(scene, on_device, batch_size, num_slices, Loops::kDevice);
    int num_shards = 0;
    for (const auto& entry : std::filesystem::directory_iterator(host)) {
      if (entry.path().extension() != ".h5" || entry.path().stem() == "dataset") continue;
      ++num_shards;
      EXPECT_TRUE(testing::contentOf(entry.path()) == testing::contentOf(on_device / entry.path().filename()))
          << entry.path().filename() << " of " << on_device;
    }
    EXPECT_GT(num_shards, 0);
    std::filesystem::remove_all(on_device);
  }
}

inline FeatureLoop loopOf(double kp) {
  FeatureLoop loop{.selected = true, .kp = kp};
  loop.ki = 0.3;
  loop.kd = 0.05;
  return loop;
}

// All terms of the loops, with limits that some errors exceed.
inline TactileServo limitedServo() {
  TactileServo servo = edgeServo();
  for (const ServoFeature feature : {ServoFeature::kEdgeAngle, ServoFeature::kTotalForce, ServoFeature::kCenterAcross}) {
    servo[feature] = loopOf(3);
    servo[feature].error_limit = feature == ServoFeature::kCenterAcross ? 1e-3 : 0.4;
    servo[feature].integral_limit = feature == ServoFeature::kCenterAcross ? 1e-4 : 0.05;
    servo[feature].derivative_limit = feature == ServoFeature::kCenterAcross ? 1e-3 : 0.5;
  }
  servo[ServoFeature::kEdgeAngle].reference = std::numbers::pi / 2;
  servo.exploration_velocity = 0.004;
  servo.exploration_direction = 0.7;
  return servo;
}

// Controls both centres, one by rolling.
inline TactileServo rollingServo(ServoFeature by_rolling = ServoFeature::kCenterY) {
  TactileServo servo;
  servo[ServoFeature::kCenterX] = loopOf(2);
  servo[ServoFeature::kCenterY] = loopOf(2);
  servo[by_rolling].rolling_radius = 0.01;
  servo[ServoFeature::kTotalForce] = loopOf(2);
  servo[ServoFeature::kTotalForce].reference = 2;
  return servo;
}

// Exceeds both velocity limits, with integrals that anti-windup holds.
inline TactileServo saturatedServo() {
  TactileServo servo = limitedServo();
  servo[ServoFeature::kEdgeAngle].kp = 50;
  servo[ServoFeature::kTotalForce] = {.selected = true, .reference = 30, .kp = 40, .ki = 5};
  servo.max_angular_velocity = 0.3;
  servo.max_linear_velocity = 0.004;
  return servo;
}

// Leaves the contact sideways, then approaches again.
inline TactileServo leavingServo() {
  TactileServo servo = edgeServo();
  servo.exploration_velocity = 0.08;
  servo.exploration_direction = std::numbers::pi / 2;
  servo.max_linear_velocity = 0.1;
  servo.max_angular_velocity = 50;
  servo[ServoFeature::kEdgeAngle].kp = 40;
  return servo;
}

inline Scene sceneOf(std::vector<TactileServo> servos) {
  Scene scene = exampleScene();
  scene.num_steps = 30;
  scene.record = {"tactile_image", "features", "poses", "actions", "robot"};
  scene.max_regions = 0;
  scene.controllers.clear();
  for (std::size_t c = 0; c < servos.size(); ++c) scene.controllers.push_back({"servo_" + std::to_string(c), 1, servos[c]});
  return scene;
}

}  // namespace taxelsim
