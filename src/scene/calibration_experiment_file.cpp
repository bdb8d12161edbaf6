#include <algorithm>

#include "base/text.h"
#include "scene/experiment_reader.h"
#include "scene/sensor_file.h"
#include "sensor/skin.h"

namespace taxelsim {
namespace {

constexpr int kMaxPlaces = 31;
constexpr std::size_t kMaxSensors = 20;
const std::string kSensors = "a list of 1 to " + std::to_string(kMaxSensors) + " sensors";

Sensor readSensor(const YamlNode& item, const std::filesystem::path& directory, Canonical& canonical) {
  Sensor sensor = readSensorBlock(item, directory, canonical);
  if (sensor.patches.size() != 1 || !isLevel(sensor)) item.fail(sensor.name + " is not allowed: only sensors with one level grid");
  if (std::holds_alternative<Proximity>(sensor.skin.law)) item.fail(sensor.name + " is not allowed: the law proximity has no force");
  return sensor;
}

std::vector<int> readTaxels(const YamlMap& map, const std::vector<Sensor>& sensors) {
  int least = numTaxels(sensors.front());
  for (const Sensor& sensor : sensors) least = std::min(least, numTaxels(sensor));
  std::vector<int> taxels;
  for (const double taxel : readList(map, "taxels", Allowed::within(0, least - 1, ""))) {
    if (taxel != static_cast<int>(taxel)) {
      map.require("taxels", "").fail(numberText(taxel) + " is not allowed: a whole number from 0 to " + std::to_string(least - 1));
    }
    taxels.push_back(static_cast<int>(taxel));
  }
  return taxels;
}

std::vector<double> readAscending(const YamlMap& map, std::string_view key, const char* unit) {
  std::vector<double> values = readList(map, key, Allowed::above(0, unit));
  if (!std::is_sorted(values.begin(), values.end(), std::less_equal<>())) map.require(key, "").fail("the values do not ascend");
  return values;
}

// Points of the list `key`: the first value of each is one of `values`, the list `list` in `unit`.
template <typename Point>
std::vector<Point> readPoints(const YamlMap& measured, std::string_view key, const YamlMap::Keys& keys, const std::vector<double>& values,
                              const char* list, const char* unit, Point (*read)(const YamlMap&)) {
  std::vector<Point> points;
  const std::optional<YamlNode> node = measured.find(key);
  if (!node) return points;
  measured.canonical().open(key);
  for (const YamlNode& item : node->items("a list of points")) {
    const Point point = read(YamlMap::item(item, keys, measured.canonical()));
    const auto& [value, other] = point;
    if (std::find(values.begin(), values.end(), value) == values.end())
      item.fail(numberText(value) + " " + unit + " is not one of `" + list + "`");
    points.push_back(point);
  }
  measured.canonical().close();
  return points;
}

}  // namespace

CalibrationExperiment readCalibrationExperiment(const YamlNode& root, const std::filesystem::path& directory) {
  Canonical canonical;
  const YamlMap map(
      root, {"format_version", "name", "experiment", "sensors", "pin_radius[_mm]", "taxels", "places", "depths[_mm]", "loads", "measured"},
      canonical);
  CalibrationExperiment experiment;
  map.integer("format_version", 1, kFormatVersion);
  experiment.name = map.text("name", "a name");
  map.choice("experiment", {"calibration"});
  const YamlNode sensors = map.require("sensors", kSensors);
  const std::vector<YamlNode> items = sensors.items(kSensors);
  if (items.empty() || items.size() > kMaxSensors) sensors.refuse(kSensors);
  for (const YamlNode& item : items) experiment.sensors.push_back(readSensor(item, directory, canonical));
  experiment.pin_radius = map.number("pin_radius", Allowed::above(0, "m"));
  experiment.taxels = readTaxels(map, experiment.sensors);
  experiment.places = static_cast<int>(map.integer("places", 1, kMaxPlaces, experiment.places));
  if (experiment.places % 2 == 0) map.require("places", "").fail(std::to_string(experiment.places) + " is not allowed: an odd number");
  experiment.depths = readAscending(map, "depths", "m");
  for (const Sensor& sensor : experiment.sensors) {
    if (experiment.depths.back() > sensor.skin.thickness) {
      map.require("depths", "")
          .fail(numberText(experiment.depths.back()) + " m is deeper than the skin of " + sensor.name + ", " +
                numberText(sensor.skin.thickness) + " m");
    }
  }
  experiment.loads = readAscending(map, "loads", "N");
  const YamlMap measured(map, "measured", {"force_at_depth", "counts_at_force"});
  experiment.measured_forces = readPoints<CalibrationExperiment::DepthForce>(
      measured, "force_at_depth", {"depth[_mm]", "force"}, experiment.depths, "depths", "m",
      [](const YamlMap& point) -> CalibrationExperiment::DepthForce {
        return {point.number("depth", Allowed::above(0, "m")), point.number("force", Allowed::above(0, "N"))};
      });
  experiment.measured_counts = readPoints<CalibrationExperiment::ForceCounts>(
      measured, "counts_at_force", {"force", "counts"}, experiment.loads, "loads", "N",
      [](const YamlMap& point) -> CalibrationExperiment::ForceCounts {
        return {point.number("force", Allowed::above(0, "N")), point.number("counts", Allowed::atLeast(0, ""))};
      });
  return experiment;
}

CalibrationExperiment loadCalibrationExperiment(const std::filesystem::path& file) {
  return readVersionedFile(file, readCalibrationExperiment);
}

}  // namespace taxelsim
