// `taxelsim render`: draws frames of a data set.
#include <spdlog/fmt/fmt.h>
#include <spdlog/fmt/ranges.h>
#include <spdlog/spdlog.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <cmath>
#include <limits>
#include <memory>
#include <numbers>
#include <numeric>

#include "cli/commands.h"
#include "cli/print.h"
#include "cli/scene_name.h"
#include "figures/tactile_figure.h"
#include "figures/taxel_chart.h"
#include "figures/text.h"
#include "taxelsim/dataset.h"
#include "taxelsim/error.h"

namespace taxelsim::cli {

using namespace figures;

namespace {

constexpr const char* kImage = "data/tactile_image";
constexpr int kMaxFrames = 400;
constexpr std::size_t kTaxelsPerLine = 16;  // for sensors without a single grid

struct Arguments {
  std::string directory, picture;
  int num_frames = 12;
  std::uint64_t episode = 0;
};

const Column* find(const Manifest& manifest, const std::string& name) {
  const auto column = std::find_if(manifest.columns.begin(), manifest.columns.end(), [&](const Column& c) { return c.name == name; });
  return column == manifest.columns.end() ? nullptr : &*column;
}

// One row of a column; empty if the column is missing or has another length.
std::vector<double> row(const DatasetReader& reader, const std::string& name, std::uint64_t frame, std::size_t length) {
  const Column* column = find(reader.manifest(), name);
  if (column == nullptr || column->per_episode) return {};
  std::vector<double> values = reader.readAsDouble(name, frame, 1);
  return values.size() == length ? values : std::vector<double>{};
}

// A grid as an image, a list of taxels by their outlines if known, any other sensor as rows of taxels in storage order. For several
// sensors, the first one.
TactilePanel imageOf(const DatasetReader& reader, const std::vector<TaxelOutline>& outlines, std::uint64_t frame) {
  const Manifest& manifest = reader.manifest();
  TactilePanel panel;
  panel.values = reader.readAsDouble(kImage, frame, 1);
  if (manifest.num_rows > 0) {
    panel.num_rows = manifest.num_rows;
    panel.num_cols = manifest.num_cols;
    panel.values.resize(static_cast<std::size_t>(manifest.num_rows) * static_cast<std::size_t>(manifest.num_cols));
    if (manifest.pitch[0] > 0 && manifest.pitch[1] > 0) panel.pitch = manifest.pitch;
    return panel;
  }
  panel.values.resize(find(manifest, kImage)->shape.back());
  panel.neighbours = false;
  if (panel.values.size() == outlines.size()) {
    panel.outlines = outlines;
    return panel;
  }
  const std::size_t num_cols = std::min(panel.values.size(), kTaxelsPerLine);
  const std::size_t num_rows = (panel.values.size() + num_cols - 1) / num_cols;
  panel.values.resize(num_rows * num_cols, std::numeric_limits<double>::quiet_NaN());
  panel.num_rows = static_cast<int>(num_rows);
  panel.num_cols = static_cast<int>(num_cols);
  return panel;
}

// Recorded features if they are in metres on this grid, otherwise moments of the image.
std::optional<ContactAxes> axesOf(const DatasetReader& reader, const TactilePanel& panel, std::uint64_t frame) {
  if (!panel.neighbours) return std::nullopt;
  std::optional<ContactAxes> axes = axesOfImage(panel);
  if (!axes || panel.pitch != reader.manifest().pitch) return axes;
  const std::vector<double> centre = row(reader, "data/center_of_pressure", frame, 3);
  const std::vector<double> eigenvalues = row(reader, "data/eigenvalues", frame, 2);
  const std::vector<double> angle = row(reader, "data/edge_angle", frame, 1);
  if (!centre.empty()) axes->centre = {centre[0], centre[1]};
  if (!eigenvalues.empty()) axes->eigenvalues = {eigenvalues[0], eigenvalues[1]};
  if (!angle.empty()) axes->angle = angle[0];
  return axes;
}

std::string captionOf(const DatasetReader& reader, const TactilePanel& panel, std::uint64_t frame) {
  std::vector<std::string> parts;
  if (const auto force = row(reader, "data/total_force", frame, 1); !force.empty()) parts.push_back(fmt::format("{:.3g} N", force[0]));
  const auto confidence = row(reader, "data/edge_confidence", frame, 1);
  const bool undefined = !confidence.empty() && !(confidence[0] > 0);
  if (const auto angle = row(reader, "data/edge_angle", frame, 1); !angle.empty() && !undefined)
    parts.push_back(fmt::format("angle {:.1f}°", angle[0] * 180 / std::numbers::pi));
  if (!confidence.empty()) parts.push_back(fmt::format("confidence {:.2f}", confidence[0]));
  if (!panel.neighbours) parts.push_back(panel.outlines.empty() ? "taxels in storage order" : "unrolled");
  return fmt::format("{}", fmt::join(parts, "   "));
}

// Numbers of the episodes that are there, (num_episodes): their places, unless the data set is one of chosen episodes.
std::vector<std::uint64_t> episodeNumbers(const DatasetReader& reader) {
  std::vector<std::uint64_t> numbers(reader.numEpisodes());
  std::iota(numbers.begin(), numbers.end(), std::uint64_t{0});
  const Manifest& manifest = reader.manifest();
  if (manifest.episodes.empty()) return numbers;
  numbers.clear();
  for (std::uint64_t row = 0; row < manifest.num_episodes; ++row) {
    const std::uint64_t shard = row / manifest.episodes_per_shard;
    if (!std::binary_search(reader.missingShards().begin(), reader.missingShards().end(), shard)) numbers.push_back(manifest.episodes[row]);
  }
  return numbers;
}

// Index of the episode that --episode names.
std::size_t rowOf(const Arguments& arguments, const std::vector<std::uint64_t>& numbers) {
  const auto found = std::find(numbers.begin(), numbers.end(), arguments.episode);
  if (found != numbers.end()) return static_cast<std::size_t>(found - numbers.begin());
  static constexpr std::size_t kMost = 8;
  const auto end = numbers.begin() + static_cast<std::ptrdiff_t>(std::min(numbers.size(), kMost));
  const std::string allowed = numbers.back() == numbers.size() - 1
                                  ? fmt::format("0 to {}", numbers.back())
                                  : fmt::format("{}{}", fmt::join(numbers.begin(), end, ", "), numbers.size() > kMost ? ", ..." : "");
  throw Error(ErrorKind::kInput, fmt::format("--episode {}: {} has episodes {}", arguments.episode, arguments.directory, allowed));
}

int runRender(const Arguments& arguments, bool one_episode) {
  const DatasetReader reader(arguments.directory, /*allow_incomplete=*/true, /*isolated=*/true);
  const Manifest& manifest = reader.manifest();
  if (find(manifest, kImage) == nullptr) throw Error(ErrorKind::kInput, arguments.directory + ": no column " + kImage + " to draw");
  if (reader.numFrames() == 0) throw Error(ErrorKind::kInput, arguments.directory + ": no frames yet");
  if (!reader.missingShards().empty()) spdlog::warn("{}: {} shards are missing", arguments.directory, reader.missingShards().size());

  const std::vector<std::uint64_t>& ends = reader.episodeEnds();
  const std::vector<std::uint64_t> numbers = episodeNumbers(reader);
  const std::size_t row = one_episode ? rowOf(arguments, numbers) : 0;
  const std::uint64_t begin = row > 0 ? ends[row - 1] : 0;
  const std::uint64_t end = one_episode ? ends[row] : ends.back();
  const std::uint64_t count = std::min<std::uint64_t>(end - begin, static_cast<std::uint64_t>(arguments.num_frames));

  const std::optional<Sensor> listed = listedTaxels(manifest);
  const std::vector<TaxelOutline> outlines = listed ? unrolled(*listed) : std::vector<TaxelOutline>{};
  std::vector<TactilePanel> panels;
  for (std::uint64_t k = 0; k < count; ++k) {
    // Evenly spaced, with the first and the last frame.
    const std::uint64_t frame = count == 1 ? begin : begin + k * (end - begin - 1) / (count - 1);
    const auto episode = static_cast<std::uint64_t>(std::upper_bound(ends.begin(), ends.end(), frame) - ends.begin());
    TactilePanel panel = imageOf(reader, outlines, frame);
    panel.title = fmt::format("episode {}, frame {}", numbers[episode], frame - (episode > 0 ? ends[episode - 1] : 0));
    panel.caption = captionOf(reader, panel, frame);
    panel.axes = axesOf(reader, panel, frame);
    panels.push_back(std::move(panel));
  }
  const std::string name = sceneName(manifest);
  writeTactileFigure(arguments.picture, panels,
                     {.title = name == "-" ? arguments.directory : name,
                      .subtitle = fmt::format("{}, seed {}, {} episodes, {} frames", manifest.sensor_name, manifest.seed,
                                              countText(reader.numEpisodes()), countText(reader.numFrames())),
                      .unit = find(manifest, kImage)->unit});
  printOut("{}: {} frames\n", arguments.picture, count);
  return kExitOk;
}

}  // namespace

void addRender(CLI::App& app, Action& action) {
  CLI::App* command = app.add_subcommand("render", "Draw frames of a data set (PNG)");
  command->footer(
      "Example:\n  taxelsim render out/ -o out.png --episode 3 --frames 20\n"
      "Draws evenly spaced frames of one episode, or of all episodes.");
  const auto arguments = std::make_shared<Arguments>();
  command->add_option("directory", arguments->directory, "Directory of the data set")->required()->type_name("DIR");
  command->add_option("-o,--output", arguments->picture, "Figure to write (PNG)")->required()->check(requirePngName)->type_name("FILE");
  command->add_option("--frames", arguments->num_frames, fmt::format("Number of frames to draw, at most {}", kMaxFrames))
      ->check(silent(CLI::Range(1, kMaxFrames)))
      ->capture_default_str()
      ->type_name("N");
  CLI::Option* episode =
      command->add_option("--episode", arguments->episode, "Draw frames of this episode only")->check(refuseNegative)->type_name("E");
  command->callback([=, &action] { action = [=] { return runRender(*arguments, episode->count() > 0); }; });
}

}  // namespace taxelsim::cli
