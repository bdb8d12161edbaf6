#include "figures/calibration_report.h"

#include <spdlog/fmt/fmt.h>

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>

#include "figures/line_chart.h"

namespace taxelsim::figures {
namespace {

constexpr double kMillimetre = 1e-3;

// Range, mean and middle of some of a sensor's values; NaN entries are skipped.
struct Summary {
  double middle = NAN, least = NAN, most = NAN, mean = NAN;
  std::size_t num_missing = 0;
};

Summary summaryOf(std::span<const double> values, std::size_t middle) {
  Summary summary{.middle = values[middle]};
  double sum = 0;
  for (const double value : values) {
    if (std::isnan(value)) {
      ++summary.num_missing;
      continue;
    }
    summary.least = std::fmin(summary.least, value);
    summary.most = std::fmax(summary.most, value);
    sum += value;
  }
  if (summary.num_missing < values.size()) summary.mean = sum / static_cast<double>(values.size() - summary.num_missing);
  return summary;
}

Summary forcesAt(const CalibrationExperiment& experiment, const CalibrationCurves& sensor, std::size_t depth) {
  const std::size_t count = experiment.numPlaces();
  return summaryOf(std::span(sensor.forces).subspan(depth * count, count), count / 2);
}

Summary atLoad(const CalibrationExperiment& experiment, const std::vector<double>& values, std::size_t load) {
  const std::size_t count = experiment.taxels.size();
  return summaryOf(std::span(values).subspan(load * count, count), 0);
}

std::size_t indexOf(const std::vector<double>& values, double value) {
  return static_cast<std::size_t>(std::find(values.begin(), values.end(), value) - values.begin());
}

std::string fixedText(double value, int digits) {
  return std::isnan(value) ? "-" : fmt::format("{:.{}f}", value, digits);
}

// Equal to `value` / `unit` but for rounding.
std::vector<double> scaledValues(const std::vector<double>& values, double unit) {
  std::vector<double> result;
  for (const double value : values) result.push_back(value / unit);
  return result;
}

// A sensor's curve with the range of its values.
LineSeries seriesOf(const std::string& name, const std::vector<double>& x, const std::vector<Summary>& at) {
  LineSeries series{.name = name, .x = x, .y = {}};
  for (const Summary& summary : at) {
    series.y.push_back(summary.middle);
    series.low.push_back(summary.least);
    series.high.push_back(summary.most);
  }
  return series;
}

}  // namespace

std::string calibrationTables(const CalibrationExperiment& experiment, std::span<const CalibrationCurves> sensors) {
  std::string text = fmt::format(
      "{}: a flat pin of {:g} mm diameter on {} places of taxel {} and in the middles of {} taxels\n\n"
      "force at a depth, N (paper, figure 6b)\n{:<32}{:>10}{:>10}{:>10}{:>10}{:>10}{:>10}\n",
      experiment.name, 2 * experiment.pin_radius / kMillimetre, experiment.numPlaces(), experiment.taxels.front(), experiment.taxels.size(),
      "sensor", "depth, mm", "measured", "middle", "mean", "least", "most");
  for (const CalibrationCurves& sensor : sensors) {
    for (const CalibrationExperiment::DepthForce& point : experiment.measured_forces) {
      const Summary force = forcesAt(experiment, sensor, indexOf(experiment.depths, point.depth));
      text += fmt::format("{:<32}{:>10g}{:>10.2f}{:>10}{:>10}{:>10}{:>10}\n", sensor.name, point.depth / kMillimetre, point.force,
                          fixedText(force.middle, 2), fixedText(force.mean, 2), fixedText(force.least, 2), fixedText(force.most, 2));
    }
  }
  text += fmt::format(
      "\ncounts at a force in the middle of a taxel (paper, figure 5b); share: of the force, on the pressed taxel\n"
      "{:<32}{:>10}{:>10}{:>10}{:>10}{:>10}{:>10}\n",
      "sensor", "force, N", "measured", "first", "least", "most", "share");
  for (const CalibrationCurves& sensor : sensors) {
    for (const CalibrationExperiment::ForceCounts& point : experiment.measured_counts) {
      const std::size_t load = indexOf(experiment.loads, point.force);
      const Summary counts = atLoad(experiment, sensor.counts, load), share = atLoad(experiment, sensor.shares, load);
      text += fmt::format("{:<32}{:>10g}{:>10.0f}{:>10}{:>10}{:>10}{:>10}\n", sensor.name, point.force, point.counts,
                          fixedText(counts.middle, 0), fixedText(counts.least, 0), fixedText(counts.most, 0), fixedText(share.middle, 3));
    }
  }
  for (const CalibrationCurves& sensor : sensors) {
    const auto missing = std::count_if(sensor.counts.begin(), sensor.counts.end(), [](double counts) { return std::isnan(counts); });
    if (missing > 0) {
      text += fmt::format(
          "\n{}: {} of {} presses on the middles of taxels do not reach their load: no sample lies under the pin, or the "
          "skin is too soft\n",
          sensor.name, missing, sensor.counts.size());
    }
  }
  return text;
}

nlohmann::ordered_json calibrationJson(const CalibrationExperiment& experiment, std::span<const CalibrationCurves> sensors) {
  nlohmann::ordered_json json{{"experiment", experiment.name},        {"pin_radius", experiment.pin_radius},
                              {"taxels", experiment.taxels},          {"places", experiment.places},
                              {"depths", experiment.depths},          {"loads", experiment.loads},
                              {"measured", nlohmann::ordered_json{}}, {"sensors", nlohmann::ordered_json::array()}};
  nlohmann::ordered_json& forces = json["measured"]["force_at_depth"] = nlohmann::ordered_json::array();
  for (const auto& [depth, force] : experiment.measured_forces) forces.push_back({{"depth", depth}, {"force", force}});
  nlohmann::ordered_json& counts = json["measured"]["counts_at_force"] = nlohmann::ordered_json::array();
  for (const auto& [force, count] : experiment.measured_counts) counts.push_back({{"force", force}, {"counts", count}});
  for (const CalibrationCurves& sensor : sensors) {
    // nlohmann writes NaN as null.
    json["sensors"].push_back({{"sensor", sensor.name}, {"forces", sensor.forces}, {"counts", sensor.counts}, {"shares", sensor.shares}});
  }
  return json;
}

void drawCalibration(const std::filesystem::path& directory, const CalibrationExperiment& experiment,
                     std::span<const CalibrationCurves> sensors) {
  std::error_code error;
  std::filesystem::create_directories(directory, error);
  LinePanel depth{
      .title = fmt::format("force against depth, taxel {}", experiment.taxels.front()), .x_label = "depth, mm", .y_label = "force, N"};
  LinePanel force{
      .title = fmt::format("counts against force, {} taxels", experiment.taxels.size()), .x_label = "force, N", .y_label = "counts"};
  for (const CalibrationCurves& sensor : sensors) {
    std::vector<Summary> forces, counts;
    for (std::size_t d = 0; d < experiment.depths.size(); ++d) forces.push_back(forcesAt(experiment, sensor, d));
    for (std::size_t l = 0; l < experiment.loads.size(); ++l) counts.push_back(atLoad(experiment, sensor.counts, l));
    depth.series.push_back(seriesOf(sensor.name, scaledValues(experiment.depths, kMillimetre), forces));
    force.series.push_back(seriesOf(sensor.name, experiment.loads, counts));
  }
  LineSeries measured{.name = "measured", .x = {}, .y = {}, .style = LineStyle::kPoints, .colour = kInk};
  LineSeries read = measured;
  for (const auto& point : experiment.measured_forces) measured.x.push_back(point.depth / kMillimetre), measured.y.push_back(point.force);
  for (const auto& point : experiment.measured_counts) read.x.push_back(point.force), read.y.push_back(point.counts);
  if (!measured.x.empty()) depth.series.push_back(std::move(measured));
  if (!read.x.empty()) force.series.push_back(std::move(read));
  writeLineChart(directory / "calibration.png", {std::move(depth), std::move(force)},
                 {.title = experiment.name,
                  .subtitle = fmt::format("a flat pin of {:g} mm diameter; lines: in the middle of a taxel; shaded: all places, all taxels",
                                          2 * experiment.pin_radius / kMillimetre)});
}

}  // namespace taxelsim::figures
