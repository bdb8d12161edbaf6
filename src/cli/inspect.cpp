// `taxelsim inspect`: prints the contents of a data set and verifies its checksums.
#include <spdlog/fmt/fmt.h>
#include <spdlog/fmt/ranges.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <memory>
#include <nlohmann/json.hpp>

#include "base/text.h"
#include "cli/commands.h"
#include "cli/print.h"
#include "cli/shard_sample.h"
#include "figures/frame_figures.h"
#include "figures/text.h"
#include "taxelsim/dataset.h"
#include "taxelsim/error.h"

namespace taxelsim::cli {

using namespace figures;

namespace {

constexpr std::size_t kValuesAtOnce = std::size_t{1} << 20;

struct InspectArguments {
  std::string directory, sensor;
  bool json = false;
  bool quick = false;
  bool verify = false;
};

struct Statistics {
  double min = std::numeric_limits<double>::infinity();
  double max = -std::numeric_limits<double>::infinity();
  double sum = 0;
  std::uint64_t num_finite = 0, num_non_finite = 0;
  // How often each name occurs, in the order of the names: texts, or named values or bits.
  std::vector<std::pair<std::string, std::uint64_t>> counts;

  double mean() const { return sum / static_cast<double>(num_finite); }
};

void addNumbers(const Column& column, const std::vector<double>& values, Statistics& statistics) {
  const bool has_bits = !column.bit_names.empty();
  for (const double value : values) {
    if (!std::isfinite(value)) {
      ++statistics.num_non_finite;
      continue;
    }
    statistics.min = std::min(statistics.min, value);
    statistics.max = std::max(statistics.max, value);
    statistics.sum += value;
    ++statistics.num_finite;
    if (statistics.counts.empty()) continue;
    const auto number = static_cast<std::uint64_t>(value);
    for (std::size_t k = 0; k < statistics.counts.size(); ++k) statistics.counts[k].second += has_bits ? number >> k & 1 : number == k;
  }
}

Statistics statisticsOf(const DatasetReader& reader, const Column& column, const ShardSample& sample) {
  std::size_t per_row = 1;
  for (const std::size_t length : column.shape) per_row *= length;
  const std::uint64_t step = std::max<std::uint64_t>(1, kValuesAtOnce / per_row);
  Statistics statistics;
  std::map<std::string, std::uint64_t> texts;
  for (const auto* names : {&column.value_names, &column.bit_names})
    for (const std::string& name : *names) statistics.counts.emplace_back(name, 0);
  for (const RowRange& rows : column.per_episode ? sample.episodes : sample.frames) {
    const std::uint64_t end = rows.first + rows.count;
    for (std::uint64_t first = rows.first; first < end; first += step) {
      const std::uint64_t count = std::min(step, end - first);
      if (column.type == ScalarType::kText)
        for (std::string& text : reader.readAsText(column.name, first, count)) ++texts[std::move(text)];
      else
        addNumbers(column, reader.readAsDouble(column.name, first, count), statistics);
    }
  }
  statistics.counts.insert(statistics.counts.end(), texts.begin(), texts.end());
  return statistics;
}

// "point 3, edge 12": the names that occur, at most a few.
std::string countsText(const Statistics& statistics) {
  static constexpr std::size_t kMost = 12;
  std::vector<std::string> parts;
  for (const auto& [name, count] : statistics.counts)
    if (count > 0) parts.push_back(fmt::format("{} {}", oneLine(name), countText(count)));
  const bool more = parts.size() > kMost;
  parts.resize(std::min(parts.size(), kMost));
  if (parts.empty()) return "none";
  return fmt::format("{}{}", fmt::join(parts, ", "), more ? ", ..." : "");
}

// "uint16", or "text[12]".
std::string typeText(const Column& column) {
  return column.type == ScalarType::kText ? fmt::format("text[{}]", column.text_length) : nameOf(column.type);
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
  std::uint64_t vouched_for = 0;  // of the whole ones; they were not read
};

Shards sorted(const std::vector<ShardStatus>& statuses) {
  Shards shards;
  for (const ShardStatus& status : statuses) {
    if (status.state == ShardStatus::State::kMissing) shards.missing.push_back(status.shard);
    if (status.state == ShardStatus::State::kWhole) ++shards.whole;
    if (status.is_vouched_for) ++shards.vouched_for;
    if (status.state != ShardStatus::State::kBroken) continue;
    if (shards.broken.empty()) shards.problem = status.problem;
    shards.broken.push_back(status.shard);
  }
  return shards;
}

const char* nameOf(ViewStatus::State state) {
  switch (state) {
    case ViewStatus::State::kWhole:
      return "whole";
    case ViewStatus::State::kMissing:
      return "missing";
    case ViewStatus::State::kBroken:
      return "broken";
    case ViewStatus::State::kUnverified:
      break;
  }
  return "unverified";
}

std::string viewText(const Shards& shards, const Manifest& manifest, ViewStatus::State state) {
  switch (state) {
    case ViewStatus::State::kWhole:
      return "dataset.h5 verified";
    case ViewStatus::State::kMissing:
      return shards.whole < manifest.numShards() ? "dataset.h5 is written after the last shard"
                                                 : "dataset.h5 is missing; `taxelsim generate` with the same scene writes it";
    case ViewStatus::State::kBroken:
      return "dataset.h5 is broken; `taxelsim generate` with the same scene writes it again";
    case ViewStatus::State::kUnverified:
      break;
  }
  return "dataset.h5 has no checksum in format 1";
}

// What was verified of the shards.
std::string checkedText(const Manifest& manifest, const Shards& shards, bool quick) {
  if (manifest.format_version > 1) return shards.vouched_for == 0 ? "all bytes" : "sizes and times";
  return quick ? "headers" : "all values";
}

std::string hashText(const Shards& shards, const std::string& checked) {
  if (!shards.broken.empty()) return fmt::format("checksum mismatch in {}", shardsText(shards.broken));
  if (shards.vouched_for == 0) return fmt::format("scene and {} of all shards on disk verified", checked);
  const std::uint64_t num_read = shards.whole - shards.vouched_for;
  return fmt::format("scene verified; {} of {} shards unchanged since they were verified (sizes and times){}; --verify reads all bytes",
                     countText(shards.vouched_for), countText(shards.whole),
                     num_read > 0 ? fmt::format(", all bytes of {} verified now", countText(num_read)) : "");
}

using Rows = std::vector<std::vector<std::string>>;

// Length of the longest first cell.
std::size_t widthOf(const Rows& rows) {
  std::size_t width = 0;
  for (const auto& row : rows) width = std::max(width, row[0].size());
  return width;
}

Rows headingOf(const Manifest& manifest, const Shards& shards, const ViewStatus& view, const std::string& checked) {
  return {{"scene", sceneName(manifest)},
          {"sensor", manifest.sensor_name},
          {"seed", std::to_string(manifest.seed)},
          {"policy", manifest.policy.empty() ? "none" : oneLine(manifest.policy)},
          {"device", manifest.device},
          {"program", "taxelsim " + manifest.program_version},
          {"format", std::to_string(manifest.format_version)},
          {"shards", fmt::format("{} of {} complete, {} missing{}, {} broken{}", shards.whole, manifest.numShards(), shards.missing.size(),
                                 listText(shards.missing), shards.broken.size(), listText(shards.broken))},
          {"view", viewText(shards, manifest, view.state)},
          {"SHA-256", hashText(shards, checked)}};
}

nlohmann::ordered_json summaryOf(const Manifest& manifest, const Shards& shards, const ViewStatus& view, const std::string& checked) {
  return {{"scene", sceneName(manifest)},
          {"sensor", manifest.sensor_name},
          {"num_rows", manifest.num_rows},
          {"num_cols", manifest.num_cols},
          {"seed", manifest.seed},
          {"policy", manifest.policy},
          {"device", manifest.device},
          {"program_version", manifest.program_version},
          {"format_version", manifest.format_version},
          {"num_episodes", manifest.num_episodes},
          {"compression", manifest.compression},
          {"chunk_bytes", manifest.chunk_bytes},
          {"shards",
           {{"expected", manifest.numShards()},
            {"whole", shards.whole},
            {"vouched_for", shards.vouched_for},
            {"missing", shards.missing},
            {"broken", shards.broken}}},
          {"view", nameOf(view.state)},
          {"checked", checked}};
}

nlohmann::ordered_json jsonOf(const Column& column, const Statistics& statistics) {
  nlohmann::ordered_json entry{{"name", column.name}, {"type", taxelsim::nameOf(column.type)}, {"shape", column.shape},
                               {"unit", column.unit}, {"description", column.description},     {"per_episode", column.per_episode}};
  if (!statistics.counts.empty()) {
    nlohmann::ordered_json counts = nlohmann::ordered_json::object();
    for (const auto& [name, count] : statistics.counts) counts[name] = count;
    entry["counts"] = counts;
  }
  if (column.type == ScalarType::kText) return entry;
  const bool some = statistics.num_finite > 0;
  entry["min"] = some ? nlohmann::ordered_json(statistics.min) : nullptr;
  entry["mean"] = some ? nlohmann::ordered_json(statistics.mean()) : nullptr;
  entry["max"] = some ? nlohmann::ordered_json(statistics.max) : nullptr;
  entry["non_finite"] = statistics.num_non_finite;
  return entry;
}

std::vector<std::string> rowOf(const Column& column, const Statistics& statistics) {
  const bool some = statistics.num_finite > 0;
  return {column.name,
          typeText(column),
          shapeText(column),
          column.unit,
          some ? roundedText(statistics.min) : "-",
          some ? roundedText(statistics.mean()) : "-",
          some ? roundedText(statistics.max) : "-",
          countText(statistics.num_non_finite)};
}

// True for a column of another sensor than the one of that name.
bool isOfAnother(const Column& column, const std::string& sensor, const std::vector<std::string>& sensors) {
  return !sensor.empty() && std::ranges::any_of(sensors, [&](const std::string& other) {
    return other != sensor && column.name.starts_with("data/" + other + "/");
  });
}

int runInspect(const InspectArguments& arguments) {
  const Manifest manifest = readManifest(arguments.directory);
  const bool contents = manifest.format_version > 1 ? arguments.verify : !arguments.quick;
  const Shards shards = sorted(checkShards(arguments.directory, contents, /*isolated=*/true));
  const ViewStatus view = checkView(arguments.directory, /*isolated=*/true);
  const std::string checked = checkedText(manifest, shards, arguments.quick);
  nlohmann::ordered_json json = summaryOf(manifest, shards, view, checked);
  Rows heading = headingOf(manifest, shards, view, checked);
  const auto printSummary = [&] {
    if (arguments.json) return printJsonText(json);
    for (const auto& row : heading) printOut("{:<9} {}\n", row[0], row[1]);
  };
  const bool is_view_broken = view.state == ViewStatus::State::kBroken;
  if (!shards.broken.empty() || is_view_broken) {
    printSummary();
    throw Error(ErrorKind::kInput, shards.broken.empty() ? view.problem : shards.problem);
  }

  const DatasetReader reader(arguments.directory, /*allow_incomplete=*/true, /*isolated=*/true);
  json["episodes_on_disk"] = reader.numEpisodes();
  json["frames_on_disk"] = reader.numFrames();
  json["columns"] = nlohmann::ordered_json::array();
  heading.push_back({"episodes", fmt::format("{} of {}", countText(reader.numEpisodes()), countText(manifest.num_episodes))});
  heading.push_back({"frames", countText(reader.numFrames())});
  const ShardSample sample = sampleShards(reader, arguments.verify);
  json["statistics_of_shards"] = sample.num_shards;
  if (const std::uint64_t num_found = shards.whole; sample.num_shards < num_found)
    heading.push_back({"values", fmt::format("of {} of {} shards; --verify reads all", sample.num_shards, countText(num_found))});
  Rows table{{"column", "type", "shape", "unit", "min", "mean", "max", "not finite"}}, names{{"column", "named values"}};
  if (!arguments.sensor.empty()) figures::imageGroup(manifest, arguments.sensor, arguments.directory);  // throws for another name
  const std::vector<std::string> sensors = figures::sensorsWithImages(manifest);
  for (const Column& column : manifest.columns) {
    if (isOfAnother(column, arguments.sensor, sensors)) continue;
    const Statistics statistics = statisticsOf(reader, column, sample);
    json["columns"].push_back(jsonOf(column, statistics));
    table.push_back(rowOf(column, statistics));
    if (!statistics.counts.empty()) names.push_back({column.name, countsText(statistics)});
  }
  printSummary();
  if (arguments.json) return kExitOk;
  printOut("\n{}", tableText(table));
  if (names.size() > 1) {
    printOut("\n");
    for (const auto& row : names) printOut("{:<{}}  {}\n", row[0], widthOf(names), row[1]);
  }
  return kExitOk;
}

}  // namespace

void addInspect(CLI::App& app, Action& action) {
  CLI::App* command = app.add_subcommand("inspect", "Print the contents of a data set and verify its checksums");
  command->footer(
      "Example:\n  taxelsim inspect out/\n"
      "Compares every shard with its size and time in dataset.checksums, and those that changed with their SHA-256; reads all values of a "
      "small data set, and of up to 16 shards of a large one. Exit status 2 if a shard or dataset.h5 is broken; lists missing shards.");
  const auto arguments = std::make_shared<InspectArguments>();
  command->add_option("directory", arguments->directory, "Directory of the data set")->required()->type_name("DIR");
  command->add_option("--sensor", arguments->sensor, "Leave out the columns of other sensors, where columns are grouped by sensor")
      ->type_name("NAME");
  command->add_flag("--json", arguments->json, "Print JSON");
  command->add_flag("--verify", arguments->verify, "Compare every shard with its SHA-256, in parallel, and read all values");
  command->add_flag("--quick", arguments->quick, "Format 1: verify the headers of shards only, not their values");
  command->callback([arguments, &action] { action = [arguments] { return runInspect(*arguments); }; });
}

}  // namespace taxelsim::cli
