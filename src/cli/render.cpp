// `taxelsim render`: draws frames of a data set. Videos are encoded in Python (python/taxelsim/commands/render.py) from the stream of
// pictures that `-o -` writes.
#include <spdlog/fmt/fmt.h>
#include <spdlog/fmt/ranges.h>
#include <spdlog/spdlog.h>
#include <unistd.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <memory>
#include <numeric>

#include "base/text.h"
#include "cli/commands.h"
#include "cli/frame_panels.h"
#include "cli/print.h"
#include "cli/scene_name.h"
#include "figures/tactile_figure.h"
#include "figures/text.h"
#include "taxelsim/counts_range.h"
#include "taxelsim/dataset.h"
#include "taxelsim/error.h"

namespace taxelsim::cli {

using namespace figures;

namespace {

constexpr int kMaxFrames = 400;
constexpr std::uint64_t kFramesAtOnce = 1024;  // that a video holds in memory
constexpr double kRounding = 1e-6;             // relative, of the time between two frames
constexpr const char* kStream = "-";
constexpr const char* kObjectName = "meta/object_name";

struct RenderArguments {
  std::string directory, picture, sensor;
  int num_frames = 12;
  std::uint64_t episode = 0;
  double rate = 0;   // 1/s, of the pictures of a stream; 0: all frames
  double range = 0;  // counts of the brightest colour; 0: from the data set
};

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
std::size_t rowOf(const RenderArguments& arguments, const std::vector<std::uint64_t>& numbers) {
  const auto found = std::find(numbers.begin(), numbers.end(), arguments.episode);
  if (found != numbers.end()) return static_cast<std::size_t>(found - numbers.begin());
  static constexpr std::size_t kMost = 8;
  const auto end = numbers.begin() + static_cast<std::ptrdiff_t>(std::min(numbers.size(), kMost));
  const std::string allowed = numbers.back() == numbers.size() - 1
                                  ? fmt::format("0 to {}", numbers.back())
                                  : fmt::format("{}{}", fmt::join(numbers.begin(), end, ", "), numbers.size() > kMost ? ", ..." : "");
  throw Error(ErrorKind::kInput, fmt::format("--episode {}: {} has episodes {}", arguments.episode, arguments.directory, allowed));
}

// Titles of panels: episode, frame, and the name of the object.
class Titles {
 public:
  explicit Titles(const DatasetReader& reader) : reader_(reader), numbers_(episodeNumbers(reader)) {
    const Column* const column = findColumn(reader.manifest(), kObjectName);
    has_names_ = column != nullptr && column->type == ScalarType::kText && column->per_episode;
  }

  const std::vector<std::uint64_t>& episodes() const { return numbers_; }

  std::string of(std::uint64_t frame) {
    const std::vector<std::uint64_t>& ends = reader_.episodeEnds();
    const auto row = static_cast<std::uint64_t>(std::upper_bound(ends.begin(), ends.end(), frame) - ends.begin());
    if (has_names_ && row != row_) object_ = oneLine(reader_.readAsText(kObjectName, row, 1)[0]);
    row_ = row;
    return fmt::format("episode {}, frame {}{}{}", numbers_[row], frame - (row > 0 ? ends[row - 1] : 0), object_.empty() ? "" : ": ",
                       object_);
  }

