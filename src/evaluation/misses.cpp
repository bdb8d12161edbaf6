#include "evaluation/misses.h"

#include <algorithm>
#include <string>
#include <vector>

#include "episodes/contact_misses.h"
#include "evaluation/play.h"

namespace taxelsim {
namespace {

bool touched(const Verdict& verdict) {
  return verdict.peak_force > 0 || !verdict.load_reached;
}

}  // namespace

void warnOfContactMisses(const Scene& scene, std::span<const Evaluation> evaluations) {
  const auto touches = [](const Evaluation& evaluation) { return std::ranges::all_of(evaluation.verdicts, touched); };
  if (std::ranges::all_of(evaluations, touches)) return;  // without a plan, which is slow to make for large meshes
  const EpisodePlan plan(scene, kNoOutputs, 0);
  std::vector<ContactMisses> misses(evaluations.size());
  std::vector<std::string> names;
  for (std::size_t k = 0; k < evaluations.size(); ++k) {
    names.push_back(evaluations[k].controller);
    ContactMissCounter counter(plan, misses[k]);
    for (const Verdict& verdict : evaluations[k].verdicts) counter.add(verdict.episode, touched(verdict));
  }
  warnOfContactMisses(scene, misses, names);
}

}  // namespace taxelsim
