// The blocks `grasp` and `randomization` of a scene of kind grasp (docs/reference/scene_file.md).
#pragma once

#include "scene/yaml_reader.h"
#include "taxelsim/grasp.h"
#include "taxelsim/robot.h"
#include "taxelsim/scene.h"

namespace taxelsim {

// Completes `grasp`, whose sensors have been read, and returns the ranges of the readout. simulation_rate: Hz.
Randomization readGrasp(const YamlMap& scene, const Manipulator& robot, double simulation_rate, int num_steps, Grasp& grasp);

// The block `randomization`: completes `grasp`, and returns the ranges of the readout.
Randomization readGraspRandomization(const YamlMap& scene, Grasp& grasp);

}  // namespace taxelsim
