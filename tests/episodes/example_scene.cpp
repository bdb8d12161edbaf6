#include "episodes/example_scene.h"

#include "support/test.h"

namespace taxelsim {

Scene exampleScene() {
  constexpr double kPi = std::numbers::pi;
  Scene scene;
  scene.file = "example.yaml";
  scene.name = "example";
  scene.sensor.name = "array";
  scene.sensor.patches.push_back({.name = "grid", .num_rows = 6, .num_cols = 14, .pitch = {3.4e-3, 3.4e-3}, .X_SP = {}});
  scene.sensor.skin = {.thickness = 2e-3, .law = Winkler{.normal_contact_stiffness = 1.73e8}};
  scene.sensor.psf = {.size = 3, .kernel = {0, 0.1, 0, 0.1, 0.6, 0.1, 0, 0.1, 0}};
  scene.sensor.readout = {.curve = {1000}, .trigger = 0.02, .noise = 2, .taxel_gain = {}, .taxel_trigger = {}};
  // A lying cylinder: axis along y at zero yaw.
  scene.objects.push_back({Object("bar", Cylinder{.radius = 8e-3, .length = 0.1}), 3, axisAngle({1, 0, 0}, kPi / 2)});
  scene.objects.push_back({Object("ball", Sphere{.radius = 0.01}), 1, {1, 0, 0, 0}});
  scene.num_steps = 7;
  scene.simulation_rate = 100;
  scene.control_rate = 50;
  scene.randomization.x = {-0.003, 0.003};
  scene.randomization.y = {-0.01, 0.01};
  scene.randomization.yaw = {-kPi, kPi};
  scene.randomization.tilt = {0, 0.005};
  scene.randomization.load = Range{1, 4};
  scene.randomization.gain = {0.9, 1.1};
  scene.randomization.gain_spread = {0, 0.05};
  scene.randomization.noise = {0, 5};
  scene.controllers[0].servo.exploration_velocity = 0.002;
  scene.record = {"tactile_image",
                  "features",
                  "ground_truth",
                  "tactile_normal_force",
                  "tactile_shear_force",
                  "penetration_depth",
                  "contact_features",
                  "clean_contact_features",
                  "poses",
                  "actions"};
  scene.max_regions = 2;
  scene.num_episodes = 23;
  scene.seed = 11;
  scene.episodes_per_shard = 5;
  scene.resolved = "name: example\n";
  return scene;
}

Scene exampleContacts() {
  Scene scene = exampleScene();
  scene.kind = Scene::Kind::kContacts;
  scene.num_steps = 1;
  scene.record.pop_back();
  scene.resolved = "name: contacts\n";
  return scene;
}

}  // namespace taxelsim
