#include "sensor/checks.h"

#include <cmath>

namespace taxelsim {
namespace {

constexpr double kUnitTolerance = 1e-3;  // of a quaternion's length; four decimal digits suffice

void checkPatch(const std::string& field, const GridPatch& patch) {
  checkFields(field + ".", kGridPatchFields, patch);
  for (std::size_t axis = 0; axis < 2; ++axis) checkNumber(elementOf(field + ".pitch", axis), patch.pitch[axis], Allowed::above(0, "m"));
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const double coordinate = patch.X_SP.position[axis];
    if (!std::isfinite(coordinate)) failField(elementOf(field + ".X_SP.position", axis), numberText(coordinate), "m, finite");
  }
  double norm = 0;
  for (const double component : patch.X_SP.rotation) norm += component * component;
  norm = std::sqrt(norm);
  if (!(std::abs(norm - 1) <= kUnitTolerance)) {
    failField(field + ".X_SP.rotation", "a quaternion of length " + numberText(norm), "length 1 within " + numberText(kUnitTolerance));
  }
}

void checkPatches(const std::vector<GridPatch>& patches) {
  if (patches.empty()) failField("patches", "an empty list", "at least one patch");
  int num_taxels = 0;  // stays below kMaxTaxels + kMaxTaxelsPerSide^2
  for (std::size_t i = 0; i < patches.size(); ++i) {
    checkPatch(elementOf("patches", i), patches[i]);
    num_taxels += patches[i].num_rows * patches[i].num_cols;
    if (num_taxels > kMaxTaxels)
      failField("patches", std::to_string(num_taxels) + " taxels or more", "at most " + std::to_string(kMaxTaxels) + " in all");
  }
}

// An elastic layer knows how soft the covered part of a cell is, of cells that are not much wider than the layer is thick.
void checkCellsOfLayer(const Sensor& sensor, const ElasticLayer& law) {
  const std::array<double, 2>& pitch = sensor.patches.front().pitch;
  const double spacing = std::max(pitch[0], pitch[1]) / sensor.samples_per_taxel;
  if (law.base == ElasticLayer::Base::kBonded && spacing > sensor.skin.thickness) {
    failField("samples_per_taxel", std::to_string(sensor.samples_per_taxel),
              "samples at most a thickness (" + numberText(sensor.skin.thickness) +
                  " m) apart with a bonded elastic_layer and depth_sampling: area");
  }
}

void checkDepthSampling(const Sensor& sensor) {
  if (sensor.depth_sampling == DepthSampling::kPoint) return;
  if (const auto* layer = std::get_if<ElasticLayer>(&sensor.skin.law)) checkCellsOfLayer(sensor, *layer);
}

}  // namespace

void checkSensor(const Sensor& sensor) {
  checkPatches(sensor.patches);
  checkFields("", kSensorFields, sensor);
  checkSkin(sensor.skin);
  checkLayer(sensor);
  checkDepthSampling(sensor);
  if (sensor.psf.sigma > 0 && std::holds_alternative<ElasticLayer>(sensor.skin.law)) {
    failField("psf.sigma", numberText(sensor.psf.sigma), "a kernel over the grid, or none, for the law elastic_layer");
  }
  checkPsf(sensor);
  checkReadout(sensor);
  checkFields("", kFrameRateFields, sensor);
}

}  // namespace taxelsim
