// The verdict on one episode of a task.
#pragma once

#include <array>
#include <cstdint>

#include "taxelsim/task.h"

namespace taxelsim {

// What became of one episode. Errors are NaN where the task has no criterion for them.
struct Verdict {
  std::uint64_t episode = 0;
  int object = 0;  // of the scene
  bool success = false;
  std::array<float, kNumTaskMeasures> start_error{};   // in the first frame
  std::array<float, kNumTaskMeasures> steady_error{};  // median over the last `hold` seconds; infinite where the contact was lost meanwhile
  float settling_time = 0;                             // s, until all errors stay within their tolerances for good; NaN where they do not
  float travel = 0;                                    // m, of the sensor's origin over the object
  float laps = 0;                                      // of the contour, either way round
  float peak_force = 0;                                // N, largest clean total force
  float saturated = 0;                                 // part of the frames with a taxel at its upper end
  int num_losses = 0;                                  // times that contact was lost
  std::uint8_t robot = 0;    // every RobotStatus that came up: 1 joint limit, 2 velocity limit, 4 singular, 8 lost
  bool load_reached = true;  // else the episode began with the deepest contact
};

}  // namespace taxelsim
