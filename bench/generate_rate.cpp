// Throughput of `generate` to disk, uncompressed and compressed, as a fraction of the device alone on the same frames, which replays the
// poses of a first run; and the time per stage. Also the time of a new process to its first frame, with a cold and a warm shader cache.
#include <fcntl.h>
#include <spawn.h>
#include <stdlib.h>
#include <sys/wait.h>
#include <unistd.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <cstdio>
#include <cstring>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "report.h"
#include "taxelsim/dataset.h"
#include "taxelsim/error.h"
#include "taxelsim/generate.h"
#include "taxelsim/scene.h"
#include "taxelsim/simulator.h"

namespace taxelsim::bench {
namespace {

namespace fs = std::filesystem;

struct Options {
  std::string scene = TAXELSIM_BENCH "/scenes/edge_servo_5k.yaml";
  std::string program = TAXELSIM_PROGRAM;
  std::string json, device;
  std::string directory = fs::temp_directory_path().string();
  std::optional<std::uint64_t> num_episodes;
  std::vector<int> compression{0, 4};
  int batch_size = GenerateOptions().batch_size;
  int num_slices = GenerateOptions().num_slices;
  int repetitions = 3;
};

// Temporary directory, removed by the destructor.
class ScratchDirectory {
 public:
  explicit ScratchDirectory(const std::string& parent) {
    std::string pattern = parent + "/taxelsim_bench_XXXXXX";
    if (!::mkdtemp(pattern.data())) throw Error(ErrorKind::kIo, parent + ": cannot create a directory there");
    path_ = pattern;
  }
  ~ScratchDirectory() {
    std::error_code ignored;
    fs::remove_all(path_, ignored);
  }
  ScratchDirectory(const ScratchDirectory&) = delete;
  ScratchDirectory& operator=(const ScratchDirectory&) = delete;
  const fs::path& path() const { return path_; }

