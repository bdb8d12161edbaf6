#include "taxelsim/evaluate.h"

#include "episodes/batch.h"
#include "evaluation/play.h"
#include "evaluation/scores.h"

namespace taxelsim {

std::vector<Evaluation> evaluate(const Device& device, const Scene& scene, const std::vector<std::string>& controllers,
                                 const EvaluateOptions& options) {
  const Players players(scene, controllers, options);
  const Model model(device, modelOptionsOf(scene));
  std::vector<Evaluation> evaluations;
  for (EvaluationPart::Verdicts& played : play(model, scene, players, options)) {
    evaluations.push_back(evaluationOf(scene, played.controller, std::move(played.verdicts)));
  }
  return evaluations;
}

}  // namespace taxelsim
