#include "support/curved_sensor.h"

#include "base/vector3.h"
#include "support/test.h"

namespace taxelsim::support {
namespace {

// Skin and readout of gridSensor(), without its patch.
Sensor bareSensor(const char* name) {
  Sensor sensor = gridSensor();
  sensor.name = name;
  sensor.patches.clear();
  return sensor;
}

void addTaxel(Sensor& sensor, const Vector3& position, const Vector3& normal, double size) {
  sensor.patches.push_back(taxelPatch("taxel_" + std::to_string(sensor.patches.size()), position, normal, {size, size}));
}

}  // namespace

Sensor cylinderFingertip(double radius, double half_angle, int num_around, int num_along, double pitch_along) {
  Sensor sensor = bareSensor("cylinder fingertip");
  const double step = num_around > 1 ? 2 * half_angle / (num_around - 1) : 0.3;
  for (int i = 0; i < num_around; ++i) {
    const double angle = (i - 0.5 * (num_around - 1)) * step;
    for (int j = 0; j < num_along; ++j) {
      const double y = (j - 0.5 * (num_along - 1)) * pitch_along;
      const Vector3 normal{std::sin(angle), 0, std::cos(angle)};
      sensor.patches.push_back(taxelPatch("taxel_" + std::to_string(sensor.patches.size()),
                                          {radius * normal[0], y, radius * (normal[2] - 1)}, normal, {radius * step, pitch_along}));
    }
  }
  return sensor;
}

Sensor sphereFingertip(double radius, int num_subdivisions, double half_angle) {
  Random unused(0);
  const Mesh sphere = icosphere(1, num_subdivisions, 0, unused);
  Sensor sensor = bareSensor("sphere fingertip");
  const double size = std::sqrt(4 * std::numbers::pi * radius * radius / static_cast<double>(sphere.vertices.size()));
  for (const std::array<float, 3>& vertex : sphere.vertices) {
    const Vector3 normal{vertex[0], vertex[1], vertex[2]};
    if (normal[2] < std::cos(half_angle)) {
      continue;
    }
    addTaxel(sensor, {radius * normal[0], radius * normal[1], radius * (normal[2] - 1)}, normal, size);
  }
  return sensor;
}

Sensor randomTaxels(Random& random, int num_taxels) {
  Sensor sensor = bareSensor("random taxels");
  const Vector3 axes{random.uniform(6e-3, 15e-3), random.uniform(6e-3, 15e-3), random.uniform(6e-3, 15e-3)};
  for (int t = 0; t < num_taxels; ++t) {
    const double down = random.uniform(0, 100 * std::numbers::pi / 180), around = random.uniform(-std::numbers::pi, std::numbers::pi);
    const Vector3 on_sphere{std::sin(down) * std::cos(around), std::sin(down) * std::sin(around), std::cos(down)};
    Vector3 position, normal;
    for (int axis = 0; axis < 3; ++axis) {
      position[axis] = axes[axis] * on_sphere[axis];
      normal[axis] = on_sphere[axis] / axes[axis] * axes[2] + random.uniform(-0.05, 0.05);
    }
    position[2] -= axes[2];
    sensor.patches.push_back(taxelPatch("taxel_" + std::to_string(t), position, normal,
                                        {random.uniform(0.5e-3, 3e-3), random.uniform(0.5e-3, 3e-3)},
                                        Vector3{random.uniform(-1, 1), random.uniform(-1, 1), random.uniform(-1, 1)}));
  }
  sensor.samples_per_taxel = random.integer(1, 6);
  sensor.skin.thickness = random.uniform(0.5e-3, 2e-3);
  return sensor;
}

Sensor curvedSensor(Random& random, int kind) {
  Sensor sensor = kind % 3 == 0   ? cylinderFingertip(8e-3, 1.4, 9, 5, 2.4e-3)
                  : kind % 3 == 1 ? sphereFingertip(8e-3, 2, 1.3)
                                  : randomTaxels(random, random.integer(2, 60));
  sensor.psf.sigma = random.uniform(0.2e-3, 2e-3);
  sensor.psf.normalization = random.chance(0.5) ? Psf::Normalization::kPerSource : Psf::Normalization::kNone;
  sensor.readout = paperReadout();
  return sensor;
}

Pose randomContactOnTaxel(Random& random, const Sensor& sensor, const Object& object) {
  const Pose& X_SP = sensor.patches[random.integer(0, static_cast<int>(sensor.patches.size()) - 1)].X_SP;
  Sensor lone = sensor;
  lone.patches = {sensor.patches.front()};
  lone.patches[0].X_SP = {};
  return X_SP * poseAtDepth(lone, object, randomRotation(random, object), 0, 0, random.uniform(0, 1.2) * sensor.skin.thickness);
}

}  // namespace taxelsim::support
