#include <algorithm>
#include <cmath>
#include <variant>

#include "sensor/elastic_layer.h"
#include "taxelsim/object.h"
#include "taxelsim/sensor.h"

namespace taxelsim {
namespace {

// One a law.
struct Foundation {
  double thickness;

  Winkler operator()(const Winkler& law) const { return law; }
  Winkler operator()(const MassSpringDamper& law) const { return {.normal_contact_stiffness = law.normal_contact_stiffness}; }
  Winkler operator()(const DeformationMask& law) const { return {.normal_contact_stiffness = law.normal_contact_stiffness}; }
  Winkler operator()(const Proximity& law) const { return {.normal_contact_stiffness = law.sensitivity}; }
  Winkler operator()(const ElasticLayer& law) const {
    return {.normal_contact_stiffness = planeModulus(law.elastic_modulus, law.poisson_ratio) / thickness};
  }
  Winkler operator()(const LuGre& law) const { return {.normal_contact_stiffness = law.normal_contact_stiffness}; }
};

}  // namespace

Winkler foundationOf(const Skin& skin) {
  return std::visit(Foundation{skin.thickness}, skin.law);
}

double maxDepthErrorOf(const Skin& skin) {
  const auto [stiffness, exponent, damping] = foundationOf(skin);
  const double slope = stiffness * exponent * std::pow(skin.thickness, exponent - 1);  // Pa/m, the largest
  return std::min(kMaxPressureError / slope, MeshOptions{}.max_depth_error);
}

bool hasFriction(const Skin& skin) {
  return skin.friction.friction_coefficient > 0 || std::holds_alternative<LuGre>(skin.law);
}

}  // namespace taxelsim
