// A robot as a picture: the chains from its base to its sensors as lines between joints, and the taxels of the sensors, from two sides.
#pragma once

#include <span>
#include <string>
#include <vector>

#include "figures/canvas.h"
#include "taxelsim/robot.h"
#include "taxelsim/sensor.h"

namespace taxelsim::figures {

// The chain from the base to one sensor in a posture.
struct PosedSensor {
  std::string name;
  std::vector<Vector3> joints{};  // m, in W: the base, then each joint
  Pose X_WS{};
  const Sensor* sensor = nullptr;  // none: the sensor is known by its place only
};

// At joint positions q (num_joints), rad or m. `names`: (num_sensors).
std::vector<PosedSensor> posedSensors(const Manipulator& robot, std::span<const double> q, std::span<const std::string> names);

// Draws the sensors as the world has them, z up.
Canvas drawRobot(const std::vector<PosedSensor>& sensors, const std::string& title, const std::string& subtitle);

}  // namespace taxelsim::figures
