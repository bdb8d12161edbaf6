#include "scene/readout_reader.h"

#include <algorithm>
#include <optional>
#include <string>

#include "scene/curve_reader.h"
#include "scene/terms_reader.h"
#include "sensor/fields.h"
#include "taxelsim/sensor_hints.h"

namespace taxelsim {
namespace {

// The numbers of a list, or of a list of rows.
std::vector<double> flatNumbers(const YamlNode& node, const Allowed& allowed, std::vector<std::size_t>& row_lengths) {
  std::vector<double> result;
  for (const YamlNode& item : node.items("a list of numbers, or of rows of numbers")) {
    if (!item.isList()) {
      result.push_back(item.number(allowed));
      continue;
    }
    const std::vector<YamlNode> row = item.items("a row of numbers");
    row_lengths.push_back(row.size());
    for (const YamlNode& number : row) result.push_back(number.number(allowed));
  }
  if (!row_lengths.empty() && node.items("").size() != row_lengths.size()) node.fail("numbers and rows are mixed: either, not both");
  return result;
}

// One number per taxel, or none.
std::vector<double> readPerTaxel(const YamlMap& map, std::string_view key, const std::vector<GridPatch>& patches) {
  std::vector<double> values;
  if (const std::optional<YamlNode> node = map.find(key)) {
    std::size_t num_taxels = 0;
    for (const GridPatch& patch : patches)
      num_taxels += static_cast<std::size_t>(patch.num_rows) * static_cast<std::size_t>(patch.num_cols);
    std::vector<std::size_t> row_lengths;
    values = flatNumbers(*node, map.allowedOf(key), row_lengths);
    if (!values.empty() && values.size() != num_taxels) {
      node->fail(std::to_string(values.size()) + " numbers are not allowed: one for each of the " + std::to_string(num_taxels) + " taxels");
    }
    const auto num_cols = static_cast<std::size_t>(patches.front().num_cols);
    for (const std::size_t length : row_lengths) {
      if (patches.size() == 1 && length != num_cols) {
        node->fail("a row of " + std::to_string(length) + " is not allowed: rows of " + std::to_string(num_cols) + " (num_cols)");
      }
    }
  }
  map.canonical().line(key, canonicalList(values));
  return values;
}

// A number, or a list of them: one per element of the hysteresis.
std::vector<double> readElements(const YamlMap& map, std::string_view key) {
  const Allowed& allowed = map.allowedOf(key);
  std::vector<double> values;
  if (const std::optional<YamlNode> node = map.find(key)) {
    if (node->isList()) {
      const std::string what = "a number, or a list of at most " + std::to_string(kMaxHysteresisElements);
      const std::vector<YamlNode> items = node->items(what);
      if (items.size() > static_cast<std::size_t>(kMaxHysteresisElements)) node->refuse(what);
      for (const YamlNode& item : items) values.push_back(item.number(allowed));
    } else {
      values.push_back(node->number(allowed));
    }
  }
  map.canonical().line(key, canonicalList(values));
  return values;
}

void readHysteresis(const YamlMap& map, Readout& readout) {
  readout.hysteresis_strength = readElements(map, "hysteresis_strength");
  readout.hysteresis_width = readElements(map, "hysteresis_width");
  if (readout.hysteresis_width.size() == readout.hysteresis_strength.size()) return;
  const bool has_width = map.has("hysteresis_width");
  const YamlNode place = has_width ? map.require("hysteresis_width", "") : map.require("hysteresis_strength", "");
  place.fail(std::to_string(readout.hysteresis_strength.size()) + " of hysteresis_strength and " +
             std::to_string(readout.hysteresis_width.size()) + " of hysteresis_width: as many of both");
}

bool hasTrigger(const YamlMap& map) {
  return map.has("trigger") || map.has("taxel_trigger");
}

// The default of the trigger follows from the noise, which is after it in the canonical text.
double defaultTrigger(const YamlMap& map, Readout readout) {
  Canonical unused;
  const YamlMap unwritten(map, unused);
  readFields(unwritten, kOutputFields, readout);
  readFields(unwritten, kNoiseFields, readout);
  return noiseTrigger(readout);
}

// Notes a trigger that noise exceeds often. Taxels with a negative one are meant to read without a load.
void noteVisibleNoise(const YamlMap& map, const Readout& readout) {
  if (!hasTrigger(map)) return;
  const std::vector<double>& triggers = readout.taxel_trigger;
  const double least = triggers.empty() ? readout.trigger : *std::min_element(triggers.begin(), triggers.end());
  const double silent = noiseTrigger(readout);
  if (least < 0 || least >= silent) return;
  map.require(triggers.empty() ? "trigger" : "taxel_trigger", "")
      .note(canonicalNumber(least) + " N is less than three standard deviations of the noise, " + canonicalNumber(silent) +
            " N: taxels read without touch");
}

// The electronics for shear, if the file has them.
std::optional<ThreeAxisReadout> readThreeAxis(const YamlMap& readout) {
  if (!readout.has("three_axis")) return {};
  const YamlMap map(readout, "three_axis");
  ThreeAxisReadout axes;
  const std::string what = "three rows (x, y, normal) of three numbers, counts/N";
  const YamlNode gain = map.require("gain", what);
  const std::vector<YamlNode> rows = gain.items(what);
  if (rows.size() != axes.gain.size()) gain.refuse(what);
  std::string text;
  for (std::size_t a = 0; a < rows.size(); ++a) {
    const std::vector<double> row = rows[a].numbers(map.allowedOf("gain"), axes.gain[a].size());
    std::copy(row.begin(), row.end(), axes.gain[a].begin());
    text += (text.empty() ? "" : ", ") + canonicalList(row);
  }
  map.canonical().line("gain", "[" + text + "]");
  readFields(map, kThreeAxisFields, axes);
  return axes;
}

}  // namespace

Readout readReadout(const YamlMap& sensor, const std::vector<GridPatch>& patches) {
  const YamlMap map(sensor, "readout");
  Readout readout;
  readCurve(map, readout);
  if (!hasTrigger(map)) readout.trigger = defaultTrigger(map, readout);
  readFields(map, kOutputFields, readout);
  const std::uint64_t full_scale = (std::uint64_t{1} << readout.adc_bits) - 1;
  readout.saturation = static_cast<int>(map.integer("saturation", 1, full_scale, full_scale));
  readFields(map, kNoiseFields, readout);
  readout.taxel_gain = readPerTaxel(map, "taxel_gain", patches);
  readout.taxel_trigger = readPerTaxel(map, "taxel_trigger", patches);
  noteVisibleNoise(map, readout);
  readout.calibrated_gain = readPerTaxel(map, "calibrated_gain", patches);
  readHysteresis(map, readout);
  readout.creep = readTerms(map, "creep", kMaxCreepTerms, kCreepFields);
  readFields(map, kTimeFields, readout);
  readFields(map, kImperfectionFields, readout);
  readout.three_axis = readThreeAxis(map);
  return readout;
}

}  // namespace taxelsim
