// Plays a range of the episodes of a scene with a policy and controllers.
#pragma once

#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "taxelsim/evaluation_part.h"
#include "taxelsim/model.h"

namespace taxelsim {

// Outputs beyond the features, which an evaluation does not need.

// Throws Error(kInput) for more episodes than one evaluation keeps.
void checkEpisodesOfEvaluation(std::uint64_t num_episodes);

// The chosen episodes of the scene; all by default. Throws Error(kInput) unless the scene has them.
EpisodeRange chosenEpisodes(const Scene& scene, const std::optional<EpisodeRange>& episodes);

// Names and numbers of the controllers, checked against the scene. Throws what evaluate() throws for them, the scene and the options.
struct Players {
  Players(const Scene& scene, const std::vector<std::string>& controllers, const EvaluateOptions& options);

  std::vector<int> controllers;  // indices into the controllers of the scene
  EpisodeRange episodes;
};

// Plays the policy of the options, if any, then the controllers. Calls on_complete with the verdicts of each; of the complete ones only
// after a stop. `model`: of the scene.
void play(const Model& model, const Scene& scene, const Players& players, const EvaluateOptions& options,
          const std::function<void(EvaluationPart::Verdicts)>& on_complete);

}  // namespace taxelsim
