// Episodes of an evaluation that touch nothing.
#pragma once

#include <span>

#include "taxelsim/evaluate.h"

namespace taxelsim {

// Logs one line if there are any.
void warnOfContactMisses(const Scene& scene, std::span<const Evaluation> evaluations);

}  // namespace taxelsim
