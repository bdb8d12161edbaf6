#include "generation/taxel_columns.h"

#include <span>
#include <string>
#include <type_traits>

namespace taxelsim {
namespace {

using Source = FrameColumn::Source;

// (num_rows, num_cols) of one grid patch, else (num_taxels); then the components of each taxel.
std::vector<std::size_t> taxelShape(const Sensor& sensor, std::size_t components = 1) {
  std::vector<std::size_t> shape{static_cast<std::size_t>(numTaxels(sensor))};
  if (sensor.patches.size() == 1) {
    shape = {static_cast<std::size_t>(sensor.patches[0].num_rows), static_cast<std::size_t>(sensor.patches[0].num_cols)};
  }
  if (components > 1) shape.push_back(components);
  return shape;
}

template <typename T>
constexpr ScalarType kScalar = std::is_integral_v<T> ? ScalarType::kInt32 : ScalarType::kFloat32;

// Statements that add the column of an output per taxel, from the view that view(frame) returns.
#define TAXELSIM_COLUMN(name, block, type, leading, components, unit, text)                                \
  if (groups.contains(#name)) {                                                                            \
    columns.push_back({{prefix + #name, kScalar<type>, taxelShape(sensor, components), unit, text, false}, \
                       Source::kFeature,                                                                   \
                       [view](const FrameView& frame) { return FeatureValues(view(frame).name); }});       \
  }

}  // namespace

void addMeasuredTaxels(const Sensor& sensor, const std::set<std::string>& groups, std::vector<FrameColumn>& columns) {
  const std::string prefix = "data/";
  if (groups.contains("tactile_image")) {
    columns.push_back(
        {{prefix + "tactile_image", ScalarType::kUint16, taxelShape(sensor), "counts", "Output of the sensor.", false}, Source::kImage});
  }
  const auto view = [](const FrameView& frame) -> const FrameView& { return frame; };
  TAXELSIM_MEASURED_TAXELS(TAXELSIM_COLUMN)
}

void addTrueTaxels(const Sensor& sensor, const std::set<std::string>& groups, std::vector<FrameColumn>& columns) {
  const std::string prefix = "data/ground_truth/";
  const auto view = [](const FrameView& frame) -> const GroundTruthView& { return frame.ground_truth; };
  TAXELSIM_TRUE_TAXELS(TAXELSIM_COLUMN)
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
