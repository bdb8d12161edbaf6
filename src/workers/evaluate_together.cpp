#include "workers/evaluate_together.h"

#include <spdlog/spdlog.h>

#include <algorithm>
#include <chrono>
#include <exception>
#include <utility>

#include "episodes/batch.h"
#include "evaluation/play.h"
#include "taxelsim/error.h"
#include "workers/worker.h"
#include "workers/worker_count.h"
#include "workers/worker_processes.h"

namespace taxelsim::workers {
namespace {

EpisodeRange allOf(const Scene& scene, const EvaluateOptions& options) {
  return options.episodes.value_or(EpisodeRange{.first = 0, .end = scene.num_episodes});
}

// The range of process `number` (from 1).
EpisodeRange rangeOf(const EpisodeRange& all, int number, int num_processes) {
  const EpisodeRange part = partOfEpisodes(all.size(), static_cast<std::uint64_t>(number), static_cast<std::uint64_t>(num_processes));
  return {.first = all.first + part.first, .end = all.first + part.end};
}

// Whether the worker read the same scene: its file may have changed since.
bool isOf(const Scene& scene, const WorkerReport& report) {
  const auto found = std::find_if(report.messages.begin(), report.messages.end(),
                                  [](const Message& message) { return message.kind == MessageKind::kScene; });
  return found != report.messages.end() && found->text() == scene.resolved;
}

// One array of verdicts for each controller that is complete.
using VerdictsOfControllers = std::vector<std::vector<Verdict>>;

VerdictsOfControllers verdictsIn(const WorkerReport& report) {
  VerdictsOfControllers verdicts;
  for (const Message& message : report.messages)
    if (message.kind == MessageKind::kVerdicts) verdicts.push_back(message.values<Verdict>());
  return verdicts;
}

// Appends the next episodes; controllers that were not complete in both are left out.
void append(EvaluationPart& part, const VerdictsOfControllers& next) {
  part.evaluations.resize(std::min(part.evaluations.size(), next.size()));
  for (std::size_t c = 0; c < part.evaluations.size(); ++c) {
    std::vector<Verdict>& verdicts = part.evaluations[c].verdicts;
    verdicts.insert(verdicts.end(), next[c].begin(), next[c].end());
  }
}

// Progress of all processes; this one may play several ranges one after the other.
class SharedProgress {
 public:
  SharedProgress(const EpisodeRange& all, const WorkerProcesses& workers, std::function<void(const Progress&)> on_progress)
      : all_(all), workers_(workers), on_progress_(std::move(on_progress)) {}

  // The next range of this process.
  void begin(const EpisodeRange& range) {
    range_ = range;
    before_.episodes_done += own_.episodes_done;
    before_.frames_done += own_.frames_done;
    own_ = {};
  }

  void update(const Progress& own) {
    own_ = own;
    show();
  }

  void show() const {
    if (!on_progress_ || own_.num_episodes == 0) return;
    const Progress others = workers_.progress();
    Progress sum;
    sum.num_episodes = own_.num_episodes / range_.size() * all_.size();
    sum.num_frames = own_.num_frames / range_.size() * all_.size();
    sum.episodes_done = before_.episodes_done + own_.episodes_done + others.episodes_done;
    sum.frames_done = before_.frames_done + own_.frames_done + others.frames_done;
    sum.seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start_).count();
    on_progress_(sum);
  }

