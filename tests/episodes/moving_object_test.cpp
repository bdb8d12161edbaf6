// Objects that move through the world while the sensor servoes, from the scene to the data set.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "episodes/example_scene.h"
#include "taxelsim/generate.h"

namespace taxelsim {
namespace {

constexpr double kPi = std::numbers::pi;

// Episodes of 100 frames on the bar, from noiseless starts.
Scene sceneWith(const Motion& motion, const TactileServo& servo) {
  Scene scene = exampleScene();
  scene.objects.resize(1);
  scene.objects[0].motion = motion;
  scene.num_steps = 100;
  scene.control_rate = scene.simulation_rate;
  scene.num_episodes = scene.episodes_per_shard = 6;
  scene.randomisation.yaw = {-0.2, 0.2};
  scene.randomisation.noise = {0, 0};
  scene.controllers[0].servo = servo;
  return scene;
}

struct Played {
  std::vector<double> pose, sensor_pose, force, load;
};

Played play(const Scene& scene) {
  const TestDirectory directory;
  EXPECT_TRUE(generate(Device::open(), scene, directory.path(), {.batch_size = 4, .on_progress = {}, .stop = nullptr}).complete);
  const DatasetReader reader(directory.path());
  const auto read = [&](const char* column) { return reader.readAsDouble(column, 0, reader.numFrames()); };
  return {read("data/pose"), read("data/sensor_pose"), read("data/ground_truth/total_force"),
          reader.readAsDouble("meta/load", 0, scene.num_episodes)};
}

Pose poseAt(const std::vector<double>& poses, std::size_t frame) {
  const double* p = &poses[7 * frame];
  return {{p[0], p[1], p[2]}, {p[3], p[4], p[5], p[6]}};
}

// Under a servo that turns with gain 0 the sensor rests, and the recorded poses are the motion from where the load left the object.
TEST(MovingObject, GoesItsWayFromWhereItWasSetDown) {
  const Sinusoid motion{.axis = {1, 0, 0}, .amplitude = 2e-3, .frequency = 2, .phase = 0.3};
  TactileServo rest;
  rest[ServoFeature::kEdgeAngle] = {.selected = true};
  const Scene scene = sceneWith(motion, rest);
  const Played played = play(scene);
  for (std::size_t episode = 0; episode < scene.num_episodes; ++episode) {
    const std::size_t first = episode * static_cast<std::size_t>(scene.num_steps);
    const Pose start = poseAt(played.pose, first);
    for (std::size_t k = 0; k < static_cast<std::size_t>(scene.num_steps); ++k) {
      const double t = static_cast<double>(k) / scene.simulation_rate;
      const double way = motion.amplitude * (std::sin(2 * kPi * motion.frequency * t + motion.phase) - std::sin(motion.phase));
      const Pose at = poseAt(played.pose, first + k);
      // The load has moved the object after its first pose was taken.
      const double z = k == 0 ? at.position[2] : poseAt(played.pose, first + 1).position[2];
      constexpr double kRounding = 1e-12;  // m: products of double poses of some centimetres
      ASSERT_NEAR(at.position[0], start.position[0] + way, kRounding) << "episode " << episode << ", frame " << k;
      ASSERT_NEAR(at.position[1], start.position[1], kRounding);
      ASSERT_NEAR(at.position[2], z, kRounding);
      for (std::size_t c = 0; c < 4; ++c) ASSERT_NEAR(at.rotation[c], start.rotation[c], kRounding);
    }
  }
}

// A force loop of gain K lets 2 pi f / sqrt(K^2 + (2 pi f)^2) of a disturbance at frequency f through: at 1 Hz and K = 20 / s 0.30 of it.
// The stiffness that the loop divides by is that of the taxels above the trigger, up to twice what carries, and of half the gain 0.53 is
// left.
TEST(MovingObject, ForceIsHeldAgainstIt) {
  constexpr double kLeft = 0.6;
  constexpr std::size_t kFrames = 200, kSettled = 100;  // a whole period after the loop has met its force
  const auto swingWith = [&](double gain) {
    TactileServo servo;
    servo[ServoFeature::kTotalForce] = {.selected = true, .kp = gain};
    Scene scene = sceneWith(Sinusoid{.axis = {0, 0, 1}, .amplitude = 5e-5, .frequency = 1}, servo);
    scene.num_steps = kFrames;
    const Played played = play(scene);
    double worst = 0;
    for (std::size_t episode = 0; episode < scene.num_episodes; ++episode) {
      const auto first = played.force.begin() + static_cast<std::ptrdiff_t>(episode * kFrames + kSettled);
      const auto [low, high] = std::minmax_element(first, first + static_cast<std::ptrdiff_t>(kFrames - kSettled));
      worst = std::max(worst, (*high - *low) / played.load[episode]);
    }
    return worst;
  };
  const double held = swingWith(20), loose = swingWith(0);
  EXPECT_LT(held, kLeft * loose);
  EXPECT_GT(loose, 0.1) << "else there was nothing to hold";
}

}  // namespace
}  // namespace taxelsim
