// First difference of two scenes, for the message that refuses to resume a data set.
#pragma once

#include <string>
#include <string_view>

namespace taxelsim::dataset {

// Compares canonical texts of scenes (block YAML, one key per line) and describes the first line that differs, in one line:
//   "randomization.load: [0.5, 5] there, [1, 2] requested"
//   "randomisation there, randomization requested"
// Long values are shortened around the difference. Empty if the texts are equal.
std::string describeSceneDifference(std::string_view there, std::string_view requested);

}  // namespace taxelsim::dataset