 private:
  const EpisodeRange all_;
  const WorkerProcesses& workers_;
  const std::function<void(const Progress&)> on_progress_;
  const std::chrono::steady_clock::time_point start_ = std::chrono::steady_clock::now();
  EpisodeRange range_;
  Progress before_, own_;
};

// The controllers that are complete, and why there are no more of them if the device was lost.
struct Played {
  EvaluationPart part;
  std::exception_ptr failure;
};

Played playTogether(const Device& device, const Scene& scene, const std::vector<std::string>& controllers, EvaluateOptions options,
                    int num_processes) {
  const EpisodeRange all = allOf(scene, options);
  const int batch_size = std::exchange(options.batch_size, batchShare(options.batch_size, num_processes));
  // Everything that can be refused is checked before the workers start, and what they compile is in the driver's cache.
  Players players(scene, controllers, options);
  const Model model(device, modelOptionsOf(scene));
  const std::uint64_t team_size = std::min<std::uint64_t>(static_cast<std::uint64_t>(batch_size), all.size());
  splitBatch(model, SlicePlan(scene, kNoOutputs, players.controllers.front()), static_cast<int>(team_size), options.num_slices);
  Played played{.part = partWithoutVerdicts(device, model, scene, players, options), .failure = {}};
  WorkerProcesses workers("its episodes are played again");
  SharedProgress progress(all, workers, std::exchange(options.on_progress, {}));
  options.on_progress = [&](const Progress& own) { progress.update(own); };
  const auto playRange = [&](int number, const std::function<void(EvaluationPart::Verdicts)>& on_complete) {
    players.episodes = rangeOf(all, number, num_processes);
    progress.begin(players.episodes);
    try {
      play(model, scene, players, options, on_complete);
    } catch (const Error& error) {
      if (error.kind() != ErrorKind::kDevice) throw;
      played.failure = std::current_exception();
    }
  };
  workers.start(num_processes);
  playRange(1, [&](EvaluationPart::Verdicts own) { played.part.evaluations.push_back(std::move(own)); });
  const std::atomic<bool> at_once{true};
  workers.join(played.failure ? &at_once : options.stop, [&] { progress.show(); });
  options.batch_size = batch_size;
  for (int number = 2; number <= num_processes; ++number) {
    const WorkerReport& report = workers.reports()[static_cast<std::size_t>(number - 2)];
    const bool has_played = report.problem.empty() && isOf(scene, report);
    if (report.problem.empty() && !has_played)
      spdlog::warn("worker {} of {}: its scene differs: a file has changed; its episodes are played again", number, num_processes);
    VerdictsOfControllers verdicts;
    if (has_played)
      verdicts = verdictsIn(report);
    else if (!played.failure)
      playRange(number, [&](EvaluationPart::Verdicts again) { verdicts.push_back(std::move(again.verdicts)); });
    append(played.part, verdicts);
  }
  return played;
}

}  // namespace

std::vector<Evaluation> evaluateTogether(const Device& device, const Scene& scene, const std::vector<std::string>& controllers,
                                         const EvaluateOptions& options, int num_processes) {
  Played played = playTogether(device, scene, controllers, options, num_processes);
  std::vector<NamedPart> parts(1);
  parts[0] = {.name = "this evaluation", .part = std::move(played.part)};
  const std::vector<Evaluation> evaluations = mergeEvaluationParts(scene, parts);
  for (const Evaluation& evaluation : evaluations)
    if (options.on_evaluation) options.on_evaluation(evaluation);
  if (played.failure) std::rethrow_exception(played.failure);
  return evaluations;
}

EvaluationPart evaluatePartTogether(const Device& device, const Scene& scene, const std::vector<std::string>& controllers,
                                    const EvaluateOptions& options, int num_processes) {
  Played played = playTogether(device, scene, controllers, options, num_processes);
  if (played.failure) std::rethrow_exception(played.failure);
  return std::move(played.part);
}

int evaluateAsWorker(const Device& device, const Scene& scene, const std::vector<std::string>& controllers, EvaluateOptions options,
                     int number, int num_processes) {
  return runWorker([&](const Worker& worker) {
    options.batch_size = batchShare(options.batch_size, num_processes);
    options.episodes = rangeOf(allOf(scene, options), number, num_processes);
    options.stop = worker.stop();
    options.on_progress = [&](const Progress& progress) { worker.report(progress); };
    worker.sendValues(MessageKind::kScene, std::span<const char>(scene.resolved));
    const Players players(scene, controllers, options);
    play(Model(device, modelOptionsOf(scene)), scene, players, options, [&](const EvaluationPart::Verdicts& played) {
      worker.sendValues(MessageKind::kVerdicts, std::span<const Verdict>(played.verdicts));
    });
  });
}

}  // namespace taxelsim::workers
