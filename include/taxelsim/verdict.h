/// @file
/// The verdict on one episode of a task, and on one of a grasp.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "taxelsim/task.h"

namespace taxelsim {

/// Outcome of one episode. Errors are NaN for measures without a criterion in the task.
struct Verdict {
  std::uint64_t episode = 0;                           ///< Number of the episode.
  int object = 0;                                      ///< Index of the object in the scene.
  bool success = false;                                ///< Whether the episode met the task; see Task.
  std::array<float, kNumTaskMeasures> start_error{};   ///< Errors in the first frame, in the units of TaskMeasure.
  std::array<float, kNumTaskMeasures> steady_error{};  ///< Medians over the last Task::hold seconds; infinite if contact was lost in them.
  float settling_time = 0;                             ///< s until all errors stay within their tolerances to the end; NaN if they do not.
  float travel = 0;                                    ///< m, path length of the sensor's origin over the object.
  float laps = 0;                                      ///< Turns around the object's contour, in either direction.
  float peak_force = 0;                                ///< N, largest clean total force.
  float saturated = 0;                                 ///< Fraction of the frames with a taxel at its upper end.
  int num_losses = 0;                                  ///< Times that contact was lost.
  std::uint8_t robot = 0;    ///< All robot status bits that occurred: 1 joint limit, 2 velocity limit, 4 singular, 8 lost.
  bool load_reached = true;  ///< False if the skin could not carry the load, so that the episode began with the deepest contact.
};

/// Judgement of one finger in one episode, by clean forces. "End": the last GraspTask::hold seconds.
struct FingerVerdict {
  bool held = false;         ///< Whether the finger met GraspTask.
  double target = 0;         ///< N, target force of the episode.
  double force_error = 0;    ///< N, root mean square of the force minus its target, over the frames of the end.
  double settling_time = 0;  ///< s until the force stays within its tolerance to the end of the episode; NaN if it does not.
  double peak_force = 0;     ///< N, largest force.
  double drift = 0;    ///< m, largest distance of the centre of pressure from where it was when the end began; NaN if it lost contact.
  int num_losses = 0;  ///< Times that contact was lost.
};

/// Judgement of one episode.
struct GraspVerdict {
  std::uint64_t episode = 0;           ///< Number of the episode.
  bool success = false;                ///< Whether every finger held.
  std::vector<FingerVerdict> fingers;  ///< (num_fingers), in the order of Grasp::fingers.
};

}  // namespace taxelsim
