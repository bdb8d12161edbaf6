// Evaluations in parts: plays a range of episodes, and puts ranges together.
#include <algorithm>
#include <charconv>
#include <optional>
#include <span>
#include <string_view>

#include "dataset/scene_difference.h"
#include "episodes/batch.h"
#include "episodes/contact_misses.h"
#include "evaluation/misses.h"
#include "evaluation/part_text.h"
#include "evaluation/play.h"
#include "evaluation/probe.h"
#include "evaluation/scores.h"
#include "scene/canonical.h"
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

// The part of these episodes, without evaluations.
EvaluationPart partOf(const Device& device, const Scene& scene, const std::string& probe, const std::optional<Policy>& policy,
                      const EpisodeRange& episodes) {
  return {.program_version = kVersion,
          .device = deviceText(device.info()),
          .probe_sha256 = probe,
          .scene = scene.resolved,
          .condition = scene.condition,
          .seed = scene.seed,
          .num_episodes = scene.num_episodes,
          .policy = policy ? policy->id : "",
          .episodes = episodes,
          .evaluations = {}};
}

// Verdicts of all episodes, by controller. check(name, verdict): throws Error(kInput) for a verdict of a part that the scene cannot have.
template <typename AnyVerdict, typename Check>
std::vector<std::vector<AnyVerdict>> merged(const Scene& scene, const std::vector<NamedPart>& parts,
                                            std::vector<AnyVerdict> EvaluationPart::Verdicts::*member, Check check) {
  if (parts.empty()) throw Error(ErrorKind::kInput, "no parts of an evaluation found, at least 1 needed");
  const EvaluationPart& model = parts.front().part;
  std::vector<std::vector<AnyVerdict>> verdicts(model.evaluations.size(), std::vector<AnyVerdict>(scene.num_episodes));
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
        const std::vector<AnyVerdict>& of_part = part.evaluations[c].*member;
        if (of_part.size() != part.episodes.size()) throw Error(ErrorKind::kInput, name + ": has verdicts of another kind of scene");
        const AnyVerdict& verdict = of_part[episode - part.episodes.first];
        check(name, verdict);
        if (found[episode] && digitsOf(std::span(&verdict, 1)) != digitsOf(std::span(&verdicts[c][episode], 1)))
          throw Error(ErrorKind::kInput, name + ": episode " + std::to_string(episode) + " differs from the one in another part");
        verdicts[c][episode] = verdict;
      }
      found[episode] = true;
    }
  }
  requireAll(found);
  return verdicts;
}

constexpr std::string_view kGain = "gain ";

// The gain of such a name; empty for the name of a policy.
std::optional<double> gainOf(std::string_view name) {
  double gain = 0;
  if (!name.starts_with(kGain)) return {};
  const char* const end = name.data() + name.size();
  const auto [last, error] = std::from_chars(name.data() + kGain.size(), end, gain);
  return error == std::errc() && last == end ? std::optional(gain) : std::nullopt;
}

}  // namespace

std::string gainName(double gain) {
  return std::string(kGain) + canonicalNumber(gain);
}

EpisodeRange partOfEpisodes(std::uint64_t num_episodes, std::uint64_t part, std::uint64_t num_parts) {
  const ShardRange range = partOfShards(num_episodes, part, num_parts);
  return {range.first, range.end};
}

EvaluationPart evaluatePart(const Device& device, const Scene& scene, const std::vector<std::string>& controllers,
                            const EvaluateOptions& options) {
  const Players players(scene, controllers, options);
  const Model model(device, modelOptionsOf(scene));
  EvaluationPart part = partOf(device, scene, featureProbe(model, scene), options.policy, players.episodes);
  play(model, scene, players, options, [&](EvaluationPart::Verdicts played) { part.evaluations.push_back(std::move(played)); });
  return part;
}

EvaluationPart evaluateGraspPart(const Device& device, const Scene& scene, const std::vector<double>& gains,
                                 const GraspEvaluateOptions& options) {
  GraspEvaluateOptions own = options;
  own.episodes = chosenEpisodes(scene, options.episodes);
  std::vector<GraspEvaluation> evaluations = evaluateGrasp(device, scene, gains, own);
  EvaluationPart part = partOf(device, scene, graspProbe(device, scene), options.policy, *own.episodes);
  for (GraspEvaluation& evaluation : evaluations) {
    part.evaluations.push_back({.controller = evaluation.policy.empty() ? gainName(evaluation.gain) : evaluation.policy,
                                .verdicts = {},
                                .grasps = std::move(evaluation.verdicts),
                                .misses = std::move(evaluation.misses)});
  }
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
  const auto check = [&](const std::string& name, const Verdict& verdict) {
    if (verdict.object < 0 || static_cast<std::size_t>(verdict.object) >= scene.objects.size())
      throw Error(ErrorKind::kInput, name + ": object " + std::to_string(verdict.object) + " is not allowed: the scene has 0 to " +
                                         std::to_string(scene.objects.size() - 1));
  };
  std::vector<std::vector<Verdict>> verdicts = merged(scene, parts, &EvaluationPart::Verdicts::verdicts, check);
  std::vector<Evaluation> evaluations;
  for (std::size_t c = 0; c < verdicts.size(); ++c) {
    evaluations.push_back(evaluationOf(scene, parts.front().part.evaluations[c].controller, std::move(verdicts[c])));
  }
  warnOfContactMisses(scene, evaluations);
  return evaluations;
}

std::vector<GraspEvaluation> mergeGraspParts(const Scene& scene, const std::vector<NamedPart>& parts) {
  if (!scene.grasp) throw Error(ErrorKind::kInput, scene.file.generic_string() + ": not a scene of kind grasp");
  const std::size_t num_fingers = scene.grasp->fingers.size();
  const auto check = [&](const std::string& name, const GraspVerdict& verdict) {
    if (verdict.fingers.size() != num_fingers)
      throw Error(ErrorKind::kInput, name + ": " + std::to_string(verdict.fingers.size()) + " fingers are not allowed: the scene has " +
                                         std::to_string(num_fingers));
  };
  std::vector<std::vector<GraspVerdict>> verdicts = merged(scene, parts, &EvaluationPart::Verdicts::grasps, check);
  std::vector<GraspEvaluation> evaluations;
  std::vector<ContactMisses> of_gains(num_fingers);
  for (std::size_t c = 0; c < verdicts.size(); ++c) {
    std::vector<ContactMisses> misses(num_fingers);
    for (const NamedPart& named : parts) {
      for (std::size_t f = 0; f < num_fingers; ++f) add(misses[f], named.part.evaluations[c].misses[f]);
    }
    const std::string& name = parts.front().part.evaluations[c].controller;
    const std::optional<double> gain = gainOf(name);
    for (std::size_t f = 0; gain && f < num_fingers; ++f) add(of_gains[f], misses[f]);
    evaluations.push_back(graspEvaluationOf(scene, gain.value_or(0), std::move(verdicts[c]), std::move(misses)));
    if (!gain) evaluations.back().policy = name;
  }
  warnOfContactMisses(scene, of_gains);
  return evaluations;
}

}  // namespace taxelsim
