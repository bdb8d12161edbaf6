/// @file
/// What a controller must achieve in an episode, as data: errors that stay within tolerances. Judged by the true values, not by what the
/// sensor reports.
#pragma once

#include <array>
#include <cstddef>
#include <numbers>
#include <optional>

namespace taxelsim {

/// Errors that a task can bound, in the order of its arrays. All are >= 0.
enum class TaskMeasure {
  kEdgeAngle,   ///< rad, between the object's edge, seen along z of S, and the reference; modulo pi.
  kTotalForce,  ///< N, between the clean total force and the reference.
  kCenter,      ///< m, from the array's middle to the clean centre of pressure, in the xy plane of S.
  kContour,     ///< m, from the sensor's origin to the object's contour, in the xy plane of S.
};

inline constexpr int kNumTaskMeasures = 4;  ///< Number of TaskMeasure values.

/// Unit in which a measure is displayed.
struct TaskMeasureUnit {
  const char* name;  ///< "deg".
  double per_si;     ///< How many of this unit are one SI unit.
};

/// Display units, by TaskMeasure.
inline constexpr std::array<TaskMeasureUnit, kNumTaskMeasures> kTaskMeasureUnits = {
    {{"deg", 180 / std::numbers::pi}, {"N", 1}, {"mm", 1e3}, {"mm", 1e3}}};

/// Names in scene files, by TaskMeasure.
inline constexpr std::array<const char*, kNumTaskMeasures> kTaskMeasureNames = {"edge_angle", "total_force", "center", "contour"};

/// Bound of one error.
struct TaskCriterion {
  double tolerance = 0;  ///< Largest error that counts as met, in the unit of the measure, > 0.
  /// Reference of edge_angle (rad) and total_force (N). Default: 0 rad, and the force that the episode starts with.
  std::optional<double> reference{};
};

/// A task. An episode succeeds if all errors with a criterion are within tolerance in every frame of its last `hold` seconds, with contact,
/// and if it covered `laps` and `travel`.
struct Task {
  std::array<std::optional<TaskCriterion>, kNumTaskMeasures> criteria{};  ///< Criteria by TaskMeasure; empty: not judged.
  double hold = 1;                                                        ///< s, > 0, at most the duration of the episode. Default 1.
  double laps = 0;    ///< Turns around the object's contour required, in either direction, >= 0. Default 0.
  double travel = 0;  ///< m, required path length of the sensor's origin over the object, >= 0. Default 0.

  /// The criterion of one measure.
  std::optional<TaskCriterion>& operator[](TaskMeasure measure) { return criteria[static_cast<std::size_t>(measure)]; }
  /// The criterion of one measure.
  const std::optional<TaskCriterion>& operator[](TaskMeasure measure) const { return criteria[static_cast<std::size_t>(measure)]; }
};

}  // namespace taxelsim
