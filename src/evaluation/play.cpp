#include "evaluation/play.h"

#include <algorithm>
#include <chrono>
#include <memory>

#include "episodes/batch.h"
#include "episodes/task_evaluator.h"
#include "scene/scene_checks.h"
#include "taxelsim/error.h"

namespace taxelsim {
namespace {

constexpr std::uint64_t kMaxEpisodes = std::uint64_t{1} << 24;  // all verdicts are kept in memory

// Indices of the named controllers of the scene, or of all.
std::vector<int> numbersOf(const Scene& scene, const std::vector<std::string>& names, bool all) {
  std::vector<int> numbers;
  std::string known;
  for (const SceneController& controller : scene.controllers) known += (known.empty() ? "" : ", ") + controller.name;
  for (const std::string& name : names) {
    const auto found = std::find_if(scene.controllers.begin(), scene.controllers.end(),
                                    [&](const SceneController& controller) { return controller.name == name; });
    if (found == scene.controllers.end()) {
      throw Error(ErrorKind::kInput, scene.file.generic_string() + ": controller " + name + ": not in this scene; it has " + known);
    }
    numbers.push_back(static_cast<int>(found - scene.controllers.begin()));
  }
  for (int c = 0; all && c < static_cast<int>(scene.controllers.size()); ++c) numbers.push_back(c);
  return numbers;
}

}  // namespace

void checkEpisodesOfEvaluation(std::uint64_t num_episodes) {
  if (num_episodes <= kMaxEpisodes) return;
  throw Error(ErrorKind::kInput, "episodes: " + std::to_string(num_episodes) + " is not allowed: at most " + std::to_string(kMaxEpisodes) +
                                     " in one evaluation");
}

EpisodeRange chosenEpisodes(const Scene& scene, const std::optional<EpisodeRange>& episodes) {
  const EpisodeRange range = episodes.value_or(EpisodeRange{.first = 0, .end = scene.num_episodes});
  if (range.first < range.end && range.end <= scene.num_episodes) return range;
  throw Error(ErrorKind::kInput, "episodes: " + std::to_string(range.first) + ".." +
                                     std::to_string(static_cast<std::int64_t>(range.end) - 1) +
                                     " is not allowed: the scene has episodes 0.." + std::to_string(scene.num_episodes - 1));
}

Players::Players(const Scene& scene, const std::vector<std::string>& names, const EvaluateOptions& options) {
  checkCount("batch size", options.batch_size);
  checkCount("slices", options.num_slices);
  checkScene(scene);
  if (scene.grasp) throw Error(ErrorKind::kInput, scene.file.generic_string() + ": a scene of kind grasp has no controllers to evaluate");
  if (!scene.task) throw Error(ErrorKind::kInput, scene.file.generic_string() + ": this scene has no `task`, which `evaluate` needs");
  checkEpisodesOfEvaluation(scene.num_episodes);
  controllers = numbersOf(scene, names, names.empty() && !options.policy);
  episodes = chosenEpisodes(scene, options.episodes);
}

void play(const Model& model, const Scene& scene, const Players& players, const EvaluateOptions& options,
          const std::function<void(EvaluationPart::Verdicts)>& on_complete) {
  // The policy is the first, so that its exceptions lose no complete evaluation.
  std::vector<SlicePlan> plans;
  std::vector<std::string> names;
  if (options.policy) {
    plans.emplace_back(scene, kNoOutputs, *options.policy);
    names.push_back(options.policy->name);
  }
  for (const int number : players.controllers) {
    plans.emplace_back(scene, kNoOutputs, number);
    names.push_back(scene.controllers[static_cast<std::size_t>(number)].name);
  }
  for (SlicePlan& plan : plans) plan.sink_reads = TaskJudge::kReads;
  const std::uint64_t num_episodes = players.episodes.size();
  const int batch_size = static_cast<int>(std::min<std::uint64_t>(static_cast<std::uint64_t>(options.batch_size), num_episodes));

  Progress progress;
  progress.num_episodes = num_episodes * plans.size();
  progress.num_frames = progress.num_episodes * static_cast<std::uint64_t>(numFrames(scene));
  const auto start = std::chrono::steady_clock::now();
  for (std::size_t p = 0; p < plans.size(); ++p) {
    const SlicePlan& plan = plans[p];
    std::vector<Verdict> verdicts(num_episodes);
    int first_instance = 0;
    std::uint64_t next = 0;
    std::vector<std::unique_ptr<TaskEvaluator>> evaluators;
    std::vector<std::unique_ptr<Slice>> slices;
    for (const int size : splitBatch(model, plan, batch_size, options.num_slices)) {
      evaluators.push_back(std::make_unique<TaskEvaluator>(plan, players.episodes.first, next, verdicts, size));
      slices.push_back(std::make_unique<Slice>(model, plan, size, *evaluators.back(), first_instance));
      first_instance += size;
    }
    runEpisodes(model.device(), slices, options.stop, [&](const Slice::Stats& tally) {
      progress.frames_done += tally.num_frames;
      progress.episodes_done += tally.num_episodes;
      progress.seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
      if (options.on_progress) options.on_progress(progress);
    });
    if (options.stop && *options.stop) break;
    on_complete({.controller = names[p], .verdicts = std::move(verdicts), .grasps = {}, .misses = {}});
  }
}

}  // namespace taxelsim
