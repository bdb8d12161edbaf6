// How the fingers of a scene of kind grasp close: postures on the way, objects that they come near, sensors that can touch each other.
#pragma once

#include <span>
#include <string>
#include <vector>

#include "taxelsim/robot.h"
#include "taxelsim/scene.h"

namespace taxelsim::cli {

// Joint positions (num_joints) after `time` s of closing from `start`: the joints of all fingers move at their closing velocities, each to
// its limit; a joint without a limit turns once.
std::vector<double> closingPositions(const Scene& scene, std::span<const double> start, double time);

// s, until all joints have reached their limits.
double closingTime(const Scene& scene, std::span<const double> start);

// A finger from `start` to its closed posture.
struct ClosingFinger {
  std::string name;
  Pose open, closed;    // X_WS
  std::string object;   // nearest on the way, by the boxes around taxels and object; motions of objects are not regarded
  double distance = 0;  // m, least distance to it, a lower bound; 0 where the boxes meet
};
std::vector<ClosingFinger> closingFingers(const Scene& scene, std::span<const double> start);

// Two sensors of which one closes.
struct SensorPair {
  std::string first, second;
  double distance = 0;     // m, least distance of two taxels' centres on the way; fingers that stop at different times included
  bool can_touch = false;  // whether it is less than half the diagonals of both taxels
};
std::vector<SensorPair> closingPairs(const Scene& scene, std::span<const double> start);

}  // namespace taxelsim::cli
