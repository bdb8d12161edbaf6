// The options of the simulator that law_cost times, as changes of a plain sensor.
#pragma once

#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "taxelsim/sensor.h"

namespace taxelsim::bench {

inline constexpr double kLawCaseStep = 1e-3;  // s, to which delays fit

struct LawCase {
  std::string name;
  std::function<void(Sensor&)> change;  // applied to the sensor with law winkler
  bool cold = false;                    // whether to reset before every frame
  int max_regions = -1;                 // of the measured contact features; -1: no such features
  bool jacobian = false;                // whether to compute the measured tactile Jacobian
  bool is_paired = false;               // whether to measure it with each other case of this kind, too
  bool is_law = false;                  // two laws are no pair
};

// The first one is the plain frame.
std::vector<LawCase> lawCases();

// Two cases at once; nothing where one excludes the other.
std::optional<LawCase> bothOf(const LawCase& a, const LawCase& b);

}  // namespace taxelsim::bench