 private:
  fs::path path_;
};

// Poses of all frames of a data set.
struct Replay {
  std::vector<int> ids;
  std::vector<Pose> X_SO;    // (num_frames), episode by episode
  std::vector<float> loads;  // (num_episodes), NaN when pose-driven
  int num_steps = 0;
};

template <class T>
std::vector<T> column(const DatasetReader& reader, const std::string& name, std::uint64_t count) {
  const std::vector<std::byte> bytes = reader.read(name, 0, count);
  std::vector<T> values(bytes.size() / sizeof(T));
  std::memcpy(values.data(), bytes.data(), bytes.size());
  return values;
}

Replay replayOf(const fs::path& directory, const Scene& scene) {
  const DatasetReader reader(directory);
  const std::uint64_t num_episodes = reader.numEpisodes();
  Replay replay;
  replay.num_steps = static_cast<int>(reader.numFrames() / num_episodes);
  for (const double object : reader.readAsDouble("meta/object", 0, num_episodes)) replay.ids.push_back(static_cast<int>(object));
  replay.loads = column<float>(reader, "meta/load", num_episodes);
  if (!scene.randomization.load) std::fill(replay.loads.begin(), replay.loads.end(), kPoseDriven);
  const std::vector<double> poses = column<double>(reader, "data/pose", reader.numFrames());
  for (std::size_t i = 0; i < poses.size(); i += 7) {
    replay.X_SO.push_back({{poses[i], poses[i + 1], poses[i + 2]}, {poses[i + 3], poses[i + 4], poses[i + 5], poses[i + 6]}});
  }
  return replay;
}

// Sum of the device's time over all frames, in batches of one slice as in generate(): the first frame of an episode is driven by its load,
// the others by their poses.
double deviceSeconds(const Model& model, const Scene& scene, const Replay& replay, int slice_size) {
  const int num_episodes = static_cast<int>(replay.ids.size());
  double seconds = 0;
  for (int first = 0; first < num_episodes; first += slice_size) {
    const int size = std::min(slice_size, num_episodes - first);
    Simulator simulator(model, {.num_instances = size, .seed = scene.seed, .outputs = kNoOutputs, .device_clock = true});
    std::vector<Pose> X_SO(size);
    const auto step = [&](int frame) {
      for (int i = 0; i < size; ++i) X_SO[i] = replay.X_SO[static_cast<std::size_t>(first + i) * replay.num_steps + frame];
      simulator.setObjects(std::span(replay.ids).subspan(first, size), X_SO);
      simulator.step(1 / scene.simulation_rate);
      simulator.read();
    };
    if (first == 0) step(0);  // warm-up
    simulator.setLoads(std::span(replay.loads).subspan(first, size));
    for (int frame = 0; frame < replay.num_steps; ++frame) {
      step(frame);
      seconds += simulator.timing().total;
      if (frame == 0) simulator.setLoads(std::vector<float>(size, kPoseDriven));
    }
  }
  return seconds;
}

// Run time (s) of `program` for one frame.
double firstFrameSeconds(const Options& options, const fs::path& cache) {
  std::vector<std::string> words{options.program, "--log-level",
                                 "error",         "frame",
                                 "--sensor",      TAXELSIM_BENCH "/sensors/wts0614.yaml",
                                 "--object",      TAXELSIM_SCENES "/objects/knob_5k.obj",
                                 "--pose",        "0 0 0 1 0 0 0",
                                 "--load",        "1"};
  if (!options.device.empty()) words.insert(words.end(), {"--device", options.device});
  std::vector<char*> arguments;
  for (std::string& word : words) arguments.push_back(word.data());
  arguments.push_back(nullptr);
  ::setenv("MESA_SHADER_CACHE_DIR", cache.c_str(), 1);
  ::setenv("__GL_SHADER_DISK_CACHE_PATH", cache.c_str(), 1);

  posix_spawn_file_actions_t actions;
  ::posix_spawn_file_actions_init(&actions);
  ::posix_spawn_file_actions_addopen(&actions, STDOUT_FILENO, "/dev/null", O_WRONLY, 0);
  const Stopwatch watch;
  pid_t child = 0;
  int status = -1;
  const int refused = ::posix_spawn(&child, options.program.c_str(), &actions, nullptr, arguments.data(), environ);
  if (!refused) ::waitpid(child, &status, 0);
  const double seconds = watch.seconds();
  ::posix_spawn_file_actions_destroy(&actions);
  if (refused || status != 0) throw Error(ErrorKind::kIo, options.program + ": computed no frame");
  return seconds;
}

// Results of generate() at one compression level.
struct Level {
  int compression = 0;
  std::uint64_t num_bytes = 0;  // size of the data set
  // (repetitions), s of simulation, unless stated otherwise.
  std::vector<double> seconds, end_to_end, fraction_of_device;
  std::vector<double> host_waits_for_device, host_waits_for_writer, device_rests, writing_last;  // fractions of `seconds`
};

std::uint64_t bytesIn(const fs::path& directory) {
  std::uint64_t bytes = 0;
  for (const fs::directory_entry& entry : fs::directory_iterator(directory)) bytes += entry.file_size();
  return bytes;
}

void generateOnce(const Device& device, Scene scene, const fs::path& directory, const GenerateOptions& options, double device_seconds,
                  std::uint64_t num_frames, Level& level) {
  scene.compression = level.compression;
  const Stopwatch watch;
  const GenerateResult result = generate(device, scene, directory, options);
  level.end_to_end.push_back(watch.seconds());
  if (!result.complete || result.progress.frames_done != num_frames) throw Error(ErrorKind::kIo, directory.string() + ": not complete");
  const double seconds = result.progress.seconds;
  level.seconds.push_back(seconds);
  level.fraction_of_device.push_back(device_seconds / seconds);
  level.host_waits_for_device.push_back(result.times.device_wait / seconds);
  level.host_waits_for_writer.push_back(result.times.writer_wait / seconds);
  level.device_rests.push_back(1 - result.times.device_busy / seconds);
  level.writing_last.push_back(result.times.writing_last / seconds);
  level.num_bytes = bytesIn(directory);
  fs::remove_all(directory);
}

nlohmann::ordered_json levelJson(const Level& level, double num_frames) {
  return {{"compression", level.compression},
          {"bytes_per_frame", static_cast<double>(level.num_bytes) / num_frames},
          {"seconds", toJson(level.seconds)},
          {"seconds_end_to_end", toJson(level.end_to_end)},
          {"frames_per_second", num_frames / summarise(level.seconds).median},
          {"fraction_of_device", toJson(level.fraction_of_device)},
          {"host_waits_for_device", toJson(level.host_waits_for_device)},
          {"host_waits_for_writer", toJson(level.host_waits_for_writer)},
          {"device_rests", toJson(level.device_rests)},
          {"writing_last", toJson(level.writing_last)}};
}

void print(const Level& level, double num_frames) {
  std::printf("  generate, compression %d   %9.1f thousand frames/s, %.0f %% of the device's (%.1f end to end), %.0f bytes a frame\n",
              level.compression, num_frames / summarise(level.seconds).median / 1e3, 100 * summarise(level.fraction_of_device).median,
              num_frames / summarise(level.end_to_end).median / 1e3, static_cast<double>(level.num_bytes) / num_frames);
  std::printf(
      "    of the time: host waits for device %.1f %%, for writer %.1f %%; device idle %.1f %%, of that while the last shards are "
      "written %.1f %%\n",
      100 * summarise(level.host_waits_for_device).median, 100 * summarise(level.host_waits_for_writer).median,
      100 * summarise(level.device_rests).median, 100 * summarise(level.writing_last).median);
}

int run(const Options& options) {
  const ScratchDirectory scratch(options.directory);
  std::vector<double> cold, warm;
  for (int r = 0; r < options.repetitions; ++r) {
    const fs::path cache = scratch.path() / ("cache_" + std::to_string(r));
    fs::create_directory(cache);
    cold.push_back(firstFrameSeconds(options, cache));
    warm.push_back(firstFrameSeconds(options, cache));
  }

  const Device device = Device::open({.device = options.device});
  const Scene scene = loadScene(options.scene, {.num_episodes = options.num_episodes, .seed = {}});
  ModelOptions model_options{.sensor = scene.sensor};
  for (const SceneObject& entry : scene.objects) model_options.objects.push_back(entry.object);
  const Model model(device, model_options);

  Scene with_poses = scene;
  with_poses.record.push_back("poses");
  GenerateOptions generate_options;
  generate_options.batch_size = options.batch_size;
  generate_options.num_slices = options.num_slices;
  generate_options.device_clock = true;
  generate(device, with_poses, scratch.path() / "poses", generate_options);
  const Replay replay = replayOf(scratch.path() / "poses", scene);
  fs::remove_all(scratch.path() / "poses");
  const auto num_frames = static_cast<double>(replay.X_SO.size());

  std::vector<double> on_device;
  std::vector<Level> levels;
  for (const int compression : options.compression) levels.emplace_back().compression = compression;
  for (int r = 0; r < options.repetitions; ++r) {
    on_device.push_back(deviceSeconds(model, scene, replay, std::max(1, options.batch_size / generate_options.num_slices)));
    for (Level& level : levels) {
      const fs::path directory = scratch.path() / ("run_" + std::to_string(r));
      generateOnce(device, scene, directory, generate_options, on_device.back(), replay.X_SO.size(), level);
    }
  }

  std::printf("%s, %s; %s, %.0f frames, batch of %d\n", device.info().name.c_str(), device.info().driver.c_str(), scene.name.c_str(),
              num_frames, options.batch_size);
  const double device_rate = num_frames / summarise(on_device).median;
  std::printf("  device alone              %9.1f thousand frames/s\n", device_rate / 1e3);
  for (const Level& level : levels) print(level, num_frames);
  std::printf("  first frame of a process  %9.3f s, cold shader cache; %.3f s with a warm one\n", summarise(cold).median,
              summarise(warm).median);
  if (!options.json.empty()) {
    nlohmann::ordered_json generated = nlohmann::ordered_json::array();
    for (const Level& level : levels) generated.push_back(levelJson(level, num_frames));
    writeJson(options.json, {{"bench", "generate_rate"},
                             {"machine", machine(device.info())},
                             {"scene", scene.name},
                             {"num_episodes", scene.num_episodes},
                             {"num_frames", replay.X_SO.size()},
                             {"batch_size", options.batch_size},
                             {"seconds_device", toJson(on_device)},
                             {"frames_per_second_device", device_rate},
                             {"generate", generated},
                             {"first_frame_seconds_cold", toJson(cold)},
                             {"first_frame_seconds_warm", toJson(warm)}});
  }
  return 0;
}

}  // namespace
}  // namespace taxelsim::bench

