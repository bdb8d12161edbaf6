#include <algorithm>
#include <cmath>
#include <limits>
#include <string>

#include "base/text.h"
#include "sensor/curve.h"
#include "sensor/skin.h"
#include "taxelsim/error.h"
#include "taxelsim/sensor.h"

namespace taxelsim {
namespace {

// Quaternions typed with four digits are of unit length within this.
constexpr double kUnitTolerance = 1e-3;

[[noreturn]] void fail(const std::string& field, const std::string& value, const std::string& allowed) {
  throw Error(ErrorKind::kInput, field + ": " + value + " is not allowed: " + allowed);
}

void checkPositive(const std::string& field, double value, const char* unit) {
  if (!(std::isfinite(value) && value > 0)) fail(field, numberText(value), std::string(unit) + ", > 0");
}

void checkNotNegative(const std::string& field, double value, const char* unit) {
  if (!(std::isfinite(value) && value >= 0)) fail(field, numberText(value), std::string(unit) + ", >= 0");
}

void checkRange(const std::string& field, double value, double min, double max, const char* unit) {
  if (!(value >= min && value <= max))
    fail(field, numberText(value), std::string(unit) + ", " + numberText(min) + " to " + numberText(max));
}

void checkWhole(const std::string& field, int value, int min, int max) {
  if (value < min || value > max) fail(field, std::to_string(value), std::to_string(min) + " to " + std::to_string(max));
}

std::string at(const std::string& field, std::size_t index) {
  return field + "[" + std::to_string(index) + "]";
}

void checkPatch(const std::string& field, const GridPatch& patch) {
  checkWhole(field + ".num_rows", patch.num_rows, 1, kMaxTaxelsPerSide);
  checkWhole(field + ".num_cols", patch.num_cols, 1, kMaxTaxelsPerSide);
  for (std::size_t axis = 0; axis < 2; ++axis) checkPositive(at(field + ".pitch", axis), patch.pitch[axis], "m");
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const double coordinate = patch.X_SP.position[axis];
    if (!std::isfinite(coordinate)) fail(at(field + ".X_SP.position", axis), numberText(coordinate), "m, finite");
  }
  double norm = 0;
  for (const double component : patch.X_SP.rotation) norm += component * component;
  norm = std::sqrt(norm);
  if (!(std::abs(norm - 1) <= kUnitTolerance)) {
    fail(field + ".X_SP.rotation", "a quaternion of length " + numberText(norm), "length 1 within " + numberText(kUnitTolerance));
  }
}

void checkPatches(const std::vector<GridPatch>& patches) {
  if (patches.empty()) fail("patches", "an empty list", "at least one patch");
  constexpr std::size_t kMaxPatches = std::numeric_limits<int>::max() / (kMaxTaxelsPerSide * kMaxTaxelsPerSide);
  if (patches.size() > kMaxPatches) fail("patches", std::to_string(patches.size()), "at most " + std::to_string(kMaxPatches));
  for (std::size_t i = 0; i < patches.size(); ++i) checkPatch(at("patches", i), patches[i]);
}

// One a law.
struct CheckLaw {
  void operator()(const Winkler& law) const {
    checkPositive("skin.normal_contact_stiffness", law.normal_contact_stiffness, "Pa / m^normal_exponent");
    if (!(law.normal_exponent >= 1 && law.normal_exponent <= 3)) fail("skin.normal_exponent", numberText(law.normal_exponent), "1 to 3");
    checkNotNegative("skin.normal_damping", law.normal_damping, "Pa s / m");
  }
  void operator()(const MassSpringDamper& law) const {
    checkPositive("skin.normal_contact_stiffness", law.normal_contact_stiffness, "N/m^3");
    checkPositive("skin.mass", law.mass, "kg");
    checkPositive("skin.stiffness", law.stiffness, "N/m");
    checkNotNegative("skin.damping", law.damping, "N s/m");
  }
  void operator()(const DeformationMask& law) const {
    checkPositive("skin.normal_contact_stiffness", law.normal_contact_stiffness, "N/m^3");
    checkPositive("skin.saturation_pressure", law.saturation_pressure, "Pa");
  }
  void operator()(const Proximity& law) const { checkPositive("skin.sensitivity", law.sensitivity, "N/m"); }
  void operator()(const ElasticLayer& law) const {
    checkPositive("skin.elastic_modulus", law.elastic_modulus, "Pa");
    if (!(law.poisson_ratio >= 0 && law.poisson_ratio <= 0.5)) fail("skin.poisson_ratio", numberText(law.poisson_ratio), "0 to 0.5");
    checkWhole("skin.iterations", law.iterations, 1, kMaxLayerIterations);
    if (!(law.tolerance >= 1e-5 && law.tolerance <= 0.1)) fail("skin.tolerance", numberText(law.tolerance), "1e-5 to 0.1");
  }
  void operator()(const LuGre& law) const {
    checkPositive("skin.normal_contact_stiffness", law.normal_contact_stiffness, "N/m^3");
    if (!(law.bristle_stiffness > 0 && law.bristle_stiffness <= kMaxBristle)) {
      fail("skin.bristle_stiffness", numberText(law.bristle_stiffness), "1/m, > 0 and at most " + numberText(kMaxBristle));
    }
    checkRange("skin.bristle_damping", law.bristle_damping, 0, kMaxBristle, "s/m");
    checkRange("skin.viscous_friction", law.viscous_friction, 0, kMaxBristle, "s/m");
    checkRange("skin.coulomb_friction", law.coulomb_friction, kMinLuGreFriction, kMaxFrictionCoefficient, "of the pressure");
    if (!(law.static_friction >= law.coulomb_friction && law.static_friction <= kMaxFrictionCoefficient)) {
      fail("skin.static_friction", numberText(law.static_friction),
           "coulomb_friction (" + numberText(law.coulomb_friction) + ") to " + numberText(kMaxFrictionCoefficient));
    }
    checkPositive("skin.stribeck_velocity", law.stribeck_velocity, "m/s");
  }
};

void checkFriction(const Friction& friction) {
  const auto [stiffness, coefficient] = friction;
  if (!(coefficient >= 0 && coefficient <= kMaxFrictionCoefficient)) {
    fail("skin.friction_coefficient", numberText(coefficient), "0 to " + numberText(kMaxFrictionCoefficient));
  }
  if (coefficient == 0 && stiffness != 0) fail("skin.tangential_stiffness", numberText(stiffness), "0 where friction_coefficient is 0");
  if (coefficient > 0 && !(stiffness > 0 && stiffness <= kMaxTangentialStiffness)) {
    fail("skin.tangential_stiffness", numberText(stiffness),
         "N/m^3, > 0 and at most " + numberText(kMaxTangentialStiffness) + " where friction_coefficient is > 0");
  }
}

void checkRelaxation(const Skin& skin) {
  const std::vector<RelaxationTerm>& terms = skin.relaxation;
  if (terms.empty()) return;
  const std::string found = std::to_string(terms.size()) + (terms.size() == 1 ? " term" : " terms");
  if (terms.size() > static_cast<std::size_t>(kMaxRelaxationTerms)) {
    fail("skin.relaxation", found, "at most " + std::to_string(kMaxRelaxationTerms));
  }
  if (std::holds_alternative<Proximity>(skin.law))
    fail("skin.relaxation", found, "none for the law proximity, under which nothing presses");
  const double damping = foundationOf(skin).normal_damping;
  if (damping > 0)
    fail("skin.relaxation", found, "none beside normal_damping (" + numberText(damping) + " Pa s / m), which is another model of loss");
  double sum = 0;
  for (std::size_t m = 0; m < terms.size(); ++m) {
    const std::string field = at("skin.relaxation", m);
    // Written so that NaN fails.
    if (!(terms[m].fraction >= 0 && terms[m].fraction < 1)) {
      fail(field + ".fraction", numberText(terms[m].fraction), "of the instantaneous stiffness, >= 0 and < 1");
    }
    checkPositive(field + ".time", terms[m].time, "s");
    sum += terms[m].fraction;
  }
  if (!(sum < 1)) fail("skin.relaxation", "a sum of fractions of " + numberText(sum), "less than 1");
}

void checkSkin(const Skin& skin) {
  checkPositive("skin.thickness", skin.thickness, "m");
  std::visit(CheckLaw{}, skin.law);
  if (skin.friction.friction_coefficient > 0 && !std::holds_alternative<Winkler>(skin.law) &&
      !std::holds_alternative<MassSpringDamper>(skin.law) && !std::holds_alternative<ElasticLayer>(skin.law)) {
    fail("skin.friction_coefficient", numberText(skin.friction.friction_coefficient),
         std::holds_alternative<LuGre>(skin.law) ? "0 beside the law lugre, whose friction is its own: static_friction, coulomb_friction"
                                                 : "0 for a law other than winkler, mass_spring_damper and elastic_layer");
  }
  checkFriction(skin.friction);
  checkNotNegative("skin.margin", skin.margin, "m");
  if (skin.margin > 0 && !std::holds_alternative<ElasticLayer>(skin.law)) {
    fail("skin.margin", numberText(skin.margin), "0, unless the law is elastic_layer");
  }
  checkRelaxation(skin);
}

// An elastic layer is solved on the nodes of one grid.
void checkLayer(const Sensor& sensor) {
  const ElasticLayer* law = std::get_if<ElasticLayer>(&sensor.skin.law);
  if (law == nullptr) return;
  if (sensor.patches.size() != 1) fail("patches", std::to_string(sensor.patches.size()) + " patches", "1 with the law elastic_layer");
  // Before it is counted in samples.
  constexpr double kWidestMargin = 1;  // m
  if (sensor.skin.margin > kWidestMargin) fail("skin.margin", numberText(sensor.skin.margin), "0 to 1 m");
  const std::array<double, 2>& pitch = sensor.patches.front().pitch;
  const double smallest = std::min(pitch[0], pitch[1]) / sensor.samples_per_taxel;
  const double largest = std::max(pitch[0], pitch[1]) / sensor.samples_per_taxel;
  constexpr double kThickest = 0.1;  // m: heights are counted from the base, in float32
  if (sensor.skin.thickness > kThickest)
    fail("skin.thickness", numberText(sensor.skin.thickness), "at most 0.1 m with the law elastic_layer");
  constexpr double kMaxSpacing = 8;  // thicknesses: wider cells hide what the base does
  if (law->base == ElasticLayer::Base::kBonded && largest > kMaxSpacing * sensor.skin.thickness) {
    fail("skin.thickness", numberText(sensor.skin.thickness),
         "at least an eighth of the spacing of samples (" + numberText(largest) + " m) where a layer is bonded");
  }
  constexpr double kMaxSlender = 16;  // of a cell: its influence is that of a line
  if (largest > kMaxSlender * smallest)
    fail("patches[0].pitch", numberText(largest / smallest) + " to 1", "1 to 16 with the law elastic_layer");
  const double num_nodes = (sensor.patches.front().num_rows + 2 * sensor.skin.margin / pitch[0]) *
                           (sensor.patches.front().num_cols + 2 * sensor.skin.margin / pitch[1]) * sensor.samples_per_taxel *
                           sensor.samples_per_taxel;
  for (std::size_t axis = 0; axis < 2; ++axis) {
    constexpr double kMostPerSide = kMaxTaxelsPerSide * kMaxSamplesPerTaxel;
    const double margin = 2 * std::round(sensor.skin.margin * sensor.samples_per_taxel / pitch[axis]);
    if (margin > kMostPerSide) fail("skin.margin", numberText(sensor.skin.margin), "at most " + numberText(kMostPerSide / 2) + " samples");
  }
  if (num_nodes > kMaxLayerNodes) {
    fail("samples_per_taxel",
         std::to_string(sensor.samples_per_taxel) + ", with the margin " + numberText(std::round(num_nodes)) + " nodes,",
         "at most " + std::to_string(kMaxLayerNodes) + " nodes of an elastic layer");
  }
}

// Every taxel must send some of its force to a taxel of its own patch, or normalising per source divides by zero.
void checkReach(const Psf& psf, const GridPatch& patch) {
  const int reach = psf.size / 2;
  for (int i = 0; i < patch.num_rows; ++i) {
    for (int j = 0; j < patch.num_cols; ++j) {
      double sum = 0;
      for (int a = std::max(-reach, -i); a <= std::min(reach, patch.num_rows - 1 - i); ++a) {
        for (int b = std::max(-reach, -j); b <= std::min(reach, patch.num_cols - 1 - j); ++b) {
          sum += psf.kernel[static_cast<std::size_t>((a + reach) * psf.size + b + reach)];
        }
      }
      if (!(sum > 0)) {
        fail("psf.kernel", "a kernel that sends all force of taxel (" + std::to_string(i) + ", " + std::to_string(j) + ") off its patch",
             "with normalization per source, some weight inside; a middle > 0 always has it");
      }
    }
  }
}

double kernelSum(const Psf& psf) {
  double sum = 0;
  for (const double weight : psf.kernel) sum += weight;
  return sum;
}

void checkSpreadByDistance(const Sensor& sensor) {
  const Psf& psf = sensor.psf;
  checkPositive("psf.sigma", psf.sigma, "m");
  checkNotNegative("psf.reach", psf.reach, "m");
  if (psf.size != 1 || psf.kernel != std::vector<double>{1}) fail("psf.sigma", "a value beside a kernel", "either, not both");
  skinNeighbours(sensor);  // refuses a reach over too many taxels
}

void checkPsf(const Sensor& sensor) {
  const Psf& psf = sensor.psf;
  if (psf.sigma != 0 || psf.reach != 0) return checkSpreadByDistance(sensor);
  if (psf.size < 1 || psf.size > kMaxKernelSize || psf.size % 2 == 0) {
    fail("psf.size", std::to_string(psf.size), "taxels per side, odd, 1 to " + std::to_string(kMaxKernelSize));
  }
  const std::size_t num_weights = static_cast<std::size_t>(psf.size) * static_cast<std::size_t>(psf.size);
  if (psf.kernel.size() != num_weights) {
    fail("psf.kernel", std::to_string(psf.kernel.size()) + " weights", std::to_string(num_weights) + ", size x size");
  }
  for (std::size_t i = 0; i < psf.kernel.size(); ++i) checkNotNegative(at("psf.kernel", i), psf.kernel[i], "weight");
  checkPositive("psf.kernel", kernelSum(psf), "sum of weights");
  if (psf.normalization == Psf::Normalization::kPerSource && !(psf.kernel[num_weights / 2] > 0)) {
    for (const GridPatch& patch : sensor.patches) checkReach(psf, patch);
  }
}

// What a force on every taxel sums to in one of them, relative to it, where nothing is normalised.
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

// The largest force that a taxel can bring to its curve: its whole area at the skin's full depth, times what gain, creep and kernel add.
double largestForce(const Sensor& sensor) {
  double area = 0;
  for (const GridPatch& patch : sensor.patches) area = std::max(area, patch.pitch[0] * patch.pitch[1]);
  double gain = 1;
  for (const double taxel_gain : sensor.readout.taxel_gain) gain = std::max(gain, taxel_gain);
  double creep = 1;
  for (const CreepTerm& term : sensor.readout.creep) creep += term.fraction;
  gain *= creep;
  if (sensor.psf.normalization == Psf::Normalization::kNone) gain *= std::max(1.0, largestGain(sensor));
  // An undamped mass swings to twice its rest.
  if (std::holds_alternative<MassSpringDamper>(sensor.skin.law)) gain *= 2;
  // An incompressible layer bears any pressure: the curve must rise until it saturates.
  constexpr double kAnyPressure = 1e18;
  if (std::holds_alternative<ElasticLayer>(sensor.skin.law)) return kAnyPressure * area * gain;
  const Winkler law = foundationOf(sensor.skin);
  return law.normal_contact_stiffness * std::pow(sensor.skin.thickness, law.normal_exponent) * area * gain;
}

void checkTaxelList(const std::string& field, const std::vector<double>& values, int num_taxels, const char* unit) {
  if (!values.empty() && values.size() != static_cast<std::size_t>(num_taxels)) {
    fail(field, std::to_string(values.size()) + " values", std::to_string(num_taxels) + ", one per taxel, or none");
  }
  for (std::size_t i = 0; i < values.size(); ++i) checkNotNegative(at(field, i), values[i], unit);
}

void checkCurvePoints(const Readout& readout) {
  const std::vector<CurvePoint>& points = readout.curve_points;
  if (points.size() > static_cast<std::size_t>(kMaxCurvePoints)) {
    fail("readout.curve_points", std::to_string(points.size()) + " points", "1 to " + std::to_string(kMaxCurvePoints) + ", or none");
  }
  if (readout.curve != Readout{}.curve) fail("readout.curve_points", "a value beside a polynomial", "either, not both");
  if (readout.curve_limit != 0) fail("readout.curve_limit", numberText(readout.curve_limit) + " counts", "0 beside curve_points");
  CurvePoint before;
  for (std::size_t k = 0; k < points.size(); ++k) {
    const std::string field = at("readout.curve_points", k);
    const auto check = [&](const char* key, double value, double least, const char* unit) {
      if (!(std::isfinite(value) && value > least)) {
        fail(field + "." + key, numberText(value),
             std::string(unit) + ", > " + numberText(least) + ", from point to point rising strictly");
      }
    };
    check("force", points[k].force, before.force, "N");
    check("counts", points[k].counts, before.counts, "counts");
    const double slope = (points[k].counts - before.counts) / (points[k].force - before.force);
    constexpr double kLeastSlope = 1e-30, kLargestSlope = 1e30;  // what float32 holds with its inverse
    if (!(slope >= kLeastSlope && slope <= kLargestSlope)) {
      fail(field, "a slope of " + numberText(slope) + " counts/N before it", numberText(kLeastSlope) + " to " + numberText(kLargestSlope));
    }
    before = points[k];
  }
}

void checkCurve(const Sensor& sensor) {
  const Readout& readout = sensor.readout;
  if (readout.curve.empty() || readout.curve.size() > static_cast<std::size_t>(kMaxCurveDegree)) {
    fail("readout.curve", std::to_string(readout.curve.size()) + " terms", "1 to " + std::to_string(kMaxCurveDegree));
  }
  for (std::size_t m = 0; m < readout.curve.size(); ++m) {
    if (!std::isfinite(readout.curve[m])) {
      fail(at("readout.curve", m), numberText(readout.curve[m]), "counts / N^" + std::to_string(m + 1) + ", finite");
    }
  }
  const double end = readout.saturation / readout.output_scale;
  if (readout.curve_limit != 0 && !(std::isfinite(readout.curve_limit) && readout.curve_limit > end)) {
    fail("readout.curve_limit", numberText(readout.curve_limit) + " counts",
         "0 for none, or more than saturation / output_scale, which is " + numberText(end));
  }
  const double force = largestForce(sensor);
  if (!(std::isfinite(force) && force > 0)) fail("skin", "a force of " + numberText(force) + " N per taxel at full depth", "finite, > 0");
  if (!readout.curve_points.empty()) return checkCurvePoints(readout);
  if (!curveRises(readout.curve, force, withoutLimit(end, readout.curve_limit))) {
    fail("readout.curve", "a curve that does not rise all the way",
         "strictly rising from 0 N to where it reaches saturation (" + std::to_string(readout.saturation) +
             " counts) or the force at full depth (" + numberText(force) + " N)");
  }
}

void checkHysteresis(const Readout& readout) {
  const std::size_t num_elements = readout.hysteresis_strength.size();
  if (num_elements > static_cast<std::size_t>(kMaxHysteresisElements)) {
    fail("readout.hysteresis_strength", std::to_string(num_elements) + " elements", "at most " + std::to_string(kMaxHysteresisElements));
  }
  if (readout.hysteresis_width.size() != num_elements) {
    fail("readout.hysteresis_width", std::to_string(readout.hysteresis_width.size()) + " values",
         std::to_string(num_elements) + ", one per hysteresis_strength");
  }
  double sum = 0;
  for (std::size_t e = 0; e < num_elements; ++e) {
    checkNotNegative(at("readout.hysteresis_strength", e), readout.hysteresis_strength[e], "share");
    checkNotNegative(at("readout.hysteresis_width", e), readout.hysteresis_width[e], "N");
    sum += readout.hysteresis_strength[e];
  }
  if (!(sum < 1)) fail("readout.hysteresis_strength", "a sum of " + numberText(sum), "less than 1");
}

void checkCreep(const Readout& readout) {
  if (readout.creep.size() > static_cast<std::size_t>(kMaxCreepTerms)) {
    fail("readout.creep", std::to_string(readout.creep.size()) + " terms", "at most " + std::to_string(kMaxCreepTerms));
  }
  for (std::size_t m = 0; m < readout.creep.size(); ++m) {
    checkRange(at("readout.creep", m) + ".fraction", readout.creep[m].fraction, 0, kMaxCreepFraction, "of the force");
    checkPositive(at("readout.creep", m) + ".time", readout.creep[m].time, "s");
  }
}

void checkTime(const Sensor& sensor) {
  const Readout& readout = sensor.readout;
  checkHysteresis(readout);
  checkCreep(readout);
  checkNotNegative("readout.low_pass_time", readout.low_pass_time, "s");
  checkNotNegative("readout.delay", readout.delay, "s");
  checkNotNegative("readout.jitter", readout.jitter, "s");
  if (readout.jitter > 0 && !(readout.jitter * sensor.frame_rate <= 1)) {
    fail("readout.jitter", numberText(readout.jitter), "s, at most 1 / frame_rate (" + numberText(1 / sensor.frame_rate) + " s)");
  }
  if (readout.jitter > 0 && sensor.frame_rate == 0) {
    fail("readout.jitter", numberText(readout.jitter), "s, 0 where frame_rate is 0 (a frame at every step)");
  }
}

void checkImperfections(const Readout& readout) {
  checkRange("readout.bias", readout.bias, 0, kMaxOffsetCounts, "counts");
  checkRange("readout.random_walk", readout.random_walk, 0, kMaxOffsetCounts, "counts / sqrt(s)");
  checkRange("readout.gain_spread", readout.gain_spread, 0, kMaxGainSpread, "of the logarithm");
  checkRange("readout.press_gain_spread", readout.press_gain_spread, 0, kMaxGainSpread, "of the logarithm");
  checkRange("readout.dead_taxel_probability", readout.dead_taxel_probability, 0, 1, "probability");
}

void checkReadout(const Sensor& sensor) {
  const Readout& readout = sensor.readout;
  checkPositive("readout.output_scale", readout.output_scale, "factor");
  checkNotNegative("readout.trigger", readout.trigger, "N");
  checkWhole("readout.adc_bits", readout.adc_bits, 1, kMaxAdcBits);
  checkWhole("readout.saturation", readout.saturation, 1, (1 << readout.adc_bits) - 1);
  checkNotNegative("readout.noise", readout.noise, "counts");
  checkTaxelList("readout.taxel_gain", readout.taxel_gain, numTaxels(sensor), "factor");
  checkTaxelList("readout.taxel_trigger", readout.taxel_trigger, numTaxels(sensor), "N");
  checkTime(sensor);
  checkImperfections(readout);
  checkCurve(sensor);
}

}  // namespace

void checkSensor(const Sensor& sensor) {
  checkPatches(sensor.patches);
  checkWhole("samples_per_taxel", sensor.samples_per_taxel, 1, kMaxSamplesPerTaxel);
  checkSkin(sensor.skin);
  checkLayer(sensor);
  if (sensor.psf.sigma > 0 && std::holds_alternative<ElasticLayer>(sensor.skin.law)) {
    fail("psf.sigma", numberText(sensor.psf.sigma), "a kernel over the grid, or none, for the law elastic_layer");
  }
  if (isTaxelList(sensor) && std::holds_alternative<DeformationMask>(sensor.skin.law)) {
    fail("skin.law", "deformation_mask",
         "winkler, mass_spring_damper or proximity for taxels with places of their own, as its mask goes over the rows of a grid");
  }
  checkPsf(sensor);
  checkReadout(sensor);
  checkNotNegative("frame_rate", sensor.frame_rate, "Hz");
}

}  // namespace taxelsim
