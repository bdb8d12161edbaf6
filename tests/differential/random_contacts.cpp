#include "differential/random_contacts.h"

#include <cmath>

#include "simulation/layer_scene.h"
#include "support/random_scene.h"

namespace taxelsim::support {
namespace {

double logarithmic(Random& random, double low, double high) {
  return low * std::pow(high / low, random.uniform());
}

ContactLaw springLaw(Random& random, LawKind kind, double thickness) {
  const double stiffness = 1e5 / thickness;  // N/m^3: 1e5 Pa at full depth
  switch (kind) {
    case LawKind::kStiffeningSprings: {
      const double exponent = random.uniform(1, 3);
      return Winkler{1e5 / std::pow(thickness, exponent), exponent, 0};
    }
    case LawKind::kMassSpringDamper:
      return MassSpringDamper{stiffness, logarithmic(random, 1e-5, 1e-1), logarithmic(random, 1, 1e3), logarithmic(random, 1e-3, 10)};
    case LawKind::kDeformationMask:
      return DeformationMask{stiffness, logarithmic(random, 1e4, 1e6)};
    case LawKind::kProximity:
      return Proximity{stiffness};
    case LawKind::kLuGre:
      return LuGre{.normal_contact_stiffness = stiffness};
    default:
      return Winkler{stiffness, 1, 0};
  }
}

Object anyObject(Random& random) {
  const double size = logarithmic(random, 1e-4, 1);
  return random.chance(0.5)   ? randomSolid(random, size)
         : random.chance(0.5) ? randomPolyhedron(random, size)
                              : randomMeshObject(random, size);
}

Pose anyContact(Random& random, const Sensor& sensor, const Object& object) {
  Pose X_SO = randomContact(random, sensor, object);
  switch (random.integer(0, 15)) {
    case 0:  // deep in the sensor
      X_SO.position[2] -= random.uniform(0, 10) * sensor.skin.thickness;
      break;
    case 1:  // far off
      X_SO.position[0] += random.uniform(-1, 1);
      break;
    case 2:  // faces parallel to the skin and edges along the rows
      X_SO = poseAtDepth(sensor, object, {1, 0, 0, 0}, 0, 0, random.uniform(0, 1) * sensor.skin.thickness);
      break;
    case 3:  // within rounding of touching
      X_SO = poseAtDepth(sensor, object, X_SO.rotation, X_SO.position[0], X_SO.position[1], logarithmic(random, 1e-9, 1e-5));
      break;
    default:
      break;
  }
  return X_SO;
}

ContactSet springContacts(Random& random, LawKind kind, int num_contacts) {
  ContactSet set;
  const bool is_uniform = kind == LawKind::kMassSpringDamper || kind == LawKind::kDeformationMask || kind == LawKind::kProximity;
  set.sensor = randomSensor(
      random,
      {.max_rows = 10, .max_cols = 12, .max_patches = random.integer(1, 3), .max_patch_tilt = 0.4, .max_kernel = is_uniform ? 1 : 9});
  if (is_uniform) set.sensor.psf = {};
  set.sensor.skin.law = springLaw(random, kind, set.sensor.skin.thickness);
  const int num_objects = random.integer(2, 5), num_slots = random.integer(1, 3);
  for (int n = 0; n < num_objects; ++n) set.objects.push_back(anyObject(random));
  for (int n = 0; n < num_contacts; ++n) {
    Touch touch;
    for (int slot = 0; slot < num_slots; ++slot) {
      const int id = slot > 0 && random.chance(0.4) ? kNoObject : random.integer(0, num_objects - 1);
      touch.ids.push_back(id);
      touch.X_SO.push_back(id == kNoObject ? Pose{} : anyContact(random, set.sensor, set.objects[static_cast<std::size_t>(id)]));
    }
    set.touches.push_back(touch);
  }
  return set;
}

// Sphere, capsule and bumpy sphere, of one size each.
std::vector<Object> roundObjectsOfAnySize(Random& random) {
  const auto size = [&] { return logarithmic(random, 1e-3, 0.15); };
  const double radius = size();
  return {Sphere{size() / 2}, Capsule{radius / 4, radius}, icosphere(size() / 2, 3, 0.05, random)};
}

ContactSet layerContacts(Random& random, int num_contacts) {
  ContactSet set;
  const GridOptions grid{.num_rows = random.integer(3, 6),
                         .num_cols = random.integer(3, 6),
                         .pitch_x = random.uniform(1.5e-3, 4e-3),
                         .pitch_y = random.uniform(1.5e-3, 4e-3),
                         .samples_per_taxel = random.integer(2, 3),
                         .thickness = 2e-3};
  set.sensor = layerSensor({.poisson_ratio = random.uniform(0.3, 0.5),
                            .base = random.chance(0.3) ? ElasticLayer::Base::kHalfSpace : ElasticLayer::Base::kBonded,
                            .margin = random.chance(0.5) ? 0 : 2e-3},
                           grid);
  set.objects = roundObjectsOfAnySize(random);
  for (int n = 0; n < num_contacts; ++n) {
    Touch touch = randomTouch(random, set.sensor, set.objects);
    if (random.chance(0.1)) touch.X_SO[0].position[0] += random.uniform(-0.1, 0.1);
    set.touches.push_back(touch);
  }
  return set;
}

}  // namespace

ContactSet randomContacts(int number, int num_contacts) {
  Random random(static_cast<std::uint64_t>(number) + 70'000);
  const auto kind = static_cast<LawKind>(number % kNumLawKinds);
  return kind == LawKind::kElasticLayer ? layerContacts(random, num_contacts) : springContacts(random, kind, num_contacts);
}

}  // namespace taxelsim::support
