// Parts of an evaluation as JSON text. The verdicts of a controller are one text of hexadecimal digits: the bytes of their numbers, exact
// also where they are not finite, and small enough for millions of episodes.
#pragma once

#include <span>
#include <string>

#include "taxelsim/evaluation_part.h"

namespace taxelsim {

// Equal for verdicts with the same bytes only; the numbers of the episodes are left out.
std::string digitsOf(std::span<const Verdict> verdicts);
std::string digitsOf(std::span<const GraspVerdict> verdicts);

}  // namespace taxelsim
