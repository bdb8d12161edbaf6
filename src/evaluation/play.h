// Plays a range of the episodes of a scene with a policy and controllers.
#pragma once

#include <string>
#include <vector>

#include "taxelsim/evaluation_part.h"
#include "taxelsim/model.h"

namespace taxelsim {

// Outputs beyond the features, which an evaluation does not need.
inline constexpr OutputOptions kNoOutputs{.tactile_normal_force = false, .tactile_shear_force = false, .penetration_depth = false};

// Names and numbers of the controllers, checked against the scene. Throws what evaluate() throws for them, the scene and the options.
struct Players {
  Players(const Scene& scene, const std::vector<std::string>& controllers, const EvaluateOptions& options);

  std::vector<int> controllers;  // indices into the controllers of the scene
  EpisodeRange episodes;
};

// Verdicts of the policy of the options, if any, then of the controllers; of the complete ones only after a stop. `model`: of the scene.
std::vector<EvaluationPart::Verdicts> play(const Model& model, const Scene& scene, const Players& players, const EvaluateOptions& options);

}  // namespace taxelsim
