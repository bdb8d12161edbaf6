// Scores of crossValidate() as text and JSON.
#pragma once

#include <nlohmann/json_fwd.hpp>
#include <span>
#include <string>

#include "taxelsim/cross_validate.h"

namespace taxelsim::figures {

// One line: whether a baseline predicts better than the fitted sensor, in M4 or in the sum, below or from `light_below` (N) up; 0: all
// loads together. The remark if nothing was predicted.
std::string verdictText(const CrossValidation& result, double light_below);

// The verdicts and remarks first, then a table of medians and one of M4 by load.
std::string crossValidationText(std::span<const CrossValidation> results, double light_below);

nlohmann::ordered_json crossValidationJson(std::span<const CrossValidation> results, double light_below);

}  // namespace taxelsim::figures
