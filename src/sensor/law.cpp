#include <variant>

#include "taxelsim/sensor.h"

namespace taxelsim {
namespace {

// One a law.
struct Foundation {
  Winkler operator()(const Winkler& law) const { return law; }
  Winkler operator()(const MassSpringDamper& law) const { return {.normal_contact_stiffness = law.normal_contact_stiffness}; }
  Winkler operator()(const DeformationMask& law) const { return {.normal_contact_stiffness = law.normal_contact_stiffness}; }
  Winkler operator()(const Proximity& law) const { return {.normal_contact_stiffness = law.sensitivity}; }
};

}  // namespace

Winkler foundationOf(const ContactLaw& law) {
  return std::visit(Foundation{}, law);
}

}  // namespace taxelsim
