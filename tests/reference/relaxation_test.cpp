// Relaxation of the reference against closed forms (support/relaxation_cases.h).
#include "reference/frame.h"
#include "support/relaxation_cases.h"
#include "support/test.h"

namespace taxelsim {
namespace {

using support::Press;
using support::Pressed;
using support::RelaxationCases;

std::vector<Pressed> simulateWithReference(const Sensor& sensor, const Object& object, const std::vector<Press>& steps) {
  reference::SkinHistory skin(sensor.skin.relaxation);
  std::vector<Pressed> result;
  for (const Press& step : steps) {
    const reference::Frame frame =
        reference::simulateFrame(sensor, {.objects = {{&object, step.X_SO}}, .load = step.load, .dt = step.dt, .skin = &skin});
    const std::vector<double>& forces = frame.contact.taxel_force;
    result.push_back({frame.contact.total_force, *std::min_element(forces.begin(), forces.end()), frame.load.offset, frame.load.reached});
  }
  return result;
}

const RelaxationCases kTwin{simulateWithReference, 1e-12};

class RelaxationClosedForm : public ::testing::TestWithParam<support::RelaxationCase> {};

TEST_P(RelaxationClosedForm, Holds) {
  (kTwin.*GetParam().check)();
}

INSTANTIATE_TEST_SUITE_P(Cases, RelaxationClosedForm, ::testing::ValuesIn(support::kRelaxationCases),
                         [](const auto& row) { return row.param.name; });

}  // namespace
}  // namespace taxelsim
