#include "taxelsim/skin_variation.h"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <string>
#include <variant>

#include "sensor/checks.h"
#include "taxelsim/error.h"

namespace taxelsim {
namespace {

constexpr double kRounding = 1e-6;  // of a factor stored as float32

template <typename... Laws>
bool isAnyOf(const ContactLaw& law) {
  return (std::holds_alternative<Laws>(law) || ...);
}

// Throws Error for a factor other than 1 that the sensor has no use for.
void checkHasUse(const char* field, float factor, bool has_use, const char* reason) {
  if (factor != 1 && !has_use) failField(field, numberText(factor), std::string("1, because ") + reason);
}

double frictionOf(const Skin& skin) {
  const auto* lugre = std::get_if<LuGre>(&skin.law);
  return lugre ? lugre->static_friction : skin.friction.friction_coefficient;
}

// Weight that a kernel leaves on the taxel itself, as a share of all its weights.
double middleShare(const Psf& psf) {
  return psf.kernel[psf.kernel.size() / 2] / kernelSum(psf);
}

void checkWidth(const Psf& psf, float width) {
  const bool is_kernel = psf.sigma == 0;
  checkHasUse("psf_width", width, !is_kernel || psf.size > 1, "the sensor has no point spread function");
  const double share = is_kernel ? middleShare(psf) : 0;
  const double widest = share < 1 ? std::sqrt(1 / (1 - share)) : kMaxSkinFactor;
  checkNumber("psf_width", width, Allowed::within(0, std::min(widest * (1 + kRounding), kMaxSkinFactor), ""));
}

}  // namespace

void checkVariation(const Sensor& sensor, const SkinVariation& variation) {
  const Skin& skin = sensor.skin;
  const Readout& readout = sensor.readout;
  checkNumber("stiffness", variation.stiffness, Allowed::within(kMinStiffnessFactor, kMaxSkinFactor, ""));
  checkHasUse("stiffness", variation.stiffness, isAnyOf<Winkler, MassSpringDamper, LuGre>(skin.law),
              "only the laws winkler, mass_spring_damper and lugre have such a factor");
  const double friction = frictionOf(skin);
  const double most_friction =
      friction > 0 ? std::min(kMaxSkinFactor, kMaxFrictionCoefficient / friction * (1 + kRounding)) : kMaxSkinFactor;
  checkNumber("friction", variation.friction, Allowed::within(0, most_friction, ""));
  checkHasUse("friction", variation.friction, friction > 0 && isAnyOf<Winkler, LuGre>(skin.law),
              "only a skin with friction and the law winkler or lugre has such a factor");
  checkNumber("trigger", variation.trigger, Allowed::within(0, kMaxSkinFactor, ""));
  const bool has_trigger = readout.trigger != 0 || !readout.taxel_trigger.empty();
  checkHasUse("trigger", variation.trigger, has_trigger, "the trigger of the sensor is 0");
  const std::vector<double>& strengths = readout.hysteresis_strength;
  const double strength = std::accumulate(strengths.begin(), strengths.end(), 0.0);
  Allowed hysteresis = Allowed::within(0, kMaxSkinFactor, "");
  if (strength > 0 && 1 / strength <= kMaxSkinFactor) hysteresis = {.min = 0, .max = 1 / strength, .below_max = true};
  checkNumber("hysteresis", variation.hysteresis, hysteresis);
  checkHasUse("hysteresis", variation.hysteresis, strength > 0, "the sensor has no hysteresis");
  checkNumber("delay", variation.delay, Allowed::within(0, kMaxSkinFactor, ""));
  checkHasUse("delay", variation.delay, readout.delay > 0, "the sensor has no delay");
  checkWidth(sensor.psf, variation.psf_width);
  checkNumber("trigger_spread", variation.trigger_spread, Allowed::within(0, kMaxGainSpread, ""));
  if (variation.trigger_spread != 0 && !has_trigger) {
    failField("trigger_spread", numberText(variation.trigger_spread), "0, because the trigger of the sensor is 0");
  }
}

Sensor variedSensor(const Sensor& sensor, const SkinVariation& variation) {
  Sensor varied = sensor;
  Skin& skin = varied.skin;
  const double stiffness = variation.stiffness, friction = variation.friction;
  if (auto* winkler = std::get_if<Winkler>(&skin.law)) {
    winkler->normal_contact_stiffness *= stiffness;
    winkler->normal_damping *= stiffness;
  } else if (auto* masses = std::get_if<MassSpringDamper>(&skin.law)) {
    masses->normal_contact_stiffness *= stiffness;
  } else if (auto* lugre = std::get_if<LuGre>(&skin.law)) {
    lugre->normal_contact_stiffness *= stiffness;
    for (double* const per_newton : {&lugre->static_friction, &lugre->coulomb_friction, &lugre->viscous_friction}) *per_newton *= friction;
    // The deflection z stays the same, the shear grows with the factor.
    lugre->bristle_stiffness *= friction;
    lugre->bristle_damping *= friction;
  }
  skin.friction.tangential_stiffness *= stiffness;
  skin.friction.friction_coefficient *= friction;
  Readout& readout = varied.readout;
  readout.trigger *= variation.trigger;
  for (double& trigger : readout.taxel_trigger) trigger *= variation.trigger;
  for (double& strength : readout.hysteresis_strength) strength *= variation.hysteresis;
  readout.delay *= variation.delay;
  return varied;
}

}  // namespace taxelsim
