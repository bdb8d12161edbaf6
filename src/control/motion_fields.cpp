#include "control/motion_fields.h"

#include <cmath>
#include <string>

#include "base/field_checks.h"
#include "base/vector3.h"

namespace taxelsim {
namespace {

void check(const ConstantTwist& motion) {
  checkFields("constant_twist.", kConstantTwistFields, motion.twist);
}

void check(const Sinusoid& motion) {
  checkFields("sinusoid.", kSinusoidFields, motion);
  const double size = length(motion.axis);
  if (!(size > 0 && std::isfinite(size))) failField("sinusoid.axis", "a vector of length " + numberText(size), "a finite length > 0");
}

void check(const Waypoints& motion) {
  const std::string points = "waypoints.points";
  if (motion.points.empty()) failField(points, "an empty list", "at least one waypoint");
  for (std::size_t k = 0; k < motion.points.size(); ++k) {
    const Waypoint& point = motion.points[k];
    const std::string path = elementOf(points, k) + ".";
    checkNumber(path + "time", point.time, Allowed::any("s"));
    if (k > 0 && point.time <= motion.points[k - 1].time) {
      failField(path + "time", numberText(point.time), "a time after that of the previous waypoint");
    }
    for (const double p : point.pose.position) checkNumber(path + "position", p, Allowed::any("m"));
    for (const double q : point.pose.rotation) checkNumber(path + "rotation", q, Allowed::any(""));
  }
}

void checkBand(const std::string& field, const std::array<double, 2>& band) {
  if (band[0] <= band[1]) return;
  failField(field, "[" + numberText(band[0]) + ", " + numberText(band[1]) + "]", "[min, max] with min <= max");
}

void check(const HandHeld& motion) {
  checkFields("hand_held.", kHandHeldFields, motion);
  checkBand("hand_held.drift_band", motion.drift_band);
  checkBand("hand_held.tremor_band", motion.tremor_band);
}

}  // namespace

void checkMotion(const Motion& motion) {
  std::visit([](const auto& kind) { check(kind); }, motion);
}

}  // namespace taxelsim
