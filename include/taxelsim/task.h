// What a controller is to achieve in an episode, as data: errors that stay within tolerances. Judged by what is true, not by what the
// sensor reports.
#pragma once

#include <array>
#include <cstddef>
#include <numbers>
#include <optional>

namespace taxelsim {

// The errors of a task, in the order of its arrays. All >= 0.
enum class TaskMeasure {
  kEdgeAngle,   // rad, between the object's edge, seen along z of S, and the reference; modulo pi
  kTotalForce,  // N, between the clean total force and the reference
  kCenter,      // m, from the array's middle to the clean centre of pressure, in the xy plane of S
  kContour,     // m, from the sensor's origin to the object's contour, along the xy plane of S
};
inline constexpr int kNumTaskMeasures = 4;
// For people: the unit, and how many of it are one SI unit.
struct TaskMeasureUnit {
  const char* name;
  double per_si;
};
inline constexpr std::array<TaskMeasureUnit, kNumTaskMeasures> kTaskMeasureUnits = {
    {{"deg", 180 / std::numbers::pi}, {"N", 1}, {"mm", 1e3}, {"mm", 1e3}}};
inline constexpr std::array<const char*, kNumTaskMeasures> kTaskMeasureNames = {"edge_angle", "total_force", "center", "contour"};

struct TaskCriterion {
  double tolerance = 0;               // > 0
  std::optional<double> reference{};  // of edge_angle and total_force; without one: 0, the force that the episode starts with
};

// An episode succeeds when all errors that have a criterion are within tolerance in every frame of its last `hold` seconds, in contact,
// and it has come as far as it should.
struct Task {
  std::array<std::optional<TaskCriterion>, kNumTaskMeasures> criteria{};
  double hold = 1;    // s, > 0, at most the episode
  double laps = 0;    // >= 0, of the object's contour, either way round
  double travel = 0;  // m, >= 0: length of the way that the sensor's origin goes over the object

  std::optional<TaskCriterion>& operator[](TaskMeasure measure) { return criteria[static_cast<std::size_t>(measure)]; }
  const std::optional<TaskCriterion>& operator[](TaskMeasure measure) const { return criteria[static_cast<std::size_t>(measure)]; }
};

}  // namespace taxelsim
