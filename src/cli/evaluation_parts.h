// --episode-range, --part, --output and --merge of `taxelsim evaluate`: an evaluation in parts.
#pragma once

#include <CLI/App.hpp>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "taxelsim/evaluation_part.h"

namespace taxelsim::cli {

struct PartOptions {
  std::string episodes;   // "1000..1999", both ends included
  std::string part;       // "3/16", from 1
  std::string directory;  // where the part is written
  std::string merged;     // directory of the parts to merge
};

// Adds the options; `options` must outlive the parsing.
void addPartOptions(CLI::App& command, PartOptions& options);

// The episodes that the options choose; empty without options. Throws Error(kInput) for episodes that the scene does not have.
std::optional<EpisodeRange> chosenEpisodes(const PartOptions& options, std::uint64_t num_episodes);

// "out/episodes-00001000-00001999.json"
std::filesystem::path partFile(const std::filesystem::path& directory, const EpisodeRange& episodes);

// Whether the file has the part with these controllers already. Throws Error(kInput) if it is of another scene, device and so on.
bool isPlayed(const std::filesystem::path& file, const Scene& scene, const std::string& device,
              const std::vector<std::string>& controllers);

// All parts in a directory, by name. Throws Error(kInput) if there are none, if one is damaged, or if one is not of these controllers.
std::vector<NamedPart> partsIn(const std::filesystem::path& directory, const std::vector<std::string>& controllers);

}  // namespace taxelsim::cli
