#include <algorithm>
#include <cmath>
#include <limits>
#include <string>

#include "geometry/text.h"
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
};

// Pressure (Pa) at the skin's full depth, at rest; one a law.
struct FullPressure {
  double thickness;

  double operator()(const Winkler& law) const { return law.normal_contact_stiffness * std::pow(thickness, law.normal_exponent); }
};

void checkSkin(const Skin& skin) {
  checkPositive("skin.thickness", skin.thickness, "m");
  std::visit(CheckLaw{}, skin.law);
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

// The largest force that a taxel can bring to its curve: its whole area at the skin's full depth, times what gain and kernel add.
double largestForce(const Sensor& sensor) {
  double area = 0;
  for (const GridPatch& patch : sensor.patches) area = std::max(area, patch.pitch[0] * patch.pitch[1]);
  double gain = 1;
  for (const double taxel_gain : sensor.readout.taxel_gain) gain = std::max(gain, taxel_gain);
  if (sensor.psf.normalization == Psf::Normalization::kNone) gain *= std::max(1.0, largestGain(sensor));
  return std::visit(FullPressure{sensor.skin.thickness}, sensor.skin.law) * area * gain;
}

void checkTaxelList(const std::string& field, const std::vector<double>& values, int num_taxels, const char* unit) {
  if (!values.empty() && values.size() != static_cast<std::size_t>(num_taxels)) {
    fail(field, std::to_string(values.size()) + " values", std::to_string(num_taxels) + ", one per taxel, or none");
  }
  for (std::size_t i = 0; i < values.size(); ++i) checkNotNegative(at(field, i), values[i], unit);
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
  const double force = largestForce(sensor);
  if (!(std::isfinite(force) && force > 0)) fail("skin", "a force of " + numberText(force) + " N per taxel at full depth", "finite, > 0");
  if (!curveRises(readout.curve, force, readout.saturation / readout.output_scale)) {
    fail("readout.curve", "a curve that does not rise all the way",
         "strictly rising from 0 N to where it reaches saturation (" + std::to_string(readout.saturation) +
             " counts) or the force at full depth (" + numberText(force) + " N)");
  }
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
  checkCurve(sensor);
}

}  // namespace

void checkSensor(const Sensor& sensor) {
  checkPatches(sensor.patches);
  checkWhole("samples_per_taxel", sensor.samples_per_taxel, 1, kMaxSamplesPerTaxel);
  checkSkin(sensor.skin);
  checkPsf(sensor);
  checkReadout(sensor);
  checkNotNegative("frame_rate", sensor.frame_rate, "Hz");
}

}  // namespace taxelsim
