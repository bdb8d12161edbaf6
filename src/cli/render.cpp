// `taxelsim render`: draws frames of a data set, and moving pictures of an episode as WebP. Other videos are made in Python
// (python/taxelsim/commands/render.py).
#include <spdlog/fmt/fmt.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <cmath>
#include <limits>
#include <memory>

#include "base/text.h"
#include "cli/commands.h"
#include "cli/print.h"
#include "figures/episode_view.h"
#include "figures/frame_figures.h"
#include "figures/webp_animation.h"
#include "taxelsim/error.h"

namespace taxelsim::cli {

using namespace figures;

namespace {

constexpr int kMaxFrames = 400;
constexpr double kMaxRate = 50;         // pictures per second, beyond which viewers leave some out
constexpr double kRateRounding = 1e-6;  // relative, of the time between two frames
constexpr double kMaxDuration = 1e7;    // ms, of a moving picture: WebP has 24 bits for that of one frame
constexpr const char* kMoving = ".webp";

struct RenderArguments {
  FrameSelection selection;
  std::string picture;
  int num_frames = 12;
  double speed = 1;
  std::vector<std::filesystem::path> assets;
};

// Draws evenly spaced frames, with the first and the last one.
int drawFigure(const RenderArguments& arguments) {
  FrameFigures figures(arguments.selection);
  std::vector<std::uint64_t> frames(std::min<std::uint64_t>(arguments.num_frames, figures.numFrames()));
  for (std::size_t k = 1; k < frames.size(); ++k) frames[k] = k * (figures.numFrames() - 1) / (frames.size() - 1);
  figures.figureOf(frames).save(arguments.picture);
  printOut("{}: {} frames\n", arguments.picture, frames.size());
  return kExitOk;
}

// Times at which pictures begin and the last one ends, in ms.
struct Schedule {
  std::uint64_t stride = 1;  // a picture for each stride-th frame
  double step = 0;           // ms, between pictures
  std::uint64_t num_pictures = 0;

  int endOf(std::uint64_t picture) const { return static_cast<int>(std::lround(static_cast<double>(picture + 1) * step)); }
};

// Leaves out as few frames as the largest rate of pictures needs.
Schedule scheduleOf(const RenderArguments& arguments, const std::vector<double>& times) {
  const std::string& directory = arguments.selection.directory;
  if (times.size() < 2) throw Error(ErrorKind::kInput, directory + ": an episode of one frame does not move; -o FILE.png draws it");
  const double step = 1e3 * (times[1] - times[0]) / arguments.speed;
  if (!(step > 0)) throw Error(ErrorKind::kInput, directory + ": data/time of the episode does not increase");
  const double stride = std::ceil(1e3 / kMaxRate / step * (1 - kRateRounding));
  if (!(stride < static_cast<double>(times.size())) || !(step * static_cast<double>(times.size()) <= kMaxDuration)) {
    throw Error(ErrorKind::kInput,
                fmt::format("--speed {} is not allowed: the episode of {:.4g} s needs at least two pictures and at most {:g} s",
                            numberText(arguments.speed), times.back() - times.front(), kMaxDuration / 1e3));
  }
  Schedule schedule{.stride = std::max<std::uint64_t>(1, static_cast<std::uint64_t>(stride))};
  schedule.step = step * static_cast<double>(schedule.stride);
  schedule.num_pictures = (times.size() + schedule.stride - 1) / schedule.stride;
  return schedule;
}

int drawAnimation(const RenderArguments& arguments) {
  if (!arguments.selection.episode) throw Error(ErrorKind::kInput, "--episode is missing: a moving picture shows one episode");
  FrameFigures frames(arguments.selection);
  EpisodeView view(frames, arguments.assets);
  const Schedule schedule = scheduleOf(arguments, frames.times());
  WebpAnimation animation;
  for (std::uint64_t k = 0; k < schedule.num_pictures; ++k) animation.add(view.pictureOf(k * schedule.stride).pixels(), schedule.endOf(k));
  animation.save(arguments.picture);
  printOut("{}: {} frames, {:.3g} s\n", arguments.picture, schedule.num_pictures, schedule.endOf(schedule.num_pictures - 1) / 1e3);
  return kExitOk;
}

int runRender(const RenderArguments& arguments) {
  return arguments.picture.ends_with(kMoving) ? drawAnimation(arguments) : drawFigure(arguments);
}

std::string checkOutput(const std::string& name) {
  if (name.ends_with(kMoving) || requirePngName(name).empty()) return "";
  return name + ": the name must end in .png, or in .webp, .mp4 or .gif for a moving picture of an episode";
}

}  // namespace

void addRender(CLI::App& app, Action& action) {
  CLI::App* command = app.add_subcommand("render", "Draw frames of a data set (PNG), or a moving picture of an episode (WebP, MP4, GIF)");
  command->footer(
      "Examples:\n  taxelsim render out/ -o out.png --episode 3 --frames 20\n  taxelsim render out/ -o out.webp --episode 3 --speed 0.25\n"
      "A picture shows evenly spaced frames of one episode, or of all episodes. A moving picture shows sensor and object in 3-D, the "
      "tactile "
      "image, force and edge angle. MP4 and GIF need the Python package, `pip install 'taxelsim[video]'`, and take scene files as well.");
  const auto arguments = std::make_shared<RenderArguments>();
  FrameSelection& selection = arguments->selection;
  command->add_option("directory", selection.directory, "Directory of the data set")->required()->type_name("DIR");
  command->add_option("-o,--output", arguments->picture, "Figure to write (PNG), or moving picture to write (WebP, MP4, GIF)")
      ->required()
      ->check(checkOutput)
      ->type_name("FILE");
  command->add_option("--frames", arguments->num_frames, fmt::format("Number of frames that a figure shows, at most {}", kMaxFrames))
      ->check(silent(CLI::Range(1, kMaxFrames)))
      ->capture_default_str()
      ->type_name("N");
  command
      ->add_option("--sensor", selection.sensor,
                   "Sensor to draw, where columns are grouped by sensor; otherwise the first, or all as MP4 or GIF")
      ->type_name("NAME");
  command->add_option("--episode", selection.episode, "Draw frames of this episode only; a moving picture needs it")
      ->check(refuseNegative)
      ->type_name("E");
  command->add_option("--range", selection.range, "Counts of the brightest colour; default: the 99.9th percentile of the data set")
      ->check(silent(CLI::PositiveNumber))
      ->type_name("COUNTS");
  command->add_option("--speed", arguments->speed, "Speed of a moving picture: 1 is real time, 0.1 ten times slower")
      ->check(silent(CLI::PositiveNumber))
      ->capture_default_str()
      ->type_name("X");
  command->add_option("--assets", arguments->assets, "Folder with the meshes of the scene, for a moving picture; repeatable")
      ->allow_extra_args(false)
      ->type_name("DIR");
  command->callback([=, &action] { action = [=] { return runRender(*arguments); }; });
}

}  // namespace taxelsim::cli
