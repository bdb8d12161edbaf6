// Evaluations in parts: plays a range of episodes, and puts ranges together.
#include <algorithm>
#include <span>

#include "dataset/scene_difference.h"
#include "episodes/batch.h"
#include "evaluation/misses.h"
#include "evaluation/part_text.h"
#include "evaluation/play.h"
#include "evaluation/probe.h"
#include "evaluation/scores.h"
#include "taxelsim/dataset.h"
#include "taxelsim/error.h"
#include "taxelsim/version.h"

namespace taxelsim {
namespace {

std::string namesOf(const EvaluationPart& part) {
  std::string names;
  for (const EvaluationPart::Verdicts& evaluation : part.evaluations) names += (names.empty() ? "" : ", ") + evaluation.controller;
  return names.empty() ? "none" : names;
}

// Throws unless the values are equal.
void requireSame(const std::string& name, const std::string& what, const std::string& there, const std::string& expected) {
  if (there == expected) return;
  throw Error(ErrorKind::kInput, name + ": has another " + what + " (" + there + " there, " + expected + " expected)");
}

// "1000..1999"
std::string rangeText(std::uint64_t first, std::uint64_t end) {
  return first + 1 == end ? std::to_string(first) : std::to_string(first) + ".." + std::to_string(end - 1);
}

void requireAll(const std::vector<bool>& found) {
  const auto first = std::find(found.begin(), found.end(), false);
  if (first == found.end()) return;
  const auto end = std::find(first, found.end(), true);
  throw Error(ErrorKind::kInput,
              "episodes " + rangeText(static_cast<std::uint64_t>(first - found.begin()), static_cast<std::uint64_t>(end - found.begin())) +
                  " are missing in the parts of the evaluation; " + std::to_string(std::count(found.begin(), found.end(), false)) + " of " +
                  std::to_string(found.size()) + " are missing in all");
}

}  // namespace

EpisodeRange partOfEpisodes(std::uint64_t num_episodes, std::uint64_t part, std::uint64_t num_parts) {
  const ShardRange range = partOfShards(num_episodes, part, num_parts);
  return {range.first, range.end};
}

EvaluationPart evaluatePart(const Device& device, const Scene& scene, const std::vector<std::string>& controllers,
                            const EvaluateOptions& options) {
  const Players players(scene, controllers, options);
  const Model model(device, modelOptionsOf(scene));
  EvaluationPart part{.program_version = kVersion,
                      .device = deviceText(device.info()),
                      .probe_sha256 = featureProbe(model, scene),
                      .scene = scene.resolved,
                      .condition = scene.condition,
                      .seed = scene.seed,
                      .num_episodes = scene.num_episodes,
                      .policy = options.policy ? options.policy->id : "",
                      .episodes = players.episodes,
                      .evaluations = {}};
  play(model, scene, players, options, [&](EvaluationPart::Verdicts played) { part.evaluations.push_back(std::move(played)); });
  return part;
}

void checkEvaluationPart(const NamedPart& named, const Scene& scene) {
  const auto& [name, part] = named;
  requireSame(name, "program version", part.program_version, kVersion);
  requireSame(name, "condition", part.condition, scene.condition);
  requireSame(name, "seed", std::to_string(part.seed), std::to_string(scene.seed));
  requireSame(name, "number of episodes", std::to_string(part.num_episodes), std::to_string(scene.num_episodes));
  if (part.scene != scene.resolved)
    throw Error(ErrorKind::kInput, name + ": is of another scene: " + dataset::describeSceneDifference(part.scene, scene.resolved));
}

std::vector<Evaluation> mergeEvaluationParts(const Scene& scene, const std::vector<NamedPart>& parts) {
  if (parts.empty()) throw Error(ErrorKind::kInput, "no parts of an evaluation found, at least 1 needed");
  const EvaluationPart& model = parts.front().part;
  std::vector<std::vector<Verdict>> verdicts(model.evaluations.size(), std::vector<Verdict>(scene.num_episodes));
  std::vector<bool> found(scene.num_episodes);
  for (const NamedPart& named : parts) {
    const auto& [name, part] = named;
    checkEvaluationPart(named, scene);
    requireSame(name, "device", part.device, model.device);
    requireSame(name, "probe (probe_sha256), although the devices have one name", part.probe_sha256, model.probe_sha256);
    requireSame(name, "policy", part.policy.empty() ? "none" : part.policy, model.policy.empty() ? "none" : model.policy);
    requireSame(name, "set of controllers", namesOf(part), namesOf(model));
    for (std::uint64_t episode = part.episodes.first; episode < part.episodes.end; ++episode) {
      for (std::size_t c = 0; c < verdicts.size(); ++c) {
        const Verdict& verdict = part.evaluations[c].verdicts[episode - part.episodes.first];
        if (verdict.object < 0 || static_cast<std::size_t>(verdict.object) >= scene.objects.size())
          throw Error(ErrorKind::kInput, name + ": object " + std::to_string(verdict.object) + " is not allowed: the scene has 0 to " +
                                             std::to_string(scene.objects.size() - 1));
        if (found[episode] && digitsOf(std::span(&verdict, 1)) != digitsOf(std::span(&verdicts[c][episode], 1)))
          throw Error(ErrorKind::kInput, name + ": episode " + std::to_string(episode) + " differs from the one in another part");
        verdicts[c][episode] = verdict;
      }
      found[episode] = true;
    }
  }
  requireAll(found);
  std::vector<Evaluation> evaluations;
  for (std::size_t c = 0; c < verdicts.size(); ++c) {
    evaluations.push_back(evaluationOf(scene, model.evaluations[c].controller, std::move(verdicts[c])));
  }
  warnOfContactMisses(scene, evaluations);
  return evaluations;
}

}  // namespace taxelsim
