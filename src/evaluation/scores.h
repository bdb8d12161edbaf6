// Statistics of the verdicts of one controller.
#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <vector>

#include "taxelsim/evaluate.h"

namespace taxelsim {

// Of the finite values.
Quantiles quantilesOf(std::vector<double> values);

// 95 % Wilson interval of a rate, of num_all > 0 episodes.
std::array<double, 2> wilsonInterval(std::uint64_t num_successes, std::uint64_t num_all);

// verdicts: in order of episodes.
Evaluation evaluationOf(const Scene& scene, const std::string& controller, std::vector<Verdict> verdicts);

}  // namespace taxelsim
