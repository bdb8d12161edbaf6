/// @file
/// An evaluation in parts: each process or machine plays a range of the episodes of a scene, and the parts together give the same
/// evaluations as one process.
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include "taxelsim/contact_misses.h"
#include "taxelsim/device.h"
#include "taxelsim/evaluate.h"
#include "taxelsim/grasp_evaluation.h"
#include "taxelsim/scene.h"
#include "taxelsim/verdict.h"

namespace taxelsim {

/// Part `part` (1 to `num_parts`) of `num_episodes` episodes; the parts differ by at most one episode. Empty for some parts if there are
/// more parts than episodes.
EpisodeRange partOfEpisodes(std::uint64_t num_episodes, std::uint64_t part, std::uint64_t num_parts);

/// Verdicts of a range of the episodes of a scene, with everything that determines them.
struct EvaluationPart {
  /// Verdicts of one controller, gain or policy.
  struct Verdicts {
    std::string controller;                  ///< Name in the scene, gainName(), or Policy::name.
    std::vector<Verdict> verdicts;           ///< (number of episodes of the part), in order of episodes; empty for a scene of kind grasp.
    std::vector<GraspVerdict> grasps = {};   ///< The same of a scene of kind grasp.
    std::vector<ContactMisses> misses = {};  ///< (num_fingers) of a scene of kind grasp: GraspEvaluation::misses.
  };

  std::string program_version;  ///< Version of taxelsim that played the episodes.
  std::string device;           ///< Name and driver of the device.
  /// SHA-256 of the features in a few first frames: devices of equal names can compute different values (docs/understand/determinism.md).
  std::string probe_sha256;
  std::string scene;                  ///< Scene::resolved.
  std::string condition;              ///< Scene::condition.
  std::uint64_t seed = 0;             ///< Scene::seed.
  std::uint64_t num_episodes = 0;     ///< Scene::num_episodes, of the whole evaluation.
  std::string policy;                 ///< Policy::id, empty without a policy or for one without an id.
  EpisodeRange episodes;              ///< The episodes of this part; not empty.
  std::vector<Verdicts> evaluations;  ///< By controller, the policy first.
};

/// Plays the episodes EvaluateOptions::episodes (default: all) as evaluate() does; throws what evaluate() throws. After a stop the part
/// has the controllers that are complete only.
EvaluationPart evaluatePart(const Device& device, const Scene& scene, const std::vector<std::string>& controllers = {},
                            const EvaluateOptions& options = {});

/// The same for a scene of kind grasp, as evaluateGrasp() does.
EvaluationPart evaluateGraspPart(const Device& device, const Scene& scene, const std::vector<double>& gains = {},
                                 const GraspEvaluateOptions& options = {});

/// Name of a gain (1/s) in a part: "gain 10".
std::string gainName(double gain);

/// The part as JSON text with a SHA-256 of its content (docs/reference/other_files.md). The same part gives the same text.
std::string evaluationPartText(const EvaluationPart& part);

/// The part of such a text. `name`: of the file or the like, for messages. Throws Error(kInput) for other, damaged and altered text.
EvaluationPart parseEvaluationPart(const std::string& text, const std::string& name);

/// Writes the text of the part to a file, which never has half of it. Throws Error(kIo).
void writeEvaluationPart(const std::filesystem::path& file, const EvaluationPart& part);

/// Reads a part from a file. Throws what parseEvaluationPart() throws, and Error(kIo).
EvaluationPart readEvaluationPart(const std::filesystem::path& file);

/// A part and its name in messages.
struct NamedPart {
  std::string name;     ///< Name of its file or the like.
  EvaluationPart part;  ///< The part.
};

/// The evaluations of evaluate() from parts in any order, bit for bit. Parts may overlap.
///
/// Throws Error(kInput), which names the part, if one is of another scene, condition, seed, number of episodes, program version, device,
/// probe, policy or set of controllers than `scene` and the first part, if overlapping parts differ, or if episodes are missing.
std::vector<Evaluation> mergeEvaluationParts(const Scene& scene, const std::vector<NamedPart>& parts);

/// The same of evaluateGrasp() and evaluateGraspPart(); parts that overlap count their misses twice. Logs a warning of them.
std::vector<GraspEvaluation> mergeGraspParts(const Scene& scene, const std::vector<NamedPart>& parts);

/// Throws Error(kInput), which names the part, unless it is of this scene, condition, seed and number of episodes and of this program
/// version.
void checkEvaluationPart(const NamedPart& part, const Scene& scene);

}  // namespace taxelsim
