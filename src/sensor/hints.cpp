#include "sensor/hints.h"

#include <algorithm>

#include "base/log.h"
#include "base/text.h"
#include "geometry/unit_check.h"
#include "sensor/curve.h"

namespace taxelsim {
namespace {

constexpr double kThickestPlausible = 0.1;  // m; skins of tactile sensors are millimetres thick

void warn(const std::string& key, const std::string& question) {
  if (!question.empty()) logWarning(key + ": " + question + " Lengths are in metres");
}

}  // namespace

double noiseTrigger(const Readout& readout) {
  constexpr double kDeviations = 3;
  // Below the trigger the curve is a straight line. Where it begins level, no trigger silences the taxel.
  const bool has_curve = !readout.curve.empty() || !readout.curve_points.empty();
  const double counts_per_newton = has_curve ? readout.output_scale * slopeAtZero(readout) : 0;
  return counts_per_newton > 0 ? kDeviations * readout.noise / counts_per_newton : 0;
}

std::string unitQuestion(const GridPatch& patch) {
  const double pitch = std::max(patch.pitch[0], patch.pitch[1]);
  return pitch > kLongestPlausible ? numberText(pitch) + " m between taxels; is it in millimetres?" : "";
}

std::string unitQuestion(const Skin& skin) {
  return skin.thickness > kThickestPlausible ? numberText(skin.thickness) + " m thick; is it in millimetres?" : "";
}

void warnOfUnits(const GridPatch& patch) {
  warn("pitch", unitQuestion(patch));
}

void warnOfUnits(const Skin& skin) {
  warn("thickness", unitQuestion(skin));
}

}  // namespace taxelsim
