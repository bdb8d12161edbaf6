#include "taxelsim/measurement.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "base/text.h"
#include "scene/hashed_file.h"
#include "scene/mask_file.h"
#include "scene/measurement_reader.h"
#include "scene/number_table.h"
#include "scene/sensor_file.h"
#include "taxelsim/error.h"

namespace taxelsim {
namespace {

// From dry ice to above what electronics bear.
constexpr Allowed kTemperature = Allowed::within(-100, 300, "degrees Celsius");
constexpr std::uintmax_t kMaxTableBytes = std::uintmax_t{4} << 30;

double positive(const YamlMap& map, std::string_view key) {
  return map.number(key, Allowed::above(0, "m"));
}

Indenter readIndenter(const YamlMap& measurement) {
  const char* const kWhat = "flat_pin, stamp, sphere, cylinder or cone";
  measurement.require("indenter", kWhat);
  const YamlMap map(measurement, "indenter", {"flat_pin", "stamp", "sphere", "cylinder", "cone"});
  Indenter indenter;
  int given = 0;
  const auto shape = [&](std::string_view key, Indenter::Shape value, YamlMap::Keys keys, const auto& read) {
    if (!map.has(key)) return;
    if (++given > 1) map.require(key, "").fail("a second shape is given: allowed is one of " + std::string(kWhat));
    indenter.shape = value;
    read(YamlMap(map, key, std::move(keys)));
  };
  const auto radius = [&](const YamlMap& keys) { indenter.radius = positive(keys, "radius"); };
  shape("flat_pin", Indenter::Shape::kFlatPin, {"radius[_mm]"}, radius);
  shape("stamp", Indenter::Shape::kStamp, {"size[_mm]"},
        [&](const YamlMap& keys) { indenter.size = keys.numbers<2>("size", Allowed::above(0, "m")); });
  shape("sphere", Indenter::Shape::kSphere, {"radius[_mm]"}, radius);
  shape("cylinder", Indenter::Shape::kCylinder, {"radius[_mm]", "length[_mm]"}, [&](const YamlMap& keys) {
    radius(keys);
    indenter.length = positive(keys, "length");
  });
  shape("cone", Indenter::Shape::kCone, {"half_angle[_deg]"}, [&](const YamlMap& keys) {
    constexpr double kMost = 89 * std::numbers::pi / 180;
    indenter.half_angle = keys.number("half_angle", {.min = 0, .max = kMost, .above_min = true, .unit = "rad"});
  });
  if (given == 0) map.node().refuse(kWhat);
  return indenter;
}

double countsAt(const NumberTable& table, std::size_t row, std::size_t column, double full_scale) {
  const double counts = table.at(row, column);
  if (counts < 0 || counts > full_scale) {
    table.failAtValue(row, column,
                      numberText(counts) + " is not allowed: 0 to " + numberText(full_scale) + " counts, by the sensor's adc_bits");
  }
  return counts;
}

void checkRising(const NumberTable& table, const std::vector<double>& time) {
  for (std::size_t row = 1; row < time.size(); ++row) {
    if (!(time[row] > time[row - 1])) {
      table.failAtValue(
          row, table.columnOf(kRecordedTime),
          numberText(time[row]) + " s is not allowed: must be later than the previous row (" + numberText(time[row - 1]) + " s)");
    }
  }
}

// What a reader of one kind of measurement needs.
struct Source {
  const YamlMap& map;
  const NumberTable& table;
  const Sensor& sensor;
  double full_scale;                    // counts
  const std::filesystem::path& tables;  // folder
};

std::vector<std::size_t> taxelColumns(const Source& source) {
  const std::optional<YamlNode> given = source.map.find("taxel_columns");
  if (given && given->isList()) {
    std::vector<std::string> names;
    for (const YamlNode& name : given->items("a list of names of columns")) names.push_back(name.text("the name of a column"));
    const int num_taxels = numTaxels(source.sensor);
    if (names.size() != static_cast<std::size_t>(num_taxels)) {
      given->fail(std::to_string(names.size()) + " names are not allowed: the sensor has " + std::to_string(num_taxels) + " taxels");
    }
    return source.table.columnsNamed(names);
  }
  const bool one_grid = source.sensor.patches.size() == 1;
  const std::optional<std::string> otherwise = one_grid ? std::optional<std::string>(kGridColumns) : std::nullopt;
  const std::string pattern = source.map.text("taxel_columns", "names of columns, such as \"r{row}_c{col}\" or \"{patch}\"", otherwise);
  return source.table.taxelColumns(source.sensor, pattern);
}

Images readImages(const Source& source) {
  const std::vector<std::size_t> columns = taxelColumns(source);
  Images images;
  images.num_taxels = columns.size();
  images.time = source.table.find(kRecordedTime);
  checkRising(source.table, images.time);
  images.counts.reserve(source.table.numRows() * columns.size());
  for (std::size_t row = 0; row < source.table.numRows(); ++row) {
    for (const std::size_t column : columns) {
      images.counts.push_back(static_cast<float>(countsAt(source.table, row, column, source.full_scale)));
    }
  }
  return images;
}

std::vector<double> readCounts(const Source& source, double most) {
  const std::vector<double> counts = source.table.require(kCounts);
  const std::size_t column = source.table.columnOf(kCounts);
  for (std::size_t row = 0; row < counts.size(); ++row) countsAt(source.table, row, column, most);
  return counts;
}

ForceCurve readForceCurve(const Source& source) {
  ForceCurve curve;
  curve.curve_degree = static_cast<int>(source.map.integer("curve_degree", 1, kMaxCurveDegree, 1));
  curve.divider = source.map.choice("divider", {"true", "false"}, "false") == "true";
  if (source.map.has("curve_segments")) {
    curve.curve_segments = static_cast<int>(source.map.integer("curve_segments", 2, kMaxCurvePoints));
    for (const char* const key : {"curve_degree", "divider"}) {
      if (const std::optional<YamlNode> both = source.map.find(key)) both->fail("not allowed together with `curve_segments`");
    }
  }
  const std::vector<double> taxel = source.table.require(kTaxel);
  const double num_taxels = numTaxels(source.sensor);
  for (std::size_t row = 0; row < taxel.size(); ++row) {
    if (taxel[row] < 0 || taxel[row] >= num_taxels || taxel[row] != std::floor(taxel[row])) {
      source.table.failAtValue(row, source.table.columnOf(kTaxel),
                               numberText(taxel[row]) + " is not allowed: a whole number from 0 to " + numberText(num_taxels - 1));
    }
    curve.taxel.push_back(static_cast<int>(taxel[row]));
  }
  curve.force = source.table.require(kForce);
  curve.counts = readCounts(source, source.full_scale);
  curve.time = source.table.find(kRecordedTime);
  checkRising(source.table, curve.time);
  return curve;
}

ForceDepth readForceDepth(const Source& source) {
  return {.indenter = readIndenter(source.map), .depth = source.table.require(kDepth), .force = source.table.require(kForce)};
}

PointImages readPointImages(const Source& source) {
  PointImages points{
      .indenter = readIndenter(source.map), .position = {}, .force = source.table.find(kForce), .images = readImages(source)};
  const std::vector<double> x = source.table.require(kPositionX), y = source.table.require(kPositionY);
  for (std::size_t row = 0; row < x.size(); ++row) points.position.push_back({x[row], y[row]});
  return points;
}

// A footprint is an indenter or a mask. Without columns of the place, all of them are in the middle of the patch.
PointImages readFootprintImages(const Source& source) {
  PointImages points{.indenter = {}, .position = {}, .force = source.table.find(kForce), .images = readImages(source)};
  if (source.map.has("mask")) {
    source.map.rejectBoth("indenter", "mask");
    const std::filesystem::path file =
        source.tables / source.map.text("mask", "a picture of the footprint as numbers (CSV), rows of pixels along x");
    points.mask = readMask(file, positive(source.map, "pixel"));
  } else {
    if (const std::optional<YamlNode> pixel = source.map.find("pixel")) pixel->fail("needs a `mask`");
    points.indenter = readIndenter(source.map);
  }
  points.position_error = source.map.number("position_error", Allowed::atLeast(0, "m"), 0.0);
  points.yaw = source.table.find(kYaw);
  const std::vector<double> x = source.table.find(kPositionX), y = source.table.find(kPositionY);
  if (x.empty() != y.empty()) source.table.fail("x and y are given together or not at all");
  for (std::size_t row = 0; row < source.table.numRows(); ++row) {
    points.position.push_back(x.empty() ? std::array<double, 2>{0, 0} : std::array<double, 2>{x[row], y[row]});
  }
  return points;
}

UniformPress readUniformPress(const Source& source) {
  UniformPress uniform{.pressure = source.table.find(kPressure), .press = {}, .images = readImages(source)};
  const auto check = [&](const Quantity& quantity, const std::vector<double>& values, bool is_allowed(double), const char* allowed) {
    for (std::size_t row = 0; row < values.size(); ++row) {
      if (is_allowed(values[row])) continue;
      source.table.failAtValue(row, source.table.columnOf(quantity), numberText(values[row]) + " is not allowed: " + allowed);
    }
  };
  check(
      kPressure, uniform.pressure, [](double value) { return value > 0; }, "above 0 Pa");
  const std::vector<double> press = source.table.find(kPress);
  check(
      kPress, press, [](double value) { return value >= 0 && value <= 1e6 && value == std::floor(value); },
      "a whole number from 0 to 1000000");
  uniform.press.assign(press.begin(), press.end());
  return uniform;
}

StepResponse readStepResponse(const Source& source) {
  StepResponse step;
  step.load = source.map.number("load", Allowed::above(0, "N"));
  step.time = source.table.require(kRecordedTime);
  checkRising(source.table, step.time);
  step.counts = readCounts(source, source.full_scale * numTaxels(source.sensor));
  return step;
}

StampImages readStampImages(const Source& source) {
  StampImages stamp{
      .indenter = readIndenter(source.map), .load = source.map.number("load", Allowed::above(0, "N")), .images = readImages(source)};
  if (stamp.indenter.shape != Indenter::Shape::kStamp && stamp.indenter.shape != Indenter::Shape::kFlatPin) {
    source.map.require("indenter", "").fail("stamp_images need a flat indenter: stamp or flat_pin");
  }
  if (source.map.has("fixture")) stamp.fixture = source.map.text("fixture", "a name");
  if (source.map.has("position")) {
    double reach = 0;  // of the array, from the origin of S
    for (const Vector3& taxel : taxelPositions(source.sensor)) reach = std::max({reach, std::abs(taxel[0]), std::abs(taxel[1])});
    stamp.position = source.map.numbers<2>("position", Allowed::within(-reach, reach, "m"));
  }
  if (stamp.images.time.empty()) source.table.fail("missing column of the time: time_s, time_ms or t_s");
  return stamp;
}

// A kind of measurement: its keys and its reader.
struct Kind {
  std::string_view name;
  YamlMap::Keys keys;
  decltype(Measurement::data) (*read)(const Source&);
};

const std::vector<Kind>& kinds() {
  static const std::vector<Kind> all{
      {"force_curve",
       {"curve_degree", "divider", "curve_segments", "temperature_degC"},
       [](const Source& s) -> decltype(Measurement::data) { return readForceCurve(s); }},
      {"force_depth", {"indenter"}, [](const Source& s) -> decltype(Measurement::data) { return readForceDepth(s); }},
      {"point_images", {"indenter", "taxel_columns"}, [](const Source& s) -> decltype(Measurement::data) { return readPointImages(s); }},
      {"footprint_images",
       {"indenter", "taxel_columns", "mask", "pixel[_mm]", "position_error[_mm]"},
       [](const Source& s) -> decltype(Measurement::data) { return readFootprintImages(s); }},
      {"uniform_press", {"taxel_columns"}, [](const Source& s) -> decltype(Measurement::data) { return readUniformPress(s); }},
      {"step_response", {"load"}, [](const Source& s) -> decltype(Measurement::data) { return readStepResponse(s); }},
      {"stamp_images",
       {"indenter", "load", "taxel_columns", "fixture", "position[_mm]", "temperature_degC"},
       [](const Source& s) -> decltype(Measurement::data) { return readStampImages(s); }},
      {"images", {"taxel_columns"}, [](const Source& s) -> decltype(Measurement::data) { return ImageSequence{readImages(s)}; }},
  };
  return all;
}

}  // namespace

Measurement readMeasurement(const YamlNode& root, const MeasurementPlace& place) {
  YamlMap::Keys keys{"format_version", "measurement", "sensor", "table", "sha256"};
  for (const Kind& kind : kinds()) keys.insert(keys.end(), kind.keys.begin(), kind.keys.end());
  Canonical canonical;
  const YamlMap map(root, keys, canonical);
  if (place.is_file) map.integer("format_version", 1, kFormatVersion);
  const std::string name = map.choice("measurement", {"force_curve", "force_depth", "point_images", "footprint_images", "uniform_press",
                                                      "step_response", "stamp_images", "images"});
  const Kind& kind = *std::find_if(kinds().begin(), kinds().end(), [&](const Kind& candidate) { return candidate.name == name; });
  for (const Kind& other : kinds()) {
    for (const std::string_view key : other.keys) {
      const std::optional<YamlNode> given = map.find(key);
      if (given && std::find(kind.keys.begin(), kind.keys.end(), key) == kind.keys.end()) given->fail("not a key of " + name);
    }
  }
  Measurement measurement{.file = place.file, .name = place.name, .sensor = {}, .resolved_sensor = {}, .data = {}};
  Canonical sensor_text;
  measurement.sensor = readSensorBlock(map.require("sensor", kSensorBlock), place.sensors, sensor_text);
  measurement.resolved_sensor = sensor_text.text();
  const NumberTable table(readHashedFile(map, "table", place.tables, kMaxTableBytes, nullptr, "a table of numbers (CSV)"));
  const double full_scale = (1 << measurement.sensor.readout.adc_bits) - 1;
  measurement.data = kind.read({map, table, measurement.sensor, full_scale, place.tables});
  if (map.has("temperature_degC")) measurement.temperature = map.number("temperature_degC", kTemperature);
  return measurement;
}

double Indenter::sectionAt(double height) const {
  const double in_round = std::min(height, radius);
  const double half_width = std::sqrt(std::max(0.0, in_round * (2 * radius - in_round)));
  const double in_cone = height * std::tan(half_angle);
  switch (shape) {
    case Shape::kFlatPin:
      return std::numbers::pi * radius * radius;
    case Shape::kStamp:
      return size[0] * size[1];
    case Shape::kSphere:
      return std::numbers::pi * half_width * half_width;
    case Shape::kCylinder:
      return 2 * half_width * length;
    case Shape::kCone:
      return std::numbers::pi * in_cone * in_cone;
  }
  return 0;
}

Measurement loadMeasurement(const std::filesystem::path& file) {
  return readVersionedFile(file, [&](const YamlNode& root, const std::filesystem::path& directory) {
    return readMeasurement(root, {.file = file, .name = file.stem().string(), .sensors = directory, .tables = directory, .is_file = true});
  });
}

}  // namespace taxelsim