 private:
  const DatasetReader& reader_;
  std::vector<std::uint64_t> numbers_;
  bool has_names_ = false;
  std::uint64_t row_ = ~std::uint64_t{0};  // of object_
  std::string object_;
};

// Counts of the brightest colour: those of the whole data set, so that all its pictures and videos have one scale. A broken shard elsewhere
// leaves the frames [begin, end) of an episode.
double rangeOf(const RenderArguments& arguments, const DatasetReader& reader, const std::string& column, std::uint64_t begin,
               std::uint64_t end) {
  if (arguments.range > 0) return arguments.range;
  try {
    return countsRange(reader, column, 0, reader.numFrames());
  } catch (const Error& error) {
    if (end - begin == reader.numFrames()) throw;
    spdlog::warn("{}; the colours are those of this episode alone", error.what());
    return countsRange(reader, column, begin, end);
  }
}

FigureOptions optionsOf(const RenderArguments& arguments, const DatasetReader& reader, std::uint64_t begin, std::uint64_t end) {
  const Manifest& manifest = reader.manifest();
  const std::string group = imageGroup(manifest, arguments.sensor, arguments.directory);
  const std::string name = sceneName(manifest), column = shownColumn(manifest, group);
  return {
      .title = name == "-" ? arguments.directory : name,
      .subtitle = fmt::format("{}, seed {}, {} episodes, {} frames{}", manifest.sensor_name, manifest.seed, countText(reader.numEpisodes()),
                              countText(reader.numFrames()), column.ends_with(kTaxelCounts) ? "; arrows: shear" : ""),
      .unit = findColumn(manifest, group + kTactileImage)->unit,
      .range = rangeOf(arguments, reader, column, begin, end)};
}

// Draws evenly spaced frames out of [begin, end), with the first and the last one.
void drawFigure(const RenderArguments& arguments, const DatasetReader& reader, Titles& titles, std::uint64_t begin, std::uint64_t end) {
  const std::uint64_t count = std::min<std::uint64_t>(end - begin, static_cast<std::uint64_t>(arguments.num_frames));
  const std::vector<TaxelOutline> outlines = outlinesOf(reader.manifest());
  const std::string group = imageGroup(reader.manifest(), arguments.sensor, arguments.directory);
  const double least_shear = kShearDeviations * countsNoise(reader.manifest(), shownColumn(reader.manifest(), group));
  std::vector<TactilePanel> panels;
  for (std::uint64_t k = 0; k < count; ++k) {
    const std::uint64_t frame = count == 1 ? begin : begin + k * (end - begin - 1) / (count - 1);
    panels.push_back(FramePanels(reader, group, outlines, least_shear, frame, 1).panelOf(frame));
    panels.back().title = titles.of(frame);
  }
  writeTactileFigure(arguments.picture, panels, optionsOf(arguments, reader, begin, end));
  printOut("{}: {} frames\n", arguments.picture, count);
}

// Every n-th frame, so that there are at most `rate` pictures per second of an episode with these times.
std::uint64_t strideOf(const DatasetReader& reader, double rate, std::uint64_t begin, std::uint64_t end) {
  if (rate <= 0 || end - begin < 2) return 1;
  const std::vector<double> times = reader.readAsDouble("data/time", begin, 2);
  const double step = 1 / ((times[1] - times[0]) * rate) * (1 - kRounding);
  return step > 1 ? static_cast<std::uint64_t>(std::ceil(std::min(step, static_cast<double>(end - begin)))) : 1;
}

// Writes pictures of the frames [begin, end) of an episode to standard output, all with one colour scale, each with its time.
void streamPictures(const RenderArguments& arguments, const DatasetReader& reader, Titles& titles, std::uint64_t begin, std::uint64_t end) {
  const Column* const time = findColumn(reader.manifest(), "data/time");
  if (time == nullptr || time->per_episode || !time->shape.empty())
    throw Error(ErrorKind::kInput, arguments.directory + ": no column data/time with one number per frame");
  const FigureOptions options = optionsOf(arguments, reader, begin, end);
  const std::vector<TaxelOutline> outlines = outlinesOf(reader.manifest());
  const std::string group = imageGroup(reader.manifest(), arguments.sensor, arguments.directory);
  const double least_shear = kShearDeviations * countsNoise(reader.manifest(), shownColumn(reader.manifest(), group));
  const std::uint64_t stride = strideOf(reader, arguments.rate, begin, end);
  for (std::uint64_t first = begin; first < end; first += kFramesAtOnce) {
    const std::uint64_t count = std::min(kFramesAtOnce, end - first);
    const FramePanels panels(reader, group, outlines, least_shear, first, count);
    const std::vector<double> times = reader.readAsDouble("data/time", first, count);
    for (std::uint64_t frame = begin + (first - begin + stride - 1) / stride * stride; frame < first + count; frame += stride) {
      TactilePanel panel = panels.panelOf(frame);
      panel.title = titles.of(frame);
      drawTactileFigure({std::move(panel)}, options).appendPpm(stdout, "time " + numberText(times[frame - first]));
    }
  }
}

int runRender(const RenderArguments& arguments, bool one_episode) {
  const bool is_stream = arguments.picture == kStream;
  if (is_stream && !one_episode) throw Error(ErrorKind::kInput, "--output -: needs --episode, whose frames it writes");
  if (is_stream && ::isatty(STDOUT_FILENO) != 0)
    throw Error(ErrorKind::kInput, "--output -: standard output is a terminal; redirect it to a program that reads PPM pictures");
  const DatasetReader reader(arguments.directory, /*allow_incomplete=*/true, /*isolated=*/true);
  imageGroup(reader.manifest(), arguments.sensor, arguments.directory);  // refuses a data set without an image of that sensor
  if (reader.numFrames() == 0) throw Error(ErrorKind::kInput, arguments.directory + ": no frames yet");
  if (!reader.missingShards().empty()) spdlog::warn("{}: {} shards are missing", arguments.directory, reader.missingShards().size());

  Titles titles(reader);
  const std::vector<std::uint64_t>& ends = reader.episodeEnds();
  const std::size_t row = one_episode ? rowOf(arguments, titles.episodes()) : 0;
  const std::uint64_t begin = row > 0 ? ends[row - 1] : 0, end = one_episode ? ends[row] : ends.back();
  (is_stream ? streamPictures : drawFigure)(arguments, reader, titles, begin, end);
  return kExitOk;
}

std::string checkOutput(const std::string& name) {
  if (name == kStream || requirePngName(name).empty()) return "";
  return name + ": the name must end in .png, or in .mp4 or .gif for a video of an episode";
}

}  // namespace

void addRender(CLI::App& app, Action& action) {
  CLI::App* command = app.add_subcommand("render", "Draw frames of a data set (PNG), or a video of an episode (MP4, GIF)");
  command->footer(
      "Examples:\n  taxelsim render out/ -o out.png --episode 3 --frames 20\n  taxelsim render out/ -o out.mp4 --episode 3 --speed 0.25\n"
      "A picture shows evenly spaced frames of one episode, or of all episodes. Videos need the Python package: "
      "`pip install 'taxelsim[video]'`.\n"
      "-o - writes the pictures of an episode to standard output, as PPM, for other programs:\n"
      "  taxelsim render out/ -o - --episode 3 --rate 25 | ffmpeg -f image2pipe -c:v ppm -framerate 25 -i - out.mkv");
  const auto arguments = std::make_shared<RenderArguments>();
  command->add_option("directory", arguments->directory, "Directory of the data set")->required()->type_name("DIR");
  command
      ->add_option("-o,--output", arguments->picture, "Figure to write (PNG), video to write (MP4, GIF), or - for a stream of PPM pictures")
      ->required()
      ->check(checkOutput)
      ->type_name("FILE");
  CLI::Option* frames =
      command->add_option("--frames", arguments->num_frames, fmt::format("Number of frames that a figure shows, at most {}", kMaxFrames))
          ->check(silent(CLI::Range(1, kMaxFrames)))
          ->capture_default_str()
          ->type_name("N");
  command->add_option("--sensor", arguments->sensor, "Sensor to draw, where columns are grouped by sensor; otherwise the first")
      ->type_name("NAME");
  CLI::Option* episode =
      command->add_option("--episode", arguments->episode, "Draw frames of this episode only")->check(refuseNegative)->type_name("E");
  CLI::Option* rate = command->add_option("--rate", arguments->rate, "With -o -: at most this many pictures per second; default all frames")
                          ->check(silent(CLI::PositiveNumber))
                          ->type_name("HZ");
  rate->excludes(frames);
  command->add_option("--range", arguments->range, "Counts of the brightest colour; default: the 99.9th percentile of the data set")
      ->check(silent(CLI::PositiveNumber))
      ->type_name("COUNTS");
  command->callback([=, &action] { action = [=] { return runRender(*arguments, episode->count() > 0); }; });
}

}  // namespace taxelsim::cli
