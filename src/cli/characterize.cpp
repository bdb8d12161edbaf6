// `taxelsim characterize`: fits a sensor file to measurements of a real sensor.
#include "taxelsim/characterize.h"

#include <spdlog/spdlog.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <cmath>
#include <map>
#include <memory>
#include <nlohmann/json.hpp>
#include <optional>

#include "base/files.h"
#include "cli/activity.h"
#include "cli/commands.h"
#include "cli/print.h"
#include "figures/characterize_report.h"
#include "figures/cross_validation_text.h"
#include "figures/text.h"
#include "taxelsim/error.h"
#include "taxelsim/version.h"

namespace taxelsim::cli {

using namespace figures;

namespace {

struct CharacterizeArguments {
  std::vector<std::string> measurements;
  std::string sensor;
  std::string name;
  std::string report;
  double light_below = 0;               // N
  std::optional<double> temperature{};  // degrees Celsius
  bool cross_validate = false;
  bool random_gains = false;
  bool json = false;
};

// Key of the sensor file that an estimate belongs to.
std::string keyOf(const std::string& parameter) {
  if (parameter.starts_with("psf.")) return "psf.kernel";
  return parameter.starts_with("readout.curve.") ? parameter.substr(0, parameter.find('[')) : parameter;
}

// Comments of the sensor file: the origin of each number.
std::map<std::string, std::string> notesOf(const Characterization& result, const std::vector<Measurement>& measurements) {
  std::map<std::string, std::string> notes;
  std::string files;
  for (const Measurement& measurement : measurements) files += (files.empty() ? "" : ", ") + measurement.file.filename().string();
  notes[""] = fmt::format(
      "Fitted by taxelsim {} to {}. Numbers with an interval are fitted; all others are those of the sensor file that the "
      "measurements name.",
      kVersion, files);
  for (const Estimate& estimate : result.estimates) {
    std::string text = estimate.determined && estimate.parameter.starts_with("psf.") ? estimate.parameter.substr(4) + " " : "";
    text += estimateText(estimate);
    if (estimate.determined && !estimate.remark.empty()) text += ", " + estimate.remark;
    std::string& note = notes[keyOf(estimate.parameter)];
    if (note.empty() || estimate.parameter.starts_with("readout.curve.")) note += (note.empty() ? "" : "; ") + text;
  }
  return notes;
}

void printTable(const Characterization& result) {
  std::vector<std::vector<std::string>> rows{{"parameter", "value", "from", "to", "unit", ""}};
  std::size_t num_gains = 0;
  for (const Estimate& estimate : result.estimates) {
    if (estimate.parameter.starts_with("readout.taxel_gain[")) {
      ++num_gains;
    } else if (estimate.determined) {
      rows.push_back({estimate.parameter, roundedText(estimate.value), roundedText(estimate.low), roundedText(estimate.high), estimate.unit,
                      estimate.remark});
    } else {
      rows.push_back({estimate.parameter, "", "", "", estimate.unit, "not determined: " + estimate.remark});
    }
  }
  printOut("95 % intervals\n\n{}\n", tableText(rows));
  std::vector<std::vector<std::string>> fits{{"measurement", "rms", "rows", "outliers"}};
  for (const FitQuality& fit : result.fits) {
    fits.push_back({fit.measurement, roundedText(fit.rms) + " " + fit.unit, countText(fit.num_rows), countText(fit.num_outliers)});
  }
  printOut("{}\n", tableText(fits));
  if (const std::optional<double> spread = gainSpreadOf(result))
    printOut("gains of {} taxels; standard deviation of their logarithm: {}\n", num_gains, roundedText(*spread));
  if (!result.dead_taxels.empty()) printOut("taxels without a response: {}\n", fmt::join(result.dead_taxels, ", "));
  for (const std::string& remark : result.remarks) printOut("{}\n", remark);
}

nlohmann::ordered_json asJson(const Characterization& result) {
  nlohmann::ordered_json json{{"sensor", result.sensor.name}, {"estimates", nlohmann::ordered_json::array()}};
  for (const Estimate& estimate : result.estimates) {
    nlohmann::ordered_json entry{{"parameter", estimate.parameter}, {"unit", estimate.unit}, {"determined", estimate.determined}};
    if (estimate.determined) {
      entry["value"] = estimate.value;
      entry["low"] = estimate.low;
      entry["high"] = estimate.high;
    }
    entry["remark"] = estimate.remark;
    json["estimates"].push_back(std::move(entry));
  }
  json["fits"] = nlohmann::ordered_json::array();
  for (const FitQuality& fit : result.fits) {
    json["fits"].push_back({{"measurement", fit.measurement},
                            {"unit", fit.unit},
                            {"rms", fit.rms},
                            {"num_rows", fit.num_rows},
                            {"num_outliers", fit.num_outliers}});
  }
  json["dead_taxels"] = result.dead_taxels;
  json["remarks"] = result.remarks;
  return json;
}

int runCharacterize(const CharacterizeArguments& arguments) {
  std::vector<Measurement> measurements;
  for (const std::string& file : arguments.measurements) {
    measurements.push_back(loadMeasurement(file));
    spdlog::debug("read {}", file);
  }
  Activity activity("fitting");
  Characterization result = characterize(measurements);
  activity.end();
  if (arguments.temperature) {
    if (!result.temperature) {
      throw Error(ErrorKind::kInput,
                  "--temperature: the measurements have no temperature_degC, or all the same: the sensor cannot depend on it");
    }
    result.sensor = sensorAt(result, *arguments.temperature);
  }
  std::vector<CrossValidation> validation;
  if (arguments.cross_validate) {
    Activity fits("fitting without each load in turn");
    validation = crossValidate(measurements);
    fits.end();
  }
  const std::string scores = crossValidationText(validation, arguments.light_below);
  if (!arguments.name.empty()) result.sensor.name = arguments.name;
  std::map<std::string, std::string> notes = notesOf(result, measurements);
  if (arguments.random_gains) {
    if (!gainSpreadOf(result))
      throw Error(ErrorKind::kInput,
                  "--random-gains: the measurements determine the gains of fewer than two taxels, which have no scatter");
    result.sensor = withRandomGains(result);
    notes["readout.gain_spread"] = "standard deviation of the logarithm of the fitted gains";
  }
  const std::string text = sensorText(result.sensor, notes);
  writeFileAtomically(arguments.sensor, std::as_bytes(std::span(text)));
  spdlog::info("wrote {}", arguments.sensor);
  if (!arguments.report.empty()) {
    const std::vector<std::filesystem::path> figures = drawCharacterization(arguments.report, result);
    writeReport(arguments.report, measurements, result, scores, figures);
    spdlog::info("wrote {} and {} figures in its folder", arguments.report, figures.size());
  }
  if (arguments.json) {
    nlohmann::ordered_json json = asJson(result);
    if (arguments.cross_validate) json["cross_validation"] = crossValidationJson(validation, arguments.light_below);
    printJsonText(json);
  } else {
    printOut("{}{}", scores, scores.empty() ? "" : "\n");
    printTable(result);
  }
  return kExitOk;
}

}  // namespace

void addCharacterize(CLI::App& app, Action& action) {
  CLI::App* command = app.add_subcommand("characterize", "Fit a sensor file to measurements of a real sensor, with confidence intervals");
  command->footer(
      "Example:\n  taxelsim characterize scenes/measurements/*.yaml -o my_sensor.yaml --report my_sensor.html\n"
      "A measurement is a CSV table and a small YAML file that describes it: see docs/reference/measurements.md.");
  const auto arguments = std::make_shared<CharacterizeArguments>();
  command->add_option("measurements", arguments->measurements, "Measurement files (YAML), all of one sensor")
      ->required()
      ->type_name("MEASUREMENT");
  command->add_option("-o,--output", arguments->sensor, "Sensor file to write")->required()->type_name("SENSOR");
  command->add_option("--name", arguments->name, "Name of the sensor; default: that of the sensor file which the measurements name")
      ->type_name("NAME");
  command
      ->add_option("--report", arguments->report, "Write an HTML report with all figures, and the figures as PNG files in the same folder")
      ->type_name("HTML");
  CLI::Option* const validate = command->add_flag(
      "--cross-validate", arguments->cross_validate,
      "Predict each load, or half of each force curve, by a fit that has not seen it, and compare with model-free baselines");
  command->add_option("--light-below", arguments->light_below, "Score stamps below this load (N) apart; default: all together")
      ->needs(validate)
      ->check(CLI::PositiveNumber)
      ->type_name("N");
  command
      ->add_option("--temperature", arguments->temperature,
                   "Write the sensor at this temperature (degrees Celsius); default: at the mean of the measurements")
      ->check(silent(CLI::Range(-100.0, 300.0)))
      ->type_name("DEGC");
  command->add_flag("--random-gains", arguments->random_gains,
                    "Write the scatter of the fitted gains (gain_spread), so that every episode has a new array of this kind, instead of "
                    "the gains and triggers of the taxels of this one");
  command->add_flag("--json", arguments->json, "Print JSON instead of tables");
  command->callback([=, &action] { action = [=] { return runCharacterize(*arguments); }; });
}

}  // namespace taxelsim::cli
