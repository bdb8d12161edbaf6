// Checks of the skin: law, friction, relaxation, elastic layer.
#include <algorithm>
#include <array>
#include <cmath>

#include "sensor/checks.h"

namespace taxelsim {
namespace {

void checkFriction(const Friction& friction) {
  const auto [stiffness, coefficient] = friction;
  if (!(coefficient >= 0 && coefficient <= kMaxFrictionCoefficient)) {
    failField("skin.friction_coefficient", numberText(coefficient), "0 to " + numberText(kMaxFrictionCoefficient));
  }
  if (coefficient == 0 && stiffness != 0)
    failField("skin.tangential_stiffness", numberText(stiffness), "0 where friction_coefficient is 0");
  if (coefficient > 0 && !(stiffness > 0 && stiffness <= kMaxTangentialStiffness)) {
    failField("skin.tangential_stiffness", numberText(stiffness),
              "N/m^3, > 0 and at most " + numberText(kMaxTangentialStiffness) + " where friction_coefficient is > 0");
  }
}

void checkRelaxation(const Skin& skin) {
  const std::vector<RelaxationTerm>& terms = skin.relaxation;
  if (terms.empty()) return;
  const std::string found = std::to_string(terms.size()) + (terms.size() == 1 ? " term" : " terms");
  if (terms.size() > static_cast<std::size_t>(kMaxRelaxationTerms)) {
    failField("skin.relaxation", found, "at most " + std::to_string(kMaxRelaxationTerms));
  }
  if (std::holds_alternative<Proximity>(skin.law))
    failField("skin.relaxation", found, "none for the law proximity, under which nothing presses");
  const double damping = foundationOf(skin).normal_damping;
  if (damping > 0)
    failField("skin.relaxation", found,
              "none with normal_damping (" + numberText(damping) + " Pa s / m), which is another model of energy loss");
  double sum = 0;
  for (std::size_t m = 0; m < terms.size(); ++m) {
    const std::string field = elementOf("skin.relaxation", m);
    checkFields(field + ".", kRelaxationFields, terms[m]);
    if (terms[m].fraction == 1) failField(field + ".fraction", "1", "less than 1 of the stiffness");
    sum += terms[m].fraction;
  }
  if (!(sum < 1)) failField("skin.relaxation", "a sum of fractions of " + numberText(sum), "less than 1");
}

}  // namespace

void checkSkin(const Skin& skin) {
  checkFields("skin.", kSkinFields, skin);
  std::visit([](const auto& law) { visitFields(law, [&](const auto& table) { checkFields("skin.", table, law); }); }, skin.law);
  if (const auto* lugre = std::get_if<LuGre>(&skin.law); lugre != nullptr && lugre->static_friction < lugre->coulomb_friction) {
    failField("skin.static_friction", numberText(lugre->static_friction),
              "coulomb_friction (" + numberText(lugre->coulomb_friction) + ") to " + numberText(kMaxFrictionCoefficient));
  }
  if (skin.friction.friction_coefficient > 0 && !std::holds_alternative<Winkler>(skin.law) &&
      !std::holds_alternative<MassSpringDamper>(skin.law) && !std::holds_alternative<ElasticLayer>(skin.law)) {
    failField("skin.friction_coefficient", numberText(skin.friction.friction_coefficient),
              std::holds_alternative<LuGre>(skin.law)
                  ? "0 with the law lugre, which has its own friction: static_friction, coulomb_friction"
                  : "0 for a law other than winkler, mass_spring_damper and elastic_layer");
  }
  checkFriction(skin.friction);
  checkFields("skin.", kMarginFields, skin);
  if (skin.margin > 0 && !std::holds_alternative<ElasticLayer>(skin.law)) {
    failField("skin.margin", numberText(skin.margin), "0, unless the law is elastic_layer");
  }
  checkRelaxation(skin);
}

// An elastic layer is solved on the nodes of one grid.
void checkLayer(const Sensor& sensor) {
  const ElasticLayer* law = std::get_if<ElasticLayer>(&sensor.skin.law);
  if (law == nullptr) return;
  if (sensor.patches.size() != 1) failField("patches", std::to_string(sensor.patches.size()) + " patches", "1 with the law elastic_layer");
  const std::array<double, 2>& pitch = sensor.patches.front().pitch;
  const double smallest = std::min(pitch[0], pitch[1]) / sensor.samples_per_taxel;
  const double largest = std::max(pitch[0], pitch[1]) / sensor.samples_per_taxel;
  if (sensor.skin.thickness > kMaxLayerThickness)
    failField("skin.thickness", numberText(sensor.skin.thickness),
              "at most " + numberText(kMaxLayerThickness) + " m with the law elastic_layer");
  constexpr double kMaxSpacing = 8;  // thicknesses; wider cells do not resolve the effect of the base
  if (law->base == ElasticLayer::Base::kBonded && largest > kMaxSpacing * sensor.skin.thickness) {
    failField("skin.thickness", numberText(sensor.skin.thickness),
              "at least an eighth of the spacing of samples (" + numberText(largest) + " m) where a layer is bonded");
  }
  constexpr double kMaxSlender = 16;  // of a cell: beyond, its influence is that of a line
  if (largest > kMaxSlender * smallest)
    failField("patches[0].pitch", numberText(largest / smallest) + " to 1", "1 to 16 with the law elastic_layer");
  const double num_nodes = (sensor.patches.front().num_rows + 2 * sensor.skin.margin / pitch[0]) *
                           (sensor.patches.front().num_cols + 2 * sensor.skin.margin / pitch[1]) * sensor.samples_per_taxel *
                           sensor.samples_per_taxel;
  for (std::size_t axis = 0; axis < 2; ++axis) {
    constexpr double kMostPerSide = kMaxTaxelsPerSide * kMaxSamplesPerTaxel;
    const double margin = 2 * std::round(sensor.skin.margin * sensor.samples_per_taxel / pitch[axis]);
    if (margin > kMostPerSide)
      failField("skin.margin", numberText(sensor.skin.margin), "at most " + numberText(kMostPerSide / 2) + " samples");
  }
  if (num_nodes > kMaxLayerNodes) {
    failField("samples_per_taxel",
              std::to_string(sensor.samples_per_taxel) + ", with the margin " + numberText(std::round(num_nodes)) + " nodes,",
              "at most " + std::to_string(kMaxLayerNodes) + " nodes of an elastic layer");
  }
}

}  // namespace taxelsim
