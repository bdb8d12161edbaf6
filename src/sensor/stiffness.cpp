#include "taxelsim/stiffness.h"

#include <cmath>
#include <numbers>
#include <utility>

#include "base/field_checks.h"
#include "sensor/checks.h"
#include "sensor/elastic_layer.h"
#include "sensor/fields.h"
#include "sensor/flat_punch.h"

namespace taxelsim {
namespace {

static_assert(kMaxPinDiameterRatio == 2 * kMaxPunchRatio);

constexpr Allowed kPoissonRatio{.min = 0, .max = 0.5, .below_max = true};

double discArea(double diameter) {
  return std::numbers::pi / 4 * diameter * diameter;
}

// Confined modulus relative to Young's modulus.
double confinedFactor(double poisson_ratio) {
  return (1 - poisson_ratio) / ((1 + poisson_ratio) * (1 - 2 * poisson_ratio));
}

void checkMaterial(const Material& material) {
  checkNumber("elastic_modulus", material.elastic_modulus, Allowed::above(0, "Pa"));
  checkNumber("poisson_ratio", material.poisson_ratio, kPoissonRatio);
}

void checkDiameter(const std::string& field, double diameter, double thickness) {
  if (!(diameter > 0 && diameter <= kMaxPinDiameterRatio * thickness)) {
    failField(
        field, numberText(diameter),
        "> 0 and at most " + numberText(kMaxPinDiameterRatio) + " thicknesses (" + numberText(kMaxPinDiameterRatio * thickness) + " m)");
  }
}

// Pin stiffness of a bonded layer, N/m.
double bondedPinStiffness(const Material& material, double thickness, double diameter) {
  return planeModulus(material.elastic_modulus, material.poisson_ratio) * diameter *
         punchFactor(diameter / 2 / thickness, material.poisson_ratio);
}

// One overload per alternative of SkinData::stiffness. They set elastic_modulus and area_stiffness.
struct StiffnessSolver {
  const SkinData& data;
  SkinStiffness& result;

  double& modulus() const { return result.material.elastic_modulus; }

  void operator()(const KnownModulus& known) const {
    checkNumber("elastic_modulus", known.elastic_modulus, Allowed::above(0, "Pa"));
    modulus() = known.elastic_modulus;
    result.area_stiffness = confinedFactor(data.poisson_ratio) * known.elastic_modulus / data.thickness;
    if (!known.match_pin_diameter) return;
    const double diameter = *known.match_pin_diameter;
    checkDiameter("match_pin_diameter", diameter, data.thickness);
    result.area_stiffness = bondedPinStiffness(result.material, data.thickness, diameter) / discArea(diameter);
  }
  void operator()(const PinPress& press) const {
    checkNumber("pin_force", press.pin_force, Allowed::above(0, "N"));
    checkNumber("pin_depth", press.pin_depth, Allowed::aboveUpTo(0, data.thickness, "m, the thickness"));
    checkDiameter("pin_diameter", press.pin_diameter, data.thickness);
    const double pin_stiffness = press.pin_force / press.pin_depth;
    result.area_stiffness = pin_stiffness / discArea(press.pin_diameter);
    modulus() = pin_stiffness / bondedPinStiffness({1, data.poisson_ratio}, data.thickness, press.pin_diameter);
  }
  void operator()(const TaxelStiffness& taxel) const {
    checkNumber("taxel_stiffness", taxel.taxel_stiffness, Allowed::above(0, "N/m"));
    for (std::size_t axis = 0; axis < 2; ++axis) checkNumber(elementOf("pitch", axis), taxel.pitch[axis], Allowed::above(0, "m"));
    (*this)(AreaStiffness{taxel.taxel_stiffness / (taxel.pitch[0] * taxel.pitch[1])});
  }
  void operator()(const AreaStiffness& area) const {
    checkNumber("area_stiffness", area.area_stiffness, Allowed::above(0, "N/m^3"));
    result.area_stiffness = area.area_stiffness;
    modulus() = area.area_stiffness * data.thickness / confinedFactor(data.poisson_ratio);
  }
};

// A skin under one law, by type.
struct LawSetter {
  const SkinStiffness& stiffness;

