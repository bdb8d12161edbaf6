#include "cli/frame_output.h"
#include "cli/print.h"

#include <spdlog/fmt/fmt.h>

#include <algorithm>
#include <array>
#include <cstdint>
#include <nlohmann/json.hpp>
#include <numbers>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "simulation/feature_table.h"

namespace taxelsim::cli {
namespace {

// Numbers are float32: the text of each is the shortest that parses to the same float32.
using FrameJson = nlohmann::basic_json<nlohmann::ordered_map, std::vector, std::string, bool, std::int64_t, std::uint64_t, float>;

template <typename T>
FrameJson arrayOf(std::span<const T> values) {
  return FrameJson(std::vector<T>(values.begin(), values.end()));
}

// Values per taxel, `width` of each: a list of rows for one grid patch, else a list of taxels.
template <typename T>
FrameJson taxelsOf(const Sensor& sensor, std::span<const T> values, std::size_t width = 1) {
  const auto taxel = [&](std::size_t t) -> FrameJson {
    if (width == 1) return values[t];
    return arrayOf(values.subspan(t * width, width));
  };
  FrameJson list = FrameJson::array();
  const std::size_t num_taxels = values.size() / width;
  const std::size_t num_cols = sensor.patches.size() == 1 ? static_cast<std::size_t>(sensor.patches[0].num_cols) : 0;
  for (std::size_t t = 0; t < num_taxels; ++t) {
    if (num_cols == 0) {
      list.push_back(taxel(t));
      continue;
    }
    if (t % num_cols == 0) list.push_back(FrameJson::array());
    list.back().push_back(taxel(t));
  }
  return list;
}

constexpr const char* kContactTypes[] = {"none", "point", "edge", "area"};

FrameJson jsonOf(ContactType type) {
  return kContactTypes[static_cast<std::size_t>(type)];
}
template <typename T>
FrameJson jsonOf(T value) {
  return value;
}

// One row of a feature: a value, or an array of `width` values.
FrameJson rowOf(const FeatureValues& values, std::size_t width, std::size_t row) {
  return std::visit(
      [&](const auto& all) {
        if (width == 1) return jsonOf(all[row]);
        FrameJson list = FrameJson::array();
        for (const auto value : all.subspan(width * row, width)) list.push_back(jsonOf(value));
        return list;
      },
      values);
}

template <typename Field, typename View>
void addFeatures(FrameJson& json, std::span<const Field> table, const View& view, std::size_t row = 0) {
  for (const Field& field : table) json[std::string(field.name)] = rowOf(field.values(view), field.width, row);
}

// Number of regions that have rows; the view may have more rows.
std::size_t numRegionRows(const ContactFeatureView& contact) {
  return static_cast<std::size_t>(std::min(contact.num_regions[0], static_cast<std::int32_t>(kMaxRegions)));
}

FrameJson contactRow(const ContactFeatureView& contact, std::size_t row) {
  FrameJson json;
  json["contact_type"] = nullptr;  // these two are first
  json["patch"] = nullptr;
  addFeatures(json, imageFeatures(), contact, row);
  addFeatures(json, contactFeatures(), contact, row);
  return json;
}

FrameJson contactJson(const ContactFeatureView& contact) {
  FrameJson json;
  json["sensor"] = contactRow(contact, 0);
  json["patches"] = FrameJson::array();
  const auto num_patches = static_cast<std::size_t>(contact.num_patches);
  for (std::size_t p = 0; p < num_patches; ++p) json["patches"].push_back(contactRow(contact, 1 + p));
  addFeatures(json, regionFeatures(), contact);
  json["regions"] = FrameJson::array();
  for (std::size_t r = 0; r < numRegionRows(contact); ++r) json["regions"].push_back(contactRow(contact, 1 + num_patches + r));
  return json;
}

// Integers and flags among these features are written as floats, 1.0: the form of the first version.
void addTruth(FrameJson& json, const GroundTruthView& truth) {
  for (const FeatureField<GroundTruthView>& field : truthFeatures()) {
    std::visit(
        [&](const auto& values) {
          if (values.empty()) return;
          std::vector<float> numbers;
          for (const auto value : values) numbers.push_back(static_cast<float>(value));
          json[std::string(field.name)] = rowOf(FeatureValues(std::span<const float>(numbers)), field.width, 0);
        },
        field.values(truth));
  }
}

}  // namespace

std::string frameJson(const Sensor& sensor, const FrameView& frame) {
  FrameJson json;
  json["sensor"] = sensor.name;
  json["tactile_image"] = taxelsOf(sensor, frame.tactile_image);
  const auto addTaxels = [&sensor](FrameJson& to, const char* name, auto values, std::size_t components) {
    if (!values.empty()) to[name] = taxelsOf(sensor, values, components);
  };
#define TAXELSIM_MEASURED(name, block, type, leading, components, ...) addTaxels(json, #name, frame.name, components);
#define TAXELSIM_TRUE(name, block, type, leading, components, ...) addTaxels(clean, #name, truth.name, components);
  TAXELSIM_MEASURED_TAXELS(TAXELSIM_MEASURED)
  addFeatures(json, imageFeatures(), frame);
  addFeatures(json, readoutFeatures(), frame);
  json["contact"] = contactJson(frame.contact);
  const GroundTruthView& truth = frame.ground_truth;
  FrameJson& clean = json["ground_truth"];
  TAXELSIM_TRUE_TAXELS(TAXELSIM_TRUE)
  addFeatures(clean, imageFeatures(), truth);
  clean["contact"] = contactJson(truth.contact);
  addTruth(clean, truth);
  return json.dump(2, ' ', true, nlohmann::ordered_json::error_handler_t::replace);
}

namespace {

// Counts in the form of the sensor: one number per taxel, the first of each `width` values.
template <typename T>
void printTaxels(const Sensor& sensor, std::string_view name, std::span<const T> values, std::size_t width = 1) {
  std::size_t digits = 0;
  for (std::size_t v = 0; v < values.size(); v += width) digits = std::max(digits, std::to_string(values[v]).size());
  const std::size_t num_taxels = (values.size() + width - 1) / width;
  std::size_t taxel = 0;
  if (isTaxelList(sensor)) {
    constexpr std::size_t kTaxelsPerLine = 16;
    printOut("{}, counts ({} taxels, {} a line)\n", name, num_taxels, kTaxelsPerLine);
    for (; taxel < num_taxels; ++taxel)
      printOut("{} {:>{}}{}", taxel % kTaxelsPerLine == 0 ? " " : "", values[taxel * width], digits,
               (taxel + 1) % kTaxelsPerLine == 0 || taxel + 1 == num_taxels ? "\n" : "");
    return;
  }
  for (const GridPatch& patch : sensor.patches) {
    printOut("{}{}{}, counts ({} rows along x, {} columns along y)\n", name, patch.name.empty() ? "" : " of ", patch.name, patch.num_rows,
             patch.num_cols);
    for (int i = 0; i < patch.num_rows; ++i) {
      std::string line = " ";
      for (int j = 0; j < patch.num_cols; ++j) line += fmt::format(" {:>{}}", values[taxel++ * width], digits);
      printOut("{}\n", line);
    }
  }
}

void printImages(const Sensor& sensor, const FrameView& frame) {
  printTaxels(sensor, "tactile_image", frame.tactile_image);
  if (frame.taxel_counts.empty()) return;
  constexpr std::array kAxes{"along x", "along y", "along the normal"};
  for (std::size_t axis = 0; axis < kAxes.size(); ++axis) {
    printTaxels(sensor, fmt::format("taxel_counts {}", kAxes[axis]), frame.taxel_counts.subspan(axis), kAxes.size());
  }
}

std::string valueText(float value) {
  return fmt::format("{:.6g}", value == 0 ? 0 : value);  // no "-0"
}
std::string valueText(ContactType type) {
  return kContactTypes[static_cast<std::size_t>(type)];
}

// The first row of a feature.
std::string rowText(const FeatureValues& values, std::size_t width) {
  return std::visit(
      [&](const auto& all) {
        std::string text;
        for (const auto value : all.first(std::min(width, all.size()))) {
          if (!text.empty()) text += "  ";
          if constexpr (std::is_same_v<decltype(value), const ContactType>) {
            text += valueText(value);
          } else {
            text += valueText(static_cast<float>(value));
          }
        }
        return text;
      },
      values);
}

// Angles of axes are in (-pi/2, pi/2]. One that rounding puts at -pi/2 is shown as pi/2, the same axis.
std::string featureText(std::string_view name, const FeatureValues& values, std::size_t width) {
  std::string text = rowText(values, width);
  static const std::string kRightAngle = valueText(std::numbers::pi_v<float> / 2);
  if (name.ends_with("edge_angle") && text == "-" + kRightAngle) return kRightAngle;
  return text;
}

void printRow(std::string_view name, std::string_view unit, const std::string& measured, const std::string& clean) {
  printOut("{:<24} {:<7} {:<40} {}\n", name, unit, measured, clean);
}

// One line per feature of `table`: name, unit, measured value, clean value.
template <typename Field, typename View>
void printBoth(std::span<const Field> table, const View& measured, const View& clean) {
  for (const Field& field : table) {
    printRow(field.name, field.unit, featureText(field.name, field.values(measured), field.width),
             featureText(field.name, field.values(clean), field.width));
  }
}

}  // namespace

void printFrame(const Sensor& sensor, const FrameView& frame) {
  printImages(sensor, frame);
  const GroundTruthView& truth = frame.ground_truth;
  printOut("\n");
  printRow("feature", "unit", "measured", "ground truth");
  printBoth<FeatureField<FeatureView>, FeatureView>(imageFeatures(), frame, truth);
  printBoth(contactFeatures(), frame.contact, truth.contact);
  printBoth(regionFeatures(), frame.contact, truth.contact);
  for (const FeatureField<FrameView>& field : readoutFeatures()) {
    printRow(field.name, field.unit, rowText(field.values(frame), field.width), "");
  }
  for (const FeatureField<GroundTruthView>& field : truthFeatures()) {
    const std::string text = rowText(field.values(truth), field.width);
    if (!text.empty()) printRow(field.name, field.unit, "", text);
  }
}

}  // namespace taxelsim::cli
