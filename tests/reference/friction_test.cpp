// Shear of the reference against closed forms (support/friction_cases.h).
#include "reference/frame.h"
#include "support/friction_cases.h"
#include "support/test.h"

namespace taxelsim {
namespace {

using reference::Frame;
using support::FrictionCases;
using support::Push;

std::vector<std::vector<Push>> simulateWithReference(const Sensor& sensor, const Object& object, const std::vector<support::Path>& paths) {
  std::vector<std::vector<Push>> result;
  for (const support::Path& path : paths) {
    reference::FrictionState state;
    result.emplace_back();
    for (const Pose& X_SO : path) {
      Frame frame = reference::simulateFrame(sensor, {.objects = {{&object, X_SO}}, .previous_friction = state});
      result.back().push_back({frame.contact.total_force, frame.wrench});
      state = std::move(frame.shear.state);
    }
  }
  return result;
}

// Relative: sums of a few thousand products; displacements of 1e-6 m as differences of positions of 1e-2 m.
const FrictionCases kTwin{simulateWithReference, 1e-9};

class FrictionClosedForm : public ::testing::TestWithParam<support::FrictionCase> {};

TEST_P(FrictionClosedForm, Holds) {
  (kTwin.*GetParam().check)();
}

INSTANTIATE_TEST_SUITE_P(Cases, FrictionClosedForm, ::testing::ValuesIn(support::kFrictionCases),
                         [](const auto& row) { return row.param.name; });

}  // namespace
}  // namespace taxelsim