  void operator()(Winkler& law) const { law.normal_contact_stiffness = stiffness.area_stiffness; }
  void operator()(MassSpringDamper& law) const { law.normal_contact_stiffness = stiffness.area_stiffness; }
  void operator()(DeformationMask& law) const { law.normal_contact_stiffness = stiffness.area_stiffness; }
  void operator()(Proximity& law) const { law.sensitivity = stiffness.area_stiffness; }
  void operator()(LuGre& law) const { law.normal_contact_stiffness = stiffness.area_stiffness; }
  void operator()(ElasticLayer& law) const {
    law.elastic_modulus = stiffness.material.elastic_modulus;
    law.poisson_ratio = stiffness.material.poisson_ratio;
  }
};

template <std::size_t... I>
std::vector<ContactLaw> allLaws(std::index_sequence<I...>) {
  return {std::variant_alternative_t<I, ContactLaw>{}...};
}

// Force per depth^exponent of a pin.
struct PinLaw {
  double stiffness = 0;
  double exponent = 1;
};

PinLaw pinLaw(const Skin& skin, double diameter) {
  checkNumber("skin.thickness", skin.thickness, Allowed::above(0, "m"));
  checkNumber("pin_diameter", diameter, Allowed::above(0, "m"));
  if (const auto* layer = std::get_if<ElasticLayer>(&skin.law)) {
    checkFields("skin.", kElasticLayerFields, *layer);
    if (layer->base == ElasticLayer::Base::kHalfSpace) return {planeModulus(layer->elastic_modulus, layer->poisson_ratio) * diameter};
    checkDiameter("pin_diameter", diameter, skin.thickness);
    return {bondedPinStiffness({layer->elastic_modulus, layer->poisson_ratio}, skin.thickness, diameter)};
  }
  const Winkler foundation = foundationOf(skin);
  checkFields("skin.", kWinklerFields, foundation);
  return {foundation.normal_contact_stiffness * discArea(diameter), foundation.normal_exponent};
}

}  // namespace

double shoreAModulus(double shore_a) {
  checkNumber("shore_a", shore_a, Allowed::within(kMinShoreA, kMaxShoreA, "Shore A"));
  return 1e6 * 0.0981 * (56 + 7.62336 * shore_a) / (0.137505 * (254 - 2.54 * shore_a));
}

double shearModulus(const Material& material) {
  checkMaterial(material);
  return material.elastic_modulus / (2 * (1 + material.poisson_ratio));
}

double confinedModulus(const Material& material) {
  checkMaterial(material);
  return material.elastic_modulus * confinedFactor(material.poisson_ratio);
}

double layerPinStiffness(const Material& material, double thickness, double pin_diameter) {
  checkMaterial(material);
  checkNumber("thickness", thickness, Allowed::above(0, "m"));
  checkDiameter("pin_diameter", pin_diameter, thickness);
  return bondedPinStiffness(material, thickness, pin_diameter);
}

SkinStiffness skinStiffness(const SkinData& data) {
  checkNumber("thickness", data.thickness, Allowed::within(kMinLayerThickness, kMaxLayerThickness, "m"));
  checkNumber("poisson_ratio", data.poisson_ratio, kPoissonRatio);
  SkinStiffness result{.thickness = data.thickness, .material = {.poisson_ratio = data.poisson_ratio}};
  std::visit(StiffnessSolver{data, result}, data.stiffness);
  // Extreme numbers overflow or underflow.
  checkNumber("the elastic modulus that follows", result.material.elastic_modulus, Allowed::above(0, "Pa"));
  checkNumber("the area stiffness that follows", result.area_stiffness, Allowed::above(0, "N/m^3"));
  result.tangential_stiffness = shearModulus(result.material) / data.thickness;
  checkNumber("the tangential stiffness that follows", result.tangential_stiffness,
              Allowed::aboveUpTo(0, kMaxTangentialStiffness, "N/m^3"));
  return result;
}

std::vector<Skin> skinsOf(const SkinStiffness& stiffness, double friction_coefficient) {
  checkNumber("friction_coefficient", friction_coefficient, Allowed::within(0, kMaxFrictionCoefficient, ""));
  std::vector<Skin> skins;
  for (ContactLaw& law : allLaws(std::make_index_sequence<std::variant_size_v<ContactLaw>>())) {
    std::visit(LawSetter{stiffness}, law);
    Skin& skin = skins.emplace_back(Skin{.thickness = stiffness.thickness, .law = law});
    const bool is_layer = std::holds_alternative<ElasticLayer>(law);
    if (is_layer) skin.margin = 2 * stiffness.thickness;
    if (friction_coefficient > 0 && (is_layer || std::holds_alternative<Winkler>(law) || std::holds_alternative<MassSpringDamper>(law))) {
      skin.friction = {.tangential_stiffness = stiffness.tangential_stiffness, .friction_coefficient = friction_coefficient};
    }
    checkSkin(skin);
  }
  return skins;
}

double pinForce(const Skin& skin, double pin_diameter, double depth) {
  const PinLaw law = pinLaw(skin, pin_diameter);
  checkNumber("depth", depth, Allowed::within(0, skin.thickness, "m, the thickness"));
  return law.stiffness * std::pow(depth, law.exponent);
}

double pinDepth(const Skin& skin, double pin_diameter, double force) {
  const PinLaw law = pinLaw(skin, pin_diameter);
  checkNumber("force", force, Allowed::atLeast(0, "N"));
  return std::pow(force / law.stiffness, 1 / law.exponent);
}

}  // namespace taxelsim
