// Objects that move in the world during servoing, from scene to data set.
#include "episodes/example_scene.h"
#include "support/test.h"
#include "taxelsim/generate.h"

namespace taxelsim {
namespace {

constexpr double kPi = std::numbers::pi;

// Episodes of 100 frames with the bar, without noise.
Scene sceneWith(const Motion& motion, const TactileServo& servo) {
  Scene scene = exampleScene();
  scene.objects.resize(1);
  scene.objects[0].motion = motion;
  scene.num_steps = 100;
  scene.control_rate = scene.simulation_rate;
  scene.num_episodes = scene.episodes_per_shard = 6;
  scene.randomization.yaw = {-0.2, 0.2};
  scene.randomization.noise = {0, 0};
  scene.controllers[0].servo = servo;
  return scene;
}

struct Recording {
  std::vector<double> pose, sensor_pose, force, load;
};

Recording generateEpisodes(const Scene& scene) {
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

// A servo with zero gains keeps the sensor at rest, so the recorded poses are the motion, starting where the load search left the object.
TEST(MovingObject, FollowsItsMotionFromTheInitialContact) {
  const Sinusoid motion{.axis = {1, 0, 0}, .amplitude = 2e-3, .frequency = 2, .phase = 0.3};
  TactileServo rest;
  rest[ServoFeature::kEdgeAngle] = {.selected = true};
  const Scene scene = sceneWith(motion, rest);
  const Recording recording = generateEpisodes(scene);
  for (std::size_t episode = 0; episode < scene.num_episodes; ++episode) {
    const std::size_t first = episode * static_cast<std::size_t>(scene.num_steps);
    const Pose start = poseAt(recording.pose, first);
    for (std::size_t k = 0; k < static_cast<std::size_t>(scene.num_steps); ++k) {
      const double t = static_cast<double>(k) / scene.simulation_rate;
      const double displacement = motion.amplitude * (std::sin(2 * kPi * motion.frequency * t + motion.phase) - std::sin(motion.phase));
      const Pose at = poseAt(recording.pose, first + k);
      // The pose of frame 0 precedes the load search.
      const double z = k == 0 ? at.position[2] : poseAt(recording.pose, first + 1).position[2];
      constexpr double kRounding = 1e-12;  // m: products of poses of a few centimetres in double
      ASSERT_NEAR(at.position[0], start.position[0] + displacement, kRounding) << "episode " << episode << ", frame " << k;
      ASSERT_NEAR(at.position[1], start.position[1], kRounding);
      ASSERT_NEAR(at.position[2], z, kRounding);
      for (std::size_t c = 0; c < 4; ++c) ASSERT_NEAR(at.rotation[c], start.rotation[c], kRounding);
    }
  }
}

// A force loop of gain K attenuates a disturbance at frequency f to 2 pi f / sqrt(K^2 + (2 pi f)^2): 0.30 at 1 Hz and K = 20 / s. The loop
// divides by the stiffness of the taxels above the trigger, up to twice the actual one; at half the gain the attenuation is 0.53.
TEST(MovingObject, ForceLoopRejectsTheDisturbance) {
  constexpr double kMaxAttenuated = 0.6;
  constexpr std::size_t kFrames = 200, kSettled = 100;  // one period, after the loop has settled
  const auto swingWith = [&](double gain) {
    TactileServo servo;
    servo[ServoFeature::kTotalForce] = {.selected = true, .kp = gain};
    Scene scene = sceneWith(Sinusoid{.axis = {0, 0, 1}, .amplitude = 5e-5, .frequency = 1}, servo);
    scene.num_steps = kFrames;
    const Recording recording = generateEpisodes(scene);
    double worst = 0;
    for (std::size_t episode = 0; episode < scene.num_episodes; ++episode) {
      const auto first = recording.force.begin() + static_cast<std::ptrdiff_t>(episode * kFrames + kSettled);
      const auto [low, high] = std::minmax_element(first, first + static_cast<std::ptrdiff_t>(kFrames - kSettled));
      worst = std::max(worst, (*high - *low) / recording.load[episode]);
    }
    return worst;
  };
  const double controlled = swingWith(20), uncontrolled = swingWith(0);
  EXPECT_LT(controlled, kMaxAttenuated * uncontrolled);
  EXPECT_GT(uncontrolled, 0.1) << "no disturbance to reject";
}

}  // namespace
}  // namespace taxelsim
