#include "control/servo_fields.h"

#include <algorithm>
#include <string>

#include "base/field_checks.h"

namespace taxelsim {
namespace {

constexpr double kQuarterTurn = std::numbers::pi / 2;

// Keys and units that depend on the unit of the feature.
struct LoopUnits {
  std::string_view reference, error_limit, integral_limit, derivative_limit;  // keys
  std::string_view value, integral, rate;                                     // units
};
constexpr LoopUnits kLength{"reference[_mm]", "error_limit[_mm]", "integral_limit[_mm]", "derivative_limit[_mm]", "m", "m s", "m/s"};
constexpr LoopUnits kForce{"reference", "error_limit", "integral_limit", "derivative_limit", "N", "N s", "N/s"};
constexpr LoopUnits kAngle{
    "reference[_deg]", "error_limit[_deg]", "integral_limit[_deg]", "derivative_limit[_deg]", "rad", "rad s", "rad/s"};

constexpr Field<FeatureLoop> kRollingRadius{
    "rolling_radius[_mm]", &FeatureLoop::rolling_radius, Allowed::atLeast(0, "m"), kOptional,
    "Length by which the centre moves on the sensor per radian, of an object that rolls; 0 slides the sensor"};

constexpr auto loopTable(const LoopUnits& units, const Allowed& reference) {
  return std::array{
      Field<FeatureLoop>{units.reference, &FeatureLoop::reference, reference, kOptional,
                         "Reference; by default the middle of the array, the force at the start, the angle 0"},
      Field<FeatureLoop>{"kp", &FeatureLoop::kp, Allowed::atLeast(0, "1/s"), kRequired, "Rate towards the reference per error"},
      Field<FeatureLoop>{"ki", &FeatureLoop::ki, Allowed::atLeast(0, "1/s^2"), kOptional,
                         "Rate per integral of the error, which is frozen while a velocity limit is active"},
      Field<FeatureLoop>{"kd", &FeatureLoop::kd, {.min = 0, .max = 1, .below_max = true}, kOptional, "Rate per rate of the error"},
      Field<FeatureLoop>{units.error_limit, &FeatureLoop::error_limit, Allowed::above(0, units.value), kUnlimited,
                         "Largest error that kp and ki see"},
      Field<FeatureLoop>{units.integral_limit, &FeatureLoop::integral_limit, Allowed::above(0, units.integral), kUnlimited,
                         "Largest integral of the error"},
      Field<FeatureLoop>{units.derivative_limit, &FeatureLoop::derivative_limit, Allowed::above(0, units.rate), kUnlimited,
                         "Largest rate of the error"},
      kRollingRadius,
  };
}

constexpr auto kCenterLoop = loopTable(kLength, Allowed::within(-1, 1, "m"));
constexpr auto kForceLoop = loopTable(kForce, kForceReference);
constexpr auto kEdgeAngleLoop = loopTable(kAngle, kEdgeAngleReference);
constexpr auto kTiltLoop = loopTable(kAngle, Allowed::within(-kQuarterTurn, kQuarterTurn, "rad"));

bool canRoll(ServoFeature feature) {
  return feature == ServoFeature::kCenterX || feature == ServoFeature::kCenterY;
}

std::string featureNames() {
  std::string names;
  for (const std::string_view name : kServoFeatureNames) names += (names.empty() ? "" : ", ") + std::string(name);
  return names;
}

std::span<const Field<FeatureLoop>> tableOf(ServoFeature feature) {
  switch (feature) {
    case ServoFeature::kCenterX:
    case ServoFeature::kCenterY:
    case ServoFeature::kCenterAcross:
      return kCenterLoop;
    case ServoFeature::kTotalForce:
      return kForceLoop;
    case ServoFeature::kEdgeAngle:
      return kEdgeAngleLoop;
    case ServoFeature::kTiltX:
    case ServoFeature::kTiltY:
      break;
  }
  return kTiltLoop;
}

}  // namespace

std::span<const Field<FeatureLoop>> loopFields(ServoFeature feature) {
  const std::span<const Field<FeatureLoop>> table = tableOf(feature);
  return canRoll(feature) ? table : table.first(table.size() - 1);  // the last one is the rolling radius
}

void checkServo(const TactileServo& servo) {
  for (std::size_t f = 0; f < servo.loops.size(); ++f) {
    const FeatureLoop& loop = servo.loops[f];
    if (!loop.selected) continue;
    const auto feature = static_cast<ServoFeature>(f);
    const std::string path = std::string(kServoFeatureNames[f]) + ".";
    checkFields(path, loopFields(feature), loop);
    if (!canRoll(feature) && loop.rolling_radius != 0) {
      failField(path + "rolling_radius", numberText(loop.rolling_radius), "0: only center_x and center_y can be controlled by rolling");
    }
  }
  if (std::none_of(servo.loops.begin(), servo.loops.end(), [](const FeatureLoop& loop) { return loop.selected; })) {
    throw Error(ErrorKind::kInput, "no feature to control: at least one of " + featureNames());
  }
  for (const ServoFeature axis : {ServoFeature::kCenterX, ServoFeature::kCenterY}) {
    if (!servo[axis].selected || !servo[ServoFeature::kCenterAcross].selected) continue;
    throw Error(std::string(kServoFeatureNames[static_cast<std::size_t>(axis)]),
                "conflicts with `center_across`: both control the same coordinate");
  }
  if (servo.jacobian == TactileJacobianSource::kMeasured && servo.contact != ServoContact::kWhole) {
    throw Error("jacobian", "measured covers all contacts, but contact is largest_region");
  }
  checkFields("", kServoFields, servo);
}

}  // namespace taxelsim
