// `taxelsim inspect`: prints the contents of a data set and verifies its checksums.
#include <spdlog/fmt/fmt.h>
#include <spdlog/fmt/ranges.h>
#include <yaml-cpp/yaml.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <cmath>
#include <limits>
#include <memory>
#include <nlohmann/json.hpp>

#include "cli/commands.h"
#include "cli/scene_name.h"
#include "figures/text.h"
#include "taxelsim/dataset.h"
#include "taxelsim/error.h"

namespace taxelsim::cli {

using namespace figures;

namespace {

constexpr std::size_t kValuesAtOnce = std::size_t{1} << 20;

struct Arguments {
  std::string directory;
  bool json = false;
  bool quick = false;
};

struct Statistics {
  double min = std::numeric_limits<double>::infinity();
  double max = -std::numeric_limits<double>::infinity();
  double sum = 0;
  std::uint64_t num_finite = 0, num_non_finite = 0;

  double mean() const { return sum / static_cast<double>(num_finite); }
};

Statistics statisticsOf(const DatasetReader& reader, const Column& column) {
  std::size_t per_row = 1;
  for (const std::size_t length : column.shape) per_row *= length;
  const std::uint64_t num_rows = column.per_episode ? reader.numEpisodes() : reader.numFrames();
  const std::uint64_t step = std::max<std::uint64_t>(1, kValuesAtOnce / per_row);
  Statistics statistics;
  for (std::uint64_t first = 0; first < num_rows; first += step) {
    for (const double value : reader.readAsDouble(column.name, first, std::min(step, num_rows - first))) {
      if (!std::isfinite(value)) {
        ++statistics.num_non_finite;
        continue;
      }
      statistics.min = std::min(statistics.min, value);
      statistics.max = std::max(statistics.max, value);
      statistics.sum += value;
      ++statistics.num_finite;
    }
  }
  return statistics;
}

// "6 x 14", or "-" for scalars.
std::string shapeText(const Column& column) {
  return column.shape.empty() ? "-" : fmt::format("{}", fmt::join(column.shape, " x "));
}

// " (1, 2, 5)", the first few; empty for none.
std::string listText(std::vector<std::uint64_t> shards) {
  static constexpr std::size_t kMost = 8;
  if (shards.empty()) return "";
  const bool more = shards.size() > kMost;
  shards.resize(std::min(shards.size(), kMost));
  return fmt::format(" ({}{})", fmt::join(shards, ", "), more ? ", ..." : "");
}

// "shard 5" or "shards 1, 2, 5".
std::string shardsText(const std::vector<std::uint64_t>& shards) {
  static constexpr std::size_t kMost = 8;
  const auto end = shards.begin() + static_cast<std::ptrdiff_t>(std::min(shards.size(), kMost));
  return fmt::format("{} {}{}", shards.size() == 1 ? "shard" : "shards", fmt::join(shards.begin(), end, ", "),
                     shards.size() > kMost ? ", ..." : "");
}

struct Shards {
  std::vector<std::uint64_t> missing, broken;
  std::string problem;  // of the first broken one
  std::uint64_t whole = 0;
};

Shards sorted(const std::vector<ShardStatus>& statuses) {
  Shards shards;
  for (const ShardStatus& status : statuses) {
    if (status.state == ShardStatus::State::kMissing) shards.missing.push_back(status.shard);
    if (status.state == ShardStatus::State::kWhole) ++shards.whole;
    if (status.state != ShardStatus::State::kBroken) continue;
    if (shards.broken.empty()) shards.problem = status.problem;
    shards.broken.push_back(status.shard);
  }
  return shards;
}

int runInspect(const Arguments& arguments) {
  const Manifest manifest = readManifest(arguments.directory);
  const Shards shards = sorted(checkShards(arguments.directory, /*contents=*/!arguments.quick));
  const std::string name = sceneName(manifest);
  const std::string checked = arguments.quick ? "headers" : "all values";

  nlohmann::ordered_json json{
      {"scene", name},
      {"sensor", manifest.sensor_name},
      {"num_rows", manifest.num_rows},
      {"num_cols", manifest.num_cols},
      {"seed", manifest.seed},
      {"device", manifest.device},
      {"program_version", manifest.program_version},
      {"num_episodes", manifest.num_episodes},
      {"shards", {{"expected", manifest.numShards()}, {"whole", shards.whole}, {"missing", shards.missing}, {"broken", shards.broken}}},
      {"checked", checked}};
  std::vector<std::vector<std::string>> heading{
      {"scene", name},
      {"sensor", manifest.sensor_name},
      {"seed", std::to_string(manifest.seed)},
      {"device", manifest.device},
      {"program", "taxelsim " + manifest.program_version},
      {"shards", fmt::format("{} of {} complete, {} missing{}, {} broken{}", shards.whole, manifest.numShards(), shards.missing.size(),
                             listText(shards.missing), shards.broken.size(), listText(shards.broken))},
      {"SHA-256", shards.broken.empty() ? fmt::format("scene and {} of all shards on disk verified", checked)
                                        : fmt::format("checksum mismatch in {}", shardsText(shards.broken))}};
  const auto printHeading = [&] {
    for (const auto& row : heading) fmt::print("{:<9} {}\n", row[0], row[1]);
  };
  if (!shards.broken.empty()) {
    if (arguments.json)
      fmt::print("{}\n", json.dump(2));
    else
      printHeading();
    throw Error(ErrorKind::kInput, shards.problem);
  }

  const DatasetReader reader(arguments.directory, /*allow_incomplete=*/true);
  json["episodes_on_disk"] = reader.numEpisodes();
  json["frames_on_disk"] = reader.numFrames();
  json["columns"] = nlohmann::ordered_json::array();
  heading.push_back({"episodes", fmt::format("{} of {}", countText(reader.numEpisodes()), countText(manifest.num_episodes))});
  heading.push_back({"frames", countText(reader.numFrames())});
  std::vector<std::vector<std::string>> table{{"column", "type", "shape", "unit", "min", "mean", "max", "not finite"}};
  for (const Column& column : manifest.columns) {
    const Statistics statistics = statisticsOf(reader, column);
    nlohmann::ordered_json entry{{"name", column.name}, {"type", nameOf(column.type)},       {"shape", column.shape},
                                 {"unit", column.unit}, {"description", column.description}, {"per_episode", column.per_episode}};
    const bool some = statistics.num_finite > 0;
    entry["min"] = some ? nlohmann::ordered_json(statistics.min) : nullptr;
    entry["mean"] = some ? nlohmann::ordered_json(statistics.mean()) : nullptr;
    entry["max"] = some ? nlohmann::ordered_json(statistics.max) : nullptr;
    entry["non_finite"] = statistics.num_non_finite;
    json["columns"].push_back(entry);
    table.push_back({column.name, nameOf(column.type), shapeText(column), column.unit, some ? roundedText(statistics.min) : "-",
                     some ? roundedText(statistics.mean()) : "-", some ? roundedText(statistics.max) : "-",
                     countText(statistics.num_non_finite)});
  }
  if (arguments.json) {
    fmt::print("{}\n", json.dump(2));
    return kExitOk;
  }
  printHeading();
  fmt::print("\n{}", tableText(table));
  return kExitOk;
}

}  // namespace

std::string sceneName(const Manifest& manifest) {
  try {
    const YAML::Node name = YAML::Load(manifest.scene)["name"];
    if (name && name.IsScalar()) return name.as<std::string>();
  } catch (const YAML::Exception&) {
    return "-";  // the checksum was right; only the name is unknown
  }
  return "-";
}

void addInspect(CLI::App& app, Action& action) {
  CLI::App* command = app.add_subcommand("inspect", "Print the contents of a data set and verify its checksums");
  command->footer(
      "Example:\n  taxelsim inspect out/\n"
      "Reads every value and verifies its SHA-256. Exit status 2 if a shard is broken; lists missing shards.");
  const auto arguments = std::make_shared<Arguments>();
  command->add_option("directory", arguments->directory, "Directory of the data set")->required()->type_name("DIR");
  command->add_flag("--json", arguments->json, "Print JSON");
  command->add_flag("--quick", arguments->quick, "Verify the headers of shards only, not their values");
  command->callback([arguments, &action] { action = [arguments] { return runInspect(*arguments); }; });
}

}  // namespace taxelsim::cli
