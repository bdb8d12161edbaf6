// Random models and contacts for the comparison of drivers. A number gives the same model and contacts on every machine.
#pragma once

#include <vector>

#include "simulation/comparison.h"

namespace taxelsim::support {

// Kinds of contact law; model n has kind n % kNumLawKinds.
enum class LawKind { kSprings, kStiffeningSprings, kMassSpringDamper, kDeformationMask, kProximity, kLuGre, kElasticLayer };
inline constexpr int kNumLawKinds = 7;

// A sensor, the objects that touch it, and contacts.
struct ContactSet {
  Sensor sensor;
  std::vector<Object> objects;
  std::vector<Touch> touches;
};

// Objects from 0.1 mm to 1 m in up to three slots, in any orientation; a few far off, far too deep, hardly touching, or aligned with the
// taxels. Under an elastic layer: one round object from 1 mm to 0.15 m, because the twin has no bounds for the many nodes that a silhouette
// changes there.
ContactSet randomContacts(int number, int num_contacts);

}  // namespace taxelsim::support
