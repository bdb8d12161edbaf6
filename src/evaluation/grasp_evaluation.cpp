#include "taxelsim/grasp_evaluation.h"

#include <algorithm>
#include <chrono>
#include <cmath>

#include "base/field_checks.h"
#include "episodes/batch.h"
#include "episodes/contact_misses.h"
#include "episodes/grasp_batch.h"
#include "episodes/grasp_judge.h"
#include "episodes/grasp_player.h"
#include "episodes/policy_controller.h"
#include "evaluation/play.h"
#include "evaluation/scores.h"
#include "scene/scene_checks.h"
#include "taxelsim/error.h"

namespace taxelsim {
namespace {

using SteadyClock = std::chrono::steady_clock;

// Counts for on_progress, over all gains.
struct Count {
  const GraspEvaluateOptions& options;
  Progress progress{};
  SteadyClock::time_point start = SteadyClock::now();

  bool isStopped() const { return options.stop != nullptr && *options.stop; }
  void add(std::uint64_t num_frames, std::uint64_t num_episodes) {
    progress.frames_done += num_frames;
    progress.episodes_done += num_episodes;
    progress.seconds = std::chrono::duration<double>(SteadyClock::now() - start).count();
    if (options.on_progress) options.on_progress(progress);
  }
};

// Plays the episodes first, ..., first + count - 1. Fewer verdicts than episodes after a stop.
std::vector<GraspVerdict> playBatch(GraspBatch& batch, GraspPlayer& player, const Scene& scene, std::uint64_t first, int count,
                                    Count& tally) {
  const std::size_t num_fingers = scene.grasp->fingers.size();
  batch.begin(first, count);
  std::vector<GraspJudge> judges;
  for (int i = 0; i < count; ++i) {
    judges.emplace_back(scene.grasp->task, scene.num_steps, 1 / scene.simulation_rate, first + static_cast<std::uint64_t>(i),
                        batch.targetForces().subspan(static_cast<std::size_t>(i) * num_fingers, num_fingers));
  }
  for (int frame = 0; frame < scene.num_steps; ++frame) {
    if (tally.isStopped()) return {};
    player.step(batch, count);
    for (int i = 0; i < count; ++i) judges[static_cast<std::size_t>(i)].frame(touchesOf(batch, *scene.grasp, i));
    tally.add(static_cast<std::uint64_t>(count), frame + 1 == scene.num_steps ? static_cast<std::uint64_t>(count) : 0);
  }
  std::vector<GraspVerdict> verdicts;
  for (const GraspJudge& judge : judges) verdicts.push_back(judge.verdict());
  return verdicts;
}

// Plays all episodes with the gain of the scene, or with the policy. None after a stop.
std::optional<GraspEvaluation> played(const Device& device, const Scene& scene, const std::optional<Policy>& policy,
                                      const EpisodeRange& episodes, int batch_size, Count& tally) {
  const int size = static_cast<int>(std::min<std::uint64_t>(static_cast<std::uint64_t>(batch_size), episodes.size()));
  GraspPlayer player(scene, policy);
  GraspBatch batch(device, scene, player.outputs(kNoOutputs), size, player.joints());
  std::vector<GraspVerdict> verdicts;
  std::vector<ContactMisses> misses(scene.grasp->fingers.size());
  while (verdicts.size() < episodes.size()) {
    const std::uint64_t left = episodes.size() - verdicts.size();
    const int count = static_cast<int>(std::min<std::uint64_t>(static_cast<std::uint64_t>(size), left));
    std::vector<GraspVerdict> more = playBatch(batch, player, scene, episodes.first + verdicts.size(), count, tally);
    if (more.empty()) return {};
    batch.addMisses(count, misses);
    std::move(more.begin(), more.end(), std::back_inserter(verdicts));
  }
  GraspEvaluation evaluation = graspEvaluationOf(scene, policy ? 0 : scene.grasp->gain, std::move(verdicts), std::move(misses));
  if (policy) evaluation.policy = policy->name;
  return evaluation;
}

// NaN if a value is NaN: the largest of an episode is unknown then.
double largest(const std::vector<FingerVerdict>& fingers, double FingerVerdict::*member) {
  double most = 0;
  for (const FingerVerdict& finger : fingers) {
    if (std::isnan(finger.*member)) return finger.*member;
    most = std::max(most, finger.*member);
  }
  return most;
}

FingerVerdict worstOf(const GraspVerdict& verdict) {
  FingerVerdict worst{.held = verdict.success,
                      .force_error = largest(verdict.fingers, &FingerVerdict::force_error),
                      .settling_time = largest(verdict.fingers, &FingerVerdict::settling_time),
                      .peak_force = largest(verdict.fingers, &FingerVerdict::peak_force),
                      .drift = largest(verdict.fingers, &FingerVerdict::drift)};
  for (const FingerVerdict& finger : verdict.fingers) worst.num_losses += finger.num_losses;
  return worst;
}

FingerScore scoreOf(const std::string& name, const std::vector<FingerVerdict>& verdicts) {
  FingerScore score;
  score.name = name;
  score.num_episodes = verdicts.size();
  for (const FingerVerdict& verdict : verdicts) {
    score.num_held += verdict.held ? 1 : 0;
    score.num_lost += verdict.num_losses > 0 ? 1 : 0;
  }
  const auto quantiles = [&](double FingerVerdict::*member) {
    std::vector<double> values;
    for (const FingerVerdict& verdict : verdicts) values.push_back(verdict.*member);
    return quantilesOf(std::move(values));
  };
  score.force_error = quantiles(&FingerVerdict::force_error);
  score.settling_time = quantiles(&FingerVerdict::settling_time);
  score.peak_force = quantiles(&FingerVerdict::peak_force);
  score.drift = quantiles(&FingerVerdict::drift);
  if (score.num_episodes == 0) return score;
  score.held_rate = static_cast<double>(score.num_held) / static_cast<double>(score.num_episodes);
  const auto [low, high] = wilsonInterval(score.num_held, score.num_episodes);
  score.held_low = low;
  score.held_high = high;
  return score;
}

void checkGrasp(const Scene& scene, const std::vector<double>& gains, const GraspEvaluateOptions& options) {
  checkCount("batch size", options.batch_size);
  checkScene(scene);
  if (!scene.grasp) throw Error(ErrorKind::kInput, scene.file.generic_string() + ": not a scene of kind grasp");
  checkBelow("task", [&] { checkGraspTask(scene.grasp->task, scene.num_steps / scene.simulation_rate); });
  checkEpisodesOfEvaluation(scene.num_episodes);
  if (options.policy) checkPolicy(*options.policy, scene);
  for (const double gain : gains) checkNumber("gain", gain, Allowed::aboveUpTo(0, scene.simulation_rate, "1/s"));
}

}  // namespace

GraspEvaluation graspEvaluationOf(const Scene& scene, double gain, std::vector<GraspVerdict> verdicts, std::vector<ContactMisses> misses) {
  const Grasp& grasp = *scene.grasp;
  GraspEvaluation evaluation{
      .gain = gain, .policy = {}, .verdicts = std::move(verdicts), .total = {}, .fingers = {}, .misses = std::move(misses)};
  std::vector<FingerVerdict> worst;
  for (const GraspVerdict& verdict : evaluation.verdicts) worst.push_back(worstOf(verdict));
  evaluation.total = scoreOf("all fingers", worst);
  for (std::size_t f = 0; f < grasp.fingers.size(); ++f) {
    std::vector<FingerVerdict> of_finger;
    for (const GraspVerdict& verdict : evaluation.verdicts) of_finger.push_back(verdict.fingers[f]);
    evaluation.fingers.push_back(scoreOf(grasp.sensors[static_cast<std::size_t>(grasp.fingers[f].sensor)].name, of_finger));
  }
  return evaluation;
}

std::vector<GraspEvaluation> evaluateGrasp(const Device& device, const Scene& scene, const std::vector<double>& gains,
                                           const GraspEvaluateOptions& options) {
  checkGrasp(scene, gains, options);
  std::vector<double> all = gains;
  if (gains.empty() && !options.policy) all = {scene.grasp->gain};
  const EpisodeRange episodes = chosenEpisodes(scene, options.episodes);
  const std::size_t num_evaluations = all.size() + (options.policy ? 1 : 0);
  Count tally{.options = options};
  tally.progress.num_episodes = episodes.size() * num_evaluations;
  tally.progress.num_frames = tally.progress.num_episodes * static_cast<std::uint64_t>(scene.num_steps);
  std::vector<GraspEvaluation> evaluations;
  std::vector<ContactMisses> all_misses(scene.grasp->fingers.size());  // over all gains
  // The policy is the first, so that its exceptions lose no complete evaluation.
  while (evaluations.size() < num_evaluations) {
    const bool by_policy = options.policy && evaluations.empty();
    Scene copy = scene;
    if (!by_policy) copy.grasp->gain = all[evaluations.size() - (options.policy ? 1 : 0)];
    std::optional<GraspEvaluation> evaluation =
        played(device, copy, by_policy ? options.policy : std::nullopt, episodes, options.batch_size, tally);
    if (!evaluation) return evaluations;
    for (std::size_t f = 0; f < all_misses.size() && !by_policy; ++f) add(all_misses[f], evaluation->misses[f]);
    evaluations.push_back(*std::move(evaluation));
    if (options.on_evaluation) options.on_evaluation(evaluations.back());
  }
  if (!options.episodes) warnOfContactMisses(scene, all_misses);
  return evaluations;
}

}  // namespace taxelsim
