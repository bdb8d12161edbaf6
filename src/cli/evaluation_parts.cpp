#include "cli/evaluation_parts.h"

#include <spdlog/fmt/fmt.h>
#include <spdlog/fmt/ranges.h>

#include <CLI/CLI.hpp>
#include <algorithm>

#include "cli/shard_options.h"
#include "taxelsim/error.h"

namespace taxelsim::cli {
namespace {

namespace fs = std::filesystem;

void requireControllers(const NamedPart& part, const std::vector<std::string>& expected) {
  std::vector<std::string> found;
  for (const EvaluationPart::Verdicts& evaluation : part.part.evaluations) found.push_back(evaluation.controller);
  if (found != expected)
    throw Error(ErrorKind::kInput,
                fmt::format("{}: has the controllers {}, {} requested", part.name, fmt::join(found, ", "), fmt::join(expected, ", ")));
}

}  // namespace

void addPartOptions(CLI::App& command, PartOptions& options) {
  CLI::Option* const output =
      command.add_option("-o,--output", options.directory, "Directory for the verdicts of a part; created if missing")->type_name("DIR");
  CLI::Option* const range =
      command
          .add_option("--episode-range", options.episodes, "Play these episodes only, both ends included, and write their verdicts to DIR")
          ->check(checkRange)
          ->type_name("A..B")
          ->needs(output);
  CLI::Option* const part = command.add_option("--part", options.part, "Play part K of N of the episodes, K from 1; as --episode-range")
                                ->check(checkPart)
                                ->type_name("K/N")
                                ->needs(output)
                                ->excludes(range);
  command.add_option("--merge", options.merged, "Put the parts in DIR together instead of playing; prints what one process prints")
      ->type_name("DIR")
      ->excludes(output, range, part);
}

std::optional<EpisodeRange> chosenEpisodes(const PartOptions& options, std::uint64_t num_episodes) {
  if (!options.part.empty()) {
    const auto [part, num_parts] = *numberPair(options.part, "/");
    return partOfEpisodes(num_episodes, part, num_parts);
  }
  if (options.episodes.empty()) {
    if (options.directory.empty()) return {};
    throw Error(ErrorKind::kInput, "--output: needs --episode-range or --part");
  }
  const auto [first, last] = *numberPair(options.episodes, "..");
  if (last >= num_episodes)
    throw Error(ErrorKind::kInput,
                fmt::format("--episode-range: {} is not allowed: the scene has episodes 0 to {}", options.episodes, num_episodes - 1));
  return EpisodeRange{.first = first, .end = last + 1};
}

fs::path partFile(const fs::path& directory, const EpisodeRange& episodes) {
  return directory / fmt::format("episodes-{:08}-{:08}.json", episodes.first, episodes.end - 1);
}

bool isPlayed(const fs::path& file, const Scene& scene, const std::string& device, const std::vector<std::string>& controllers) {
  if (!fs::exists(file)) return false;
  const NamedPart found{.name = file.string(), .part = readEvaluationPart(file)};
  checkEvaluationPart(found, scene);
  if (found.part.device != device)
    throw Error(ErrorKind::kInput, fmt::format("{}: has another device ({} there, {} requested)", found.name, found.part.device, device));
  requireControllers(found, controllers);
  return true;
}

std::vector<NamedPart> partsIn(const fs::path& directory, const std::vector<std::string>& controllers) {
  if (!fs::is_directory(directory)) throw Error(ErrorKind::kInput, directory.string() + ": is not a directory");
  std::vector<fs::path> files;
  for (const fs::directory_entry& entry : fs::directory_iterator(directory)) {
    const std::string name = entry.path().filename().string();
    if (name.starts_with("episodes-") && name.ends_with(".json")) files.push_back(entry.path());
  }
  if (files.empty()) throw Error(ErrorKind::kInput, directory.string() + ": has no part of an evaluation (episodes-*.json)");
  std::sort(files.begin(), files.end());
  std::vector<NamedPart> parts;
  for (const fs::path& file : files) {
    parts.push_back({.name = file.string(), .part = readEvaluationPart(file)});
    requireControllers(parts.back(), controllers);
  }
  return parts;
}

}  // namespace taxelsim::cli
