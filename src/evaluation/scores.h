// Statistics of the verdicts of one controller.
#pragma once

#include <string>
#include <vector>

#include "taxelsim/evaluate.h"

namespace taxelsim {

// verdicts: in order of episodes.
Evaluation evaluationOf(const Scene& scene, const std::string& controller, std::vector<Verdict> verdicts);

}  // namespace taxelsim