int main(int argc, char** argv) {
  taxelsim::bench::Options options;
  CLI::App app("Throughput of `generate` relative to the device alone, and the time to the first frame of a new process");
  app.add_option("scene", options.scene, "Scene")->capture_default_str();
  app.add_option("--json", options.json, "Write the results to this JSON file");
  app.add_option("--episodes", options.num_episodes, "Episodes of a run; default: those of the scene")->check(CLI::Range(1, 1 << 20));
  app.add_option("--compression", options.compression, "Compression levels, separated by commas; one run each")
      ->delimiter(',')
      ->check(CLI::Range(0, 9))
      ->capture_default_str();
  app.add_option("--batch-size", options.batch_size, "Instances over all slices")->check(CLI::Range(1, 1 << 20))->capture_default_str();
  app.add_option("--slices", options.num_slices, "Slices of the batch in flight at once")
      ->check(CLI::Range(1, 1024))
      ->capture_default_str();
  app.add_option("--repetitions", options.repetitions, "Timed repetitions")->check(CLI::Range(1, 1000))->capture_default_str();
  app.add_option("--directory", options.directory, "Folder for temporary data sets")->capture_default_str();
  app.add_option("--program", options.program, "The program taxelsim, for the first frame")->capture_default_str();
  app.add_option("--device", options.device, "Device, as for `taxelsim generate --device`");
  CLI11_PARSE(app, argc, argv);
  return taxelsim::bench::exitStatus([&] { return taxelsim::bench::run(options); });
}
