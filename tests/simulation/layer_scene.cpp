#include "simulation/layer_scene.h"

#include <cmath>

namespace taxelsim::support {

Sensor layerSensor(const LayerOptions& skin, const GridOptions& grid) {
  Sensor sensor = gridSensor(grid);
  sensor.skin = {.thickness = skin.thickness,
                 .law = ElasticLayer{.elastic_modulus = kModulus,
                                     .poisson_ratio = skin.poisson_ratio,
                                     .base = skin.base,
                                     .iterations = skin.iterations,
                                     .tolerance = skin.tolerance},
                 .margin = skin.margin};
  return sensor;
}

std::vector<Object> roundObjects(Random& random) {
  return {Sphere{0.012}, Capsule{0.006, 0.02}, icosphere(0.015, 3, 0.05, random), Box{{0.02, 0.03, 0.025}}};
}

Touch randomTouch(Random& random, const Sensor& sensor, const std::vector<Object>& objects, int num_slots) {
  const GridPatch& patch = sensor.patches[0];
  Sensor springs = sensor;
  springs.skin = {.thickness = sensor.skin.thickness, .law = Winkler{.normal_contact_stiffness = 1e8}};
  Touch touch;
  for (int slot = 0; slot < num_slots; ++slot) {
    touch.ids.push_back(random.integer(0, static_cast<int>(objects.size()) - 1));
    const Object& object = objects[static_cast<std::size_t>(touch.ids.back())];
    const double angle = random.uniform(0.3, 0.7), yaw = random.uniform(-3, 3);
    const Quaternion tilted{std::cos(angle / 2), std::sin(angle / 2) * std::cos(yaw), std::sin(angle / 2) * std::sin(yaw), 0};
    touch.X_SO.push_back(poseAtDepth(springs, object, std::holds_alternative<Capsule>(object.shape) ? random.tilt(0.3) : tilted,
                                     random.uniform(-0.6, 0.6) * patch.num_rows * patch.pitch[0],
                                     random.uniform(-0.6, 0.6) * patch.num_cols * patch.pitch[1],
                                     random.uniform(0.1, 1.1) * sensor.skin.thickness));
  }
  return touch;
}

Pose nextPose(Random& random, const Pose& X_SO, double size) {
  if (random.chance(0.15)) return X_SO;
  const Vector3 axis{random.uniform(-1, 1), random.uniform(-1, 1), random.uniform(-1, 1) + 1e-3};
  Pose next{X_SO.position, axisAngle(axis, random.uniform(0, 0.02)) * X_SO.rotation};
  for (double& coordinate : next.position) coordinate += random.uniform(-1, 1) * size;
  return next;
}

double forceSlack(double force, double deepest) {
  return (40 * kTightTolerance + 2 * kMarginZ / deepest) * force + kAbsoluteForce;
}

}  // namespace taxelsim::support
