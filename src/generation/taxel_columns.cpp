#include "generation/taxel_columns.h"

#include <span>

namespace taxelsim {
namespace {

using Source = FrameColumn::Source;

// (num_rows, num_cols) of one grid patch, else (num_taxels).
std::vector<std::size_t> taxelShape(const Sensor& sensor) {
  if (sensor.patches.size() != 1) return {static_cast<std::size_t>(numTaxels(sensor))};
  return {static_cast<std::size_t>(sensor.patches[0].num_rows), static_cast<std::size_t>(sensor.patches[0].num_cols)};
}

// The same, then the components of a vector per taxel.
std::vector<std::size_t> taxelVectors(const Sensor& sensor, std::size_t size) {
  std::vector<std::size_t> shape = taxelShape(sensor);
  shape.push_back(size);
  return shape;
}

}  // namespace

void addMeasuredTaxels(const Sensor& sensor, const std::set<std::string>& groups, std::vector<FrameColumn>& columns) {
  if (groups.contains("tactile_image")) {
    columns.push_back(
        {{"data/tactile_image", ScalarType::kUint16, taxelShape(sensor), "counts", "Output of the sensor.", false}, Source::kImage});
  }
  if (groups.contains("taxel_counts")) {
    columns.push_back(
        {{"data/taxel_counts", ScalarType::kInt32, taxelVectors(sensor, 3), "counts",
          "Output of three-axis taxels along x, y and the normal of each; shear as it acts on the skin, a press positive.", false},
         Source::kFeature,
         [](const FrameView& frame) { return FeatureValues(frame.taxel_counts); }});
  }
}

void addTrueTaxels(const Sensor& sensor, const std::set<std::string>& groups, std::vector<FrameColumn>& columns) {
  const auto add = [&](const std::string& name, std::vector<std::size_t> shape, const char* unit, const char* description,
                       std::span<const float> GroundTruthView::*member) {
    if (!groups.contains(name)) return;
    columns.push_back({{"data/ground_truth/" + name, ScalarType::kFloat32, std::move(shape), unit, description, false},
                       Source::kFeature,
                       [member](const FrameView& frame) { return FeatureValues(frame.ground_truth.*member); }});
  };
  add("tactile_normal_force", taxelShape(sensor), "N", "Normal force of each taxel after the point spread function, before the readout.",
      &GroundTruthView::tactile_normal_force);
  add("tactile_shear_force", taxelVectors(sensor, 2), "N",
      "Shear force of each taxel along its x and y after the point spread function, before the readout.",
      &GroundTruthView::tactile_shear_force);
  add("penetration_depth", taxelShape(sensor), "m", "Depth of the object in the skin, mean over each taxel.",
      &GroundTruthView::penetration_depth);
}

void addOffArrayPoints(std::vector<FrameColumn>& columns) {
  const auto add = [&](const char* name, ScalarType type, const char* unit, const char* description, auto member) {
    columns.push_back({{std::string("data/ground_truth/") + name, type, {}, unit, description, false},
                       Source::kFeature,
                       [member](const FrameView& frame) { return FeatureValues(frame.ground_truth.*member); }});
  };
  add("off_array_load", ScalarType::kFloat32, "N", "Normal force of the contact points that lie on no taxel.",
      &GroundTruthView::off_array_load);
  add("off_array_contacts", ScalarType::kUint16, "1", "Contact points that lie on no taxel.", &GroundTruthView::off_array_contacts);
}

}  // namespace taxelsim
