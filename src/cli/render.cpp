// `taxelsim render`: draws frames of a data set. Videos are made in Python (python/taxelsim/commands/render.py).
#include <spdlog/fmt/fmt.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <memory>

#include "cli/commands.h"
#include "cli/print.h"
#include "figures/frame_figures.h"

namespace taxelsim::cli {

using namespace figures;

namespace {

constexpr int kMaxFrames = 400;

struct RenderArguments {
  FrameSelection selection;
  std::string picture;
  int num_frames = 12;
};

// Draws evenly spaced frames, with the first and the last one.
int runRender(const RenderArguments& arguments) {
  FrameFigures figures(arguments.selection);
  std::vector<std::uint64_t> frames(std::min<std::uint64_t>(arguments.num_frames, figures.numFrames()));
  for (std::size_t k = 1; k < frames.size(); ++k) frames[k] = k * (figures.numFrames() - 1) / (frames.size() - 1);
  figures.figureOf(frames).save(arguments.picture);
  printOut("{}: {} frames\n", arguments.picture, frames.size());
  return kExitOk;
}

std::string checkOutput(const std::string& name) {
  return requirePngName(name).empty() ? "" : name + ": the name must end in .png, or in .mp4 or .gif for a video of an episode";
}

}  // namespace

void addRender(CLI::App& app, Action& action) {
  CLI::App* command = app.add_subcommand("render", "Draw frames of a data set (PNG), or a video of an episode (MP4, GIF)");
  command->footer(
      "Examples:\n  taxelsim render out/ -o out.png --episode 3 --frames 20\n  taxelsim render out/ -o out.mp4 --episode 3 --speed 0.25\n"
      "A picture shows evenly spaced frames of one episode, or of all episodes. Videos need the Python package: "
      "`pip install 'taxelsim[video]'`.");
  const auto arguments = std::make_shared<RenderArguments>();
  FrameSelection& selection = arguments->selection;
  command->add_option("directory", selection.directory, "Directory of the data set")->required()->type_name("DIR");
  command->add_option("-o,--output", arguments->picture, "Figure to write (PNG), or video to write (MP4, GIF)")
      ->required()
      ->check(checkOutput)
      ->type_name("FILE");
  command->add_option("--frames", arguments->num_frames, fmt::format("Number of frames that a figure shows, at most {}", kMaxFrames))
      ->check(silent(CLI::Range(1, kMaxFrames)))
      ->capture_default_str()
      ->type_name("N");
  command->add_option("--sensor", selection.sensor, "Sensor to draw, where columns are grouped by sensor; otherwise the first")
      ->type_name("NAME");
  command->add_option("--episode", selection.episode, "Draw frames of this episode only")->check(refuseNegative)->type_name("E");
  command->add_option("--range", selection.range, "Counts of the brightest colour; default: the 99.9th percentile of the data set")
      ->check(silent(CLI::PositiveNumber))
      ->type_name("COUNTS");
  command->callback([=, &action] { action = [=] { return runRender(*arguments); }; });
}

}  // namespace taxelsim::cli
