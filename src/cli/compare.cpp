// `taxelsim compare`: compares simulated images with real ones.
#include "taxelsim/compare.h"

#include <spdlog/fmt/fmt.h>
#include <spdlog/spdlog.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <memory>
#include <nlohmann/json.hpp>
#include <numbers>
#include <optional>

#include "cli/commands.h"
#include "cli/image_source.h"
#include "cli/print.h"
#include "figures/comparison_figure.h"
#include "figures/text.h"
#include "taxelsim/error.h"

namespace taxelsim::cli {

using namespace figures;

namespace {

using Json = nlohmann::ordered_json;

constexpr std::size_t kMaxShownPairs = 6;
constexpr double kDegrees = 180 / std::numbers::pi;

struct CompareArguments {
  std::string real, simulated, picture, sensor;
  std::optional<double> seconds_after_touch;
  bool json = false;
};

// A metric of a pair of images.
struct Measure {
  const char* key;      // in JSON, in SI units or fractions
  const char* heading;  // in the table
  double per_si;        // heading's units per SI unit
  std::function<double(const ImageComparison&)> of;
};

const std::vector<Measure>& distances() {
  using C = ImageComparison;
  static const std::vector<Measure> all{
      {"M1_median_difference", "M1  median difference, % of full scale", 100, &C::median_difference},
      {"M2_mean_difference", "M2  mean difference, % of full scale", 100, &C::mean_difference},
      {"M3_rms_difference", "M3  rms difference over all taxels, % of the real peak", 100, &C::rms_difference},
      {"M4_relative_l1", "M4  sum of differences, % of the real sum", 100, &C::relative_l1},
      {"M5_cosine", "M5  cosine", 1, &C::cosine},
  };
  return all;
}

const std::vector<Measure>& contactDifferences() {
  static const std::vector<Measure> all{
      {"force_difference", "total force by the nominal curve, N", 1,
       [](const ImageComparison& c) { return c.simulated.total_force - c.real.total_force; }},
      {"center_distance", "centre of pressure (x, y), mm", 1e3, &ImageComparison::center_distance},
      {"angle_difference", "edge angle, deg", kDegrees, &ImageComparison::angle_difference},
  };
  return all;
}

// Rows of both sides that are compared.
struct Pair {
  std::size_t real_row, simulated_row;
  ImageComparison comparison;
};

std::size_t numRows(const ImageSource& source) {
  return source.images.counts.size() / source.images.num_taxels;
}

std::span<const float> imageAt(const ImageSource& source, std::size_t row) {
  return std::span(source.images.counts).subspan(row * source.images.num_taxels, source.images.num_taxels);
}

// Keeps only the row `seconds` after contact.
void keepAfterTouch(ImageSource& source, double seconds) {
  try {
    const std::size_t row = rowAfterTouch(source.images, seconds);
    const std::span<const float> image = imageAt(source, row);
    source.images.counts = {image.begin(), image.end()};
    source.images.time = {source.images.time[row]};
  } catch (const Error& error) {
    throw Error(error.kind(), source.file + ": " + error.what());
  }
}

std::string taxelsText(const ImageSource& source) {
  const bool one_grid = source.sensor && source.sensor->patches.size() == 1;
  if (!one_grid) return fmt::format("{} taxels", source.images.num_taxels);
  return fmt::format("{} x {} taxels", source.sensor->patches[0].num_rows, source.sensor->patches[0].num_cols);
}

// "1 image", "12 images".
std::string imagesText(std::size_t count) {
  return countText(count) + (count == 1 ? " image" : " images");
}

// Gives both sides a sensor and checks that both have the same array.
void matchSensors(ImageSource& real, ImageSource& simulated) {
  if (!real.sensor && !simulated.sensor) {
    throw Error(ErrorKind::kInput,
                fmt::format("{}, {}: neither names its sensor; one of the two must be a measurement or a data set with its sensor",
                            real.file, simulated.file));
  }
  if (real.images.num_taxels != simulated.images.num_taxels ||
      (real.sensor && simulated.sensor && !haveSameTaxels(*real.sensor, *simulated.sensor))) {
    throw Error(ErrorKind::kInput, fmt::format("{} has {}, {} has {}: only images of the same array can be compared", real.file,
                                               taxelsText(real), simulated.file, taxelsText(simulated)));
  }
  if (!real.sensor) real.sensor = simulated.sensor;
  if (!simulated.sensor) simulated.sensor = real.sensor;
}

std::vector<Pair> comparePairs(const ImageSource& real, const ImageSource& simulated) {
  const std::size_t num_real = numRows(real), num_simulated = numRows(simulated);
  if (num_real != num_simulated && num_real != 1 && num_simulated != 1) {
    throw Error(ErrorKind::kInput,
                fmt::format("{} has {}, {} has {}: give equal numbers, or one image on either side (--at selects one of a recording)",
                            real.file, imagesText(num_real), simulated.file, imagesText(num_simulated)));
  }
  std::vector<Pair> pairs;
  for (std::size_t row = 0; row < std::max(num_real, num_simulated); ++row) {
    const std::size_t real_row = num_real == 1 ? 0 : row, simulated_row = num_simulated == 1 ? 0 : row;
    pairs.push_back({real_row, simulated_row,
                     compareImages(*real.sensor, imageAt(real, real_row), *simulated.sensor, imageAt(simulated, simulated_row))});
  }
  return pairs;
}

ValueRange rangeOver(const std::vector<Pair>& pairs, const std::function<double(const ImageComparison&)>& of) {
  std::vector<double> values;
  values.reserve(pairs.size());
  for (const Pair& pair : pairs) values.push_back(of(pair.comparison));
  return rangeOf(values);
}

// Median, lowest, highest and number of pairs; for a single pair its value.
std::vector<std::string> rangeCells(const ValueRange& range, double per_si, std::size_t num_pairs) {
  const auto text = [&](double value) { return range.count > 0 ? roundedText(per_si * value) : "-"; };
  if (num_pairs == 1) return {text(range.median)};
  return {text(range.median), text(range.low), text(range.high), countText(range.count)};
}

std::string centerText(const ImageContact& contact) {
  if (!std::isfinite(contact.center_of_pressure[0])) return "-";
  return fmt::format("{:.3f}, {:.3f}", 1e3 * contact.center_of_pressure[0], 1e3 * contact.center_of_pressure[1]);
}

std::string angleText(const ImageContact& contact) {
  return std::isfinite(contact.edge_angle) ? fmt::format("{:.2f}", contact.edge_angle * kDegrees) : "-";
}

// A row: name of the metric, `others`, range.
void addRow(std::vector<std::vector<std::string>>& rows, const Measure& measure, const std::vector<Pair>& pairs,
            std::vector<std::string> others) {
  const std::vector<std::string> cells = rangeCells(rangeOver(pairs, measure.of), measure.per_si, pairs.size());
  others.insert(others.begin(), measure.heading);
  others.insert(others.end(), cells.begin(), cells.end());
  rows.push_back(std::move(others));
}

void printTable(const ImageSource& real, const ImageSource& simulated, const std::vector<Pair>& pairs) {
  const bool single = pairs.size() == 1;
  const auto heading = [&](std::vector<std::string> cells, const char* value) {
    cells.emplace_back(value);
    if (!single) cells.insert(cells.end(), {"lowest", "highest", "pairs"});
    return cells;
  };
  for (const auto& [side, source] : {std::pair("real     ", &real), std::pair("simulated", &simulated)}) {
    printOut("{}  {}: {} of {}\n", side, source->file, imagesText(numRows(*source)), taxelsText(*source));
  }
  printOut("full scale {} counts; M1 and M2 are over taxels with a reading above 0 in either image\n\n",
           (1 << real.sensor->readout.adc_bits) - 1);

  std::vector<std::vector<std::string>> rows{heading({""}, single ? "value" : "median")};
  for (const Measure& measure : distances()) addRow(rows, measure, pairs, {});
  printOut("{}\n", tableText(rows));

  const ValueRange real_force = rangeOver(pairs, [](const ImageComparison& c) { return c.real.total_force; });
  const ValueRange simulated_force = rangeOver(pairs, [](const ImageComparison& c) { return c.simulated.total_force; });
  const ImageComparison& first = pairs.front().comparison;
  rows = {heading({single ? "" : "medians", "real", "simulated"}, "difference")};
  addRow(rows, contactDifferences()[0], pairs, {roundedText(real_force.median), roundedText(simulated_force.median)});
  addRow(rows, contactDifferences()[1], pairs,
         single ? std::vector{centerText(first.real), centerText(first.simulated)} : std::vector<std::string>{"", ""});
  addRow(rows, contactDifferences()[2], pairs,
         single ? std::vector{angleText(first.real), angleText(first.simulated)} : std::vector<std::string>{"", ""});
  printOut("{}", tableText(rows));
}

Json asJson(const ImageSource& source) {
  return {{"file", source.file}, {"sensor", source.sensor->name}, {"images", numRows(source)}};
}

Json asJson(const ImageContact& contact) {
  Json json{{"total_force", contact.total_force}, {"center_of_pressure", nullptr}, {"edge_angle", numberOrNull(contact.edge_angle)}};
  if (std::isfinite(contact.center_of_pressure[0])) json["center_of_pressure"] = contact.center_of_pressure;
  return json;
}

void printJson(const ImageSource& real, const ImageSource& simulated, const std::vector<Pair>& pairs) {
  Json json{{"real", asJson(real)},
            {"simulated", asJson(simulated)},
            {"taxels", real.images.num_taxels},
            {"full_scale", (1 << real.sensor->readout.adc_bits) - 1}};
  for (const auto& measures : {distances(), contactDifferences()}) {
    for (const Measure& measure : measures) {
      const ValueRange range = rangeOver(pairs, measure.of);
      json["all"][measure.key] = {{"median", numberOrNull(range.median)},
                                  {"lowest", numberOrNull(range.low)},
                                  {"highest", numberOrNull(range.high)},
                                  {"pairs", range.count}};
    }
  }
  for (const Pair& pair : pairs) {
    Json entry{{"real_row", pair.real_row}, {"simulated_row", pair.simulated_row}};
    if (!real.images.time.empty()) entry["real_time"] = real.images.time[pair.real_row];
    if (!simulated.images.time.empty()) entry["simulated_time"] = simulated.images.time[pair.simulated_row];
    entry["active_taxels"] = pair.comparison.num_active;
    for (const auto& measures : {distances(), contactDifferences()}) {
      for (const Measure& measure : measures) entry[measure.key] = numberOrNull(measure.of(pair.comparison));
    }
    entry["real"] = asJson(pair.comparison.real);
    entry["simulated"] = asJson(pair.comparison.simulated);
    json["pairs"].push_back(std::move(entry));
  }
  printJsonText(json);
}

std::string titleOf(const char* side, const ImageSource& source, std::size_t row) {
  std::string title = fmt::format("{}: {}", side, source.name);
  if (numRows(source) > 1) title += fmt::format(", image {}", row);
  if (!source.images.time.empty()) title += fmt::format(", {:.4g} s", source.images.time[row]);
  return title;
}

void drawComparison(const std::string& file, const ImageSource& real, const ImageSource& simulated, const std::vector<Pair>& pairs) {
  std::vector<ShownPair> shown;
  const std::size_t count = std::min(pairs.size(), kMaxShownPairs);
  for (std::size_t k = 0; k < count; ++k) {
    // Evenly spaced, with the first and the last pair.
    const Pair& pair = pairs[count == 1 ? 0 : k * (pairs.size() - 1) / (count - 1)];
    shown.push_back({.real = {titleOf("real", real, pair.real_row), imageAt(real, pair.real_row)},
                     .simulated = {titleOf("simulated", simulated, pair.simulated_row), imageAt(simulated, pair.simulated_row)},
                     .comparison = pair.comparison});
  }
  std::string subtitle = pairs.size() == 1 ? "" : fmt::format("medians over {} pairs: ", countText(pairs.size()));
  for (const Measure& measure : distances()) {
    const std::string name(measure.key, 2);
    const double median = rangeOver(pairs, measure.of).median;
    if (name != "M1") subtitle += ", ";
    subtitle += measure.per_si == 1 ? fmt::format("{} {:.3f}", name, median) : fmt::format("{} {}", name, percentText(median));
  }
  writeComparisonFigure(file, *real.sensor, *simulated.sensor, shown,
                        {.title = fmt::format("{} against {}", simulated.name, real.name), .subtitle = subtitle});
}

int runCompare(const CompareArguments& arguments) {
  ImageSource real = loadImages(arguments.real, arguments.sensor), simulated = loadImages(arguments.simulated, arguments.sensor);
  matchSensors(real, simulated);
  if (arguments.seconds_after_touch) {
    if (real.images.time.empty() && simulated.images.time.empty()) {
      throw Error(ErrorKind::kInput, fmt::format("--at: neither {} nor {} has times", real.file, simulated.file));
    }
    for (ImageSource* source : {&real, &simulated}) {
      if (!source->images.time.empty()) keepAfterTouch(*source, *arguments.seconds_after_touch);
    }
  }
  const std::vector<Pair> pairs = comparePairs(real, simulated);
  if (arguments.json) {
    printJson(real, simulated, pairs);
  } else {
    printTable(real, simulated, pairs);
  }
  if (arguments.picture.empty()) return kExitOk;
  drawComparison(arguments.picture, real, simulated, pairs);
  spdlog::info("wrote {}", arguments.picture);
  return kExitOk;
}

}  // namespace

void addCompare(CLI::App& app, Action& action) {
  CLI::App* command = app.add_subcommand("compare", "Compare simulated images with real ones of the same array, by five metrics");
  command->footer(
      "Example:\n  taxelsim compare stamp.yaml out/ --at 5 -o stamp.png\n"
      "Each side is a measurement with images or the directory of a data set. Images are compared row by row; a single image is\n"
      "compared with all images of the other side.");
  const auto arguments = std::make_shared<CompareArguments>();
  command->add_option("real", arguments->real, "Measurement (YAML) or data set")->required()->type_name("REAL");
  command->add_option("simulated", arguments->simulated, "Measurement (YAML) or data set")->required()->type_name("SIM");
  command->add_option("--sensor", arguments->sensor, "Sensor of a data set whose columns are grouped by sensor; otherwise the first")
      ->type_name("NAME");
  command->add_option("--at", arguments->seconds_after_touch, "For recordings over time: use the image this long after contact")
      ->type_name("SECONDS");
  command->add_option("-o,--output", arguments->picture, "Figure to write (PNG): both images and their difference")
      ->check(requirePngName)
      ->type_name("FILE");
  command->add_flag("--json", arguments->json, "Print JSON");
  command->callback([=, &action] { action = [=] { return runCompare(*arguments); }; });
}

}  // namespace taxelsim::cli
