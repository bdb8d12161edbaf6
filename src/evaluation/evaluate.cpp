#include "taxelsim/evaluate.h"

#include "episodes/batch.h"
#include "evaluation/misses.h"
#include "evaluation/play.h"
#include "evaluation/scores.h"

namespace taxelsim {

std::vector<Evaluation> evaluate(const Device& device, const Scene& scene, const std::vector<std::string>& controllers,
                                 const EvaluateOptions& options) {
  const Players players(scene, controllers, options);
  const Model model(device, modelOptionsOf(scene));
  std::vector<Evaluation> evaluations;
  play(model, scene, players, options, [&](EvaluationPart::Verdicts played) {
    evaluations.push_back(evaluationOf(scene, played.controller, std::move(played.verdicts)));
    if (options.on_evaluation) options.on_evaluation(evaluations.back());
  });
  warnOfContactMisses(scene, evaluations);
  return evaluations;
}

}  // namespace taxelsim
