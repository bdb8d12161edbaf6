#include "scene/scene_fields.h"

#include <algorithm>

#include "control/servo_fields.h"

namespace taxelsim {
namespace {

constexpr std::array kEdgeAngleFields{
    Field<TaskCriterion>{"reference[_deg]", &TaskCriterion::reference, kEdgeAngleReference, kOptional, "Reference"},
    Field<TaskCriterion>{"tolerance[_deg]", &TaskCriterion::tolerance, Allowed::aboveUpTo(0, std::numbers::pi / 2, "rad"), kRequired,
                         "Largest error, modulo 180 degrees"},
};
constexpr std::array kTotalForceFields{
    Field<TaskCriterion>{"reference", &TaskCriterion::reference, kForceReference, kOptional, "Reference"},
    Field<TaskCriterion>{"tolerance", &TaskCriterion::tolerance, Allowed::above(0, "N"), kRequired, "Largest error"},
};
constexpr std::array kDistanceFields{
    Field<TaskCriterion>{"tolerance[_mm]", &TaskCriterion::tolerance, Allowed::above(0, "m"), kRequired, "Largest distance"},
};

}  // namespace

std::span<const Field<TaskCriterion>> criterionFields(TaskMeasure measure) {
  if (measure == TaskMeasure::kEdgeAngle) return kEdgeAngleFields;
  if (measure == TaskMeasure::kTotalForce) return kTotalForceFields;
  return kDistanceFields;
}

const RangeField& randomizationField(std::string_view name) {
  return *std::find_if(kRandomizationFields.begin(), kRandomizationFields.end(),
                       [&](const RangeField& field) { return field.name() == name; });
}

}  // namespace taxelsim
