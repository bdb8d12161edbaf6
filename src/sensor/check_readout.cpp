// Checks of the readout: curve, behaviour over time, imperfections.
#include <algorithm>
#include <cmath>

#include "sensor/checks.h"
#include "sensor/curve.h"
#include "sensor/skin.h"

namespace taxelsim {
namespace {

// Largest spread force of a taxel under a force of 1 on every taxel, without normalization.
double largestGain(const Sensor& sensor) {
  if (sensor.psf.sigma == 0) return kernelSum(sensor.psf);
  double largest = 0;
  for (const std::vector<SkinNeighbour>& neighbours : skinNeighbours(sensor)) {
    double sum = 0;
    for (const SkinNeighbour& neighbour : neighbours) sum += neighbour.weight;
    largest = std::max(largest, sum);
  }
  return largest;
}

// The largest input of the curve, N: the force on a whole taxel at full depth, times gain, creep and kernel gain.
double largestForce(const Sensor& sensor) {
  double area = 0;
  for (const GridPatch& patch : sensor.patches) area = std::max(area, patch.pitch[0] * patch.pitch[1]);
  double gain = 1;
  for (const double taxel_gain : sensor.readout.taxel_gain) gain = std::max(gain, taxel_gain);
  double creep = 1;
  for (const CreepTerm& term : sensor.readout.creep) creep += term.fraction;
  gain *= creep;
  if (sensor.psf.normalization == Psf::Normalization::kNone) gain *= std::max(1.0, largestGain(sensor));
  // An undamped mass overshoots to twice its equilibrium.
  if (std::holds_alternative<MassSpringDamper>(sensor.skin.law)) gain *= 2;
  // The pressure on an incompressible layer is unbounded: the curve must rise until it saturates.
  constexpr double kAnyPressure = 1e18;
  if (std::holds_alternative<ElasticLayer>(sensor.skin.law)) return kAnyPressure * area * gain;
  const Winkler law = foundationOf(sensor.skin);
  return law.normal_contact_stiffness * std::pow(sensor.skin.thickness, law.normal_exponent) * area * gain;
}

void checkTaxelList(const std::string& field, const std::vector<double>& values, int num_taxels, const Allowed& allowed) {
  if (!values.empty() && values.size() != static_cast<std::size_t>(num_taxels)) {
    failField(field, std::to_string(values.size()) + " values", std::to_string(num_taxels) + ", one per taxel, or none");
  }
  for (std::size_t i = 0; i < values.size(); ++i) checkNumber(elementOf(field, i), values[i], allowed);
}

void checkCurvePoints(const Readout& readout) {
  const std::vector<CurvePoint>& points = readout.curve_points;
  if (points.size() > static_cast<std::size_t>(kMaxCurvePoints)) {
    failField("readout.curve_points", std::to_string(points.size()) + " points", "1 to " + std::to_string(kMaxCurvePoints) + ", or none");
  }
  if (readout.curve != Readout{}.curve) failField("readout.curve_points", "a value together with `curve`", "only one of them");
  if (readout.curve_limit != 0) failField("readout.curve_limit", numberText(readout.curve_limit) + " counts", "0 with curve_points");
  CurvePoint before;
  for (std::size_t k = 0; k < points.size(); ++k) {
    const std::string field = elementOf("readout.curve_points", k);
    const auto check = [&](const char* key, double value, double least, const char* unit) {
      if (!(std::isfinite(value) && value > least)) {
        failField(field + "." + key, numberText(value),
                  std::string(unit) + ", > " + numberText(least) + ", from point to point rising strictly");
      }
    };
    check("force", points[k].force, before.force, "N");
    check("counts", points[k].counts, before.counts, "counts");
    const double slope = (points[k].counts - before.counts) / (points[k].force - before.force);
    constexpr double kLeastSlope = 1e-30, kLargestSlope = 1e30;  // float32 holds these and their inverses
    if (!(slope >= kLeastSlope && slope <= kLargestSlope)) {
      failField(field, "a slope of " + numberText(slope) + " counts/N before it",
                numberText(kLeastSlope) + " to " + numberText(kLargestSlope));
    }
    before = points[k];
  }
}

void checkCurve(const Sensor& sensor) {
  const Readout& readout = sensor.readout;
  if (readout.curve.empty() || readout.curve.size() > static_cast<std::size_t>(kMaxCurveDegree)) {
    failField("readout.curve", std::to_string(readout.curve.size()) + " terms", "1 to " + std::to_string(kMaxCurveDegree));
  }
  for (std::size_t m = 0; m < readout.curve.size(); ++m) {
    if (!std::isfinite(readout.curve[m])) {
      failField(elementOf("readout.curve", m), numberText(readout.curve[m]), "counts / N^" + std::to_string(m + 1) + ", finite");
    }
  }
  const double end = readout.saturation / readout.output_scale;
  if (readout.curve_limit != 0 && !(std::isfinite(readout.curve_limit) && readout.curve_limit > end)) {
    failField("readout.curve_limit", numberText(readout.curve_limit) + " counts",
              "0 for none, or more than saturation / output_scale, which is " + numberText(end));
  }
  const double force = largestForce(sensor);
  if (!(std::isfinite(force) && force > 0))
    failField("skin", "a force of " + numberText(force) + " N per taxel at full depth", "finite, > 0");
  if (!readout.curve_points.empty()) return checkCurvePoints(readout);
  if (!curveRises(readout.curve, force, withoutLimit(end, readout.curve_limit))) {
    failField("readout.curve", "a curve that does not rise all the way",
              "strictly rising from 0 N to where it reaches saturation (" + std::to_string(readout.saturation) +
                  " counts) or the force at full depth (" + numberText(force) + " N)");
  }
}

void checkHysteresis(const Readout& readout) {
  const std::size_t num_elements = readout.hysteresis_strength.size();
  if (num_elements > static_cast<std::size_t>(kMaxHysteresisElements)) {
    failField("readout.hysteresis_strength", std::to_string(num_elements) + " elements",
              "at most " + std::to_string(kMaxHysteresisElements));
  }
  if (readout.hysteresis_width.size() != num_elements) {
    failField("readout.hysteresis_width", std::to_string(readout.hysteresis_width.size()) + " values",
              std::to_string(num_elements) + ", one per hysteresis_strength");
  }
  double sum = 0;
  for (std::size_t e = 0; e < num_elements; ++e) {
    checkNumber(elementOf("readout.hysteresis_strength", e), readout.hysteresis_strength[e], Allowed::atLeast(0, ""));
    checkNumber(elementOf("readout.hysteresis_width", e), readout.hysteresis_width[e], Allowed::atLeast(0, "N"));
    sum += readout.hysteresis_strength[e];
  }
  if (!(sum < 1)) failField("readout.hysteresis_strength", "a sum of " + numberText(sum), "less than 1");
}

void checkCreep(const Readout& readout) {
  if (readout.creep.size() > static_cast<std::size_t>(kMaxCreepTerms)) {
    failField("readout.creep", std::to_string(readout.creep.size()) + " terms", "at most " + std::to_string(kMaxCreepTerms));
  }
  for (std::size_t m = 0; m < readout.creep.size(); ++m) {
    checkFields(elementOf("readout.creep", m) + ".", kCreepFields, readout.creep[m]);
  }
}

void checkTime(const Sensor& sensor) {
  const Readout& readout = sensor.readout;
  checkHysteresis(readout);
  checkCreep(readout);
  checkFields("readout.", kTimeFields, readout);
  if (readout.jitter > 0 && !(readout.jitter * sensor.frame_rate <= 1)) {
    failField("readout.jitter", numberText(readout.jitter), "s, at most 1 / frame_rate (" + numberText(1 / sensor.frame_rate) + " s)");
  }
  if (readout.jitter > 0 && sensor.frame_rate == 0) {
    failField("readout.jitter", numberText(readout.jitter), "s, 0 where frame_rate is 0 (a frame at every step)");
  }
}

// The electronics for shear.
void checkThreeAxis(const Sensor& sensor) {
  if (!sensor.readout.three_axis) return;
  const ThreeAxisReadout& axes = *sensor.readout.three_axis;
  const std::string field = "readout.three_axis";
  if (!hasFriction(sensor.skin)) failField(field, "a value", "none on a skin without friction, which has no shear");
  for (std::size_t a = 0; a < axes.gain.size(); ++a) {
    const std::string row = elementOf(field + ".gain", a);
    for (std::size_t b = 0; b < axes.gain[a].size(); ++b) {
      checkNumber(elementOf(row, b), axes.gain[a][b], Allowed::within(-kMaxAxisGain, kMaxAxisGain, "counts/N"));
    }
    if (axes.gain[a] == Vector3{0, 0, 0}) failField(row, "a row of 0", "one value that is not 0, counts/N");
  }
  checkFields(field + ".", kThreeAxisFields, axes);
}

}  // namespace

void checkReadout(const Sensor& sensor) {
  const Readout& readout = sensor.readout;
  checkFields("readout.", kOutputFields, readout);
  const int full_scale = (1 << readout.adc_bits) - 1;
  if (readout.saturation < 1 || readout.saturation > full_scale) {
    failField("readout.saturation", std::to_string(readout.saturation), describeWhole(Allowed::within(1, full_scale, "")));
  }
  checkFields("readout.", kNoiseFields, readout);
  checkTaxelList("readout.taxel_gain", readout.taxel_gain, numTaxels(sensor), Allowed::atLeast(0, ""));
  checkTaxelList("readout.taxel_trigger", readout.taxel_trigger, numTaxels(sensor), Allowed::any("N"));
  checkTaxelList("readout.calibrated_gain", readout.calibrated_gain, numTaxels(sensor), Allowed::atLeast(0, ""));
  checkTime(sensor);
  checkFields("readout.", kImperfectionFields, readout);
  checkThreeAxis(sensor);
  checkCurve(sensor);
}

}  // namespace taxelsim
