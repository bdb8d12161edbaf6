// `taxelsim calibrate-readings`: converts a recorded table of counts into newtons.
#include <spdlog/fmt/fmt.h>
#include <spdlog/fmt/ranges.h>
#include <spdlog/spdlog.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <filesystem>
#include <iterator>
#include <memory>
#include <span>

#include "base/files.h"
#include "cli/commands.h"
#include "cli/print.h"
#include "figures/text.h"
#include "scene/number_table.h"
#include "taxelsim/error.h"
#include "taxelsim/readings.h"

namespace taxelsim::cli {

using namespace figures;

namespace {

constexpr const char* kCreep = "creep";
constexpr const char* kPsf = "psf";

struct CalibrateReadingsArguments {
  std::string table, sensor, output;
  std::string taxel_columns;
  std::vector<std::string> remove;
};

void refuseToOverwrite(const CalibrateReadingsArguments& arguments) {
  for (const std::string& input : {arguments.table, arguments.sensor}) {
    std::error_code error;
    if (std::filesystem::equivalent(input, arguments.output, error)) {
      throw Error(ErrorKind::kInput, "-o " + arguments.output + ": not allowed, it would overwrite " + input);
    }
  }
}

Images imagesOf(const NumberTable& table, const Sensor& sensor, const std::vector<std::size_t>& columns) {
  Images images{.num_taxels = columns.size(), .time = table.find(kRecordedTime), .counts = {}};
  const int full_scale = (1 << sensor.readout.adc_bits) - 1;
  images.counts.reserve(table.numRows() * columns.size());
  for (std::size_t row = 0; row < table.numRows(); ++row) {
    for (const std::size_t column : columns) {
      const double counts = table.at(row, column);
      if (counts < 0 || counts > full_scale) {
        table.failAtValue(row, column, fmt::format("{} is not allowed: 0 to {} counts, by the sensor's adc_bits", counts, full_scale));
      }
      images.counts.push_back(static_cast<float>(counts));
    }
    if (row > 0 && !images.time.empty() && !(images.time[row] > images.time[row - 1])) {
      table.failAtValue(
          row, table.columnOf(kRecordedTime),
          fmt::format("{} s is not allowed: must be later than the previous row ({} s)", images.time[row], images.time[row - 1]));
    }
  }
  return images;
}

std::string forceTable(const NumberTable& table, const std::vector<std::size_t>& columns, const Images& images, const Readings& readings) {
  std::string text = images.time.empty() ? "" : "time_s,";
  const auto into = std::back_inserter(text);
  for (const std::size_t column : columns) fmt::format_to(into, "{}_N,", table.columns()[column]);
  text += "total_force_N\n";
  for (std::size_t row = 0; row < table.numRows(); ++row) {
    if (!images.time.empty()) fmt::format_to(into, "{},", images.time[row]);
    double total = 0;
    for (const double force : std::span(readings.force).subspan(row * columns.size(), columns.size())) {
      fmt::format_to(into, "{:.9g},", force);
      total += force;
    }
    fmt::format_to(into, "{:.9g}\n", total);
  }
  return text;
}

int runCalibrateReadings(const CalibrateReadingsArguments& arguments) {
  refuseToOverwrite(arguments);
  const auto removes = [&](const char* stage) {
    return std::find(arguments.remove.begin(), arguments.remove.end(), stage) != arguments.remove.end();
  };
  const Sensor sensor = loadSensor(arguments.sensor);
  const NumberTable table(arguments.table);
  if (arguments.taxel_columns.empty() && sensor.patches.size() != 1) {
    throw Error(ErrorKind::kInput, "missing --taxel-columns: " + arguments.sensor + " has more than one grid");
  }
  const std::vector<std::size_t> columns =
      table.taxelColumns(sensor, arguments.taxel_columns.empty() ? std::string(kGridColumns) : arguments.taxel_columns);
  if (removes(kCreep)) table.require(kRecordedTime);
  const Images images = imagesOf(table, sensor, columns);
  const Readings readings = readingsInNewtons(sensor, images, {.remove_creep = removes(kCreep), .remove_spread = removes(kPsf)});

  if (!readings.dead_taxels.empty()) {
    spdlog::warn("taxel_gain of taxels {} is 0: their force is set to 0 N", fmt::join(readings.dead_taxels, ", "));
  }
  if (readings.num_saturated > 0) {
    spdlog::warn("{} readings are saturated: their forces may be larger", countText(readings.num_saturated));
  }
  if (removes(kCreep) && sensor.readout.creep.empty()) spdlog::warn("{}: the sensor has no creep to remove", arguments.sensor);
  const std::string text = forceTable(table, columns, images, readings);
  writeFileAtomically(arguments.output, std::as_bytes(std::span(text)));
  printOut("{}: {} rows of {} taxels\n", arguments.output, countText(table.numRows()), columns.size());
  return kExitOk;
}

}  // namespace

void addCalibrateReadings(CLI::App& app, Action& action) {
  CLI::App* command = app.add_subcommand("calibrate-readings", "Convert recorded counts into newtons");
  command->footer(
      "Example:\n  taxelsim calibrate-readings raw.csv --sensor calibrated.yaml -o forces.csv --remove creep --remove psf\n"
      "The first line of the table must name its columns. In --taxel-columns, {row}, {col}, {patch} and {taxel} stand for the numbers\n"
      "or the patch of a taxel.");
  const auto arguments = std::make_shared<CalibrateReadingsArguments>();
  command->add_option("table", arguments->table, "Table of counts (CSV)")->required()->type_name("RAW");
  command->add_option("--sensor", arguments->sensor, "Sensor file with the calibrated readout")->required()->type_name("SENSOR");
  command->add_option("-o,--output", arguments->output, "Table of forces to write (CSV)")->required()->type_name("FILE");
  command
      ->add_option("--taxel-columns", arguments->taxel_columns,
                   fmt::format("Pattern of the names of taxel columns; default for one grid: {}", kGridColumns))
      ->type_name("PATTERN");
  command->add_option("--remove", arguments->remove, "Also invert the readout's creep or the point spread function; may be given twice")
      ->allow_extra_args(false)
      ->check(silent(CLI::IsMember({kCreep, kPsf})))
      ->type_name("creep|psf");
  command->callback([=, &action] { action = [=] { return runCalibrateReadings(*arguments); }; });
}

}  // namespace taxelsim::cli
