// The blocks `grasp` and `randomization` of a scene of kind grasp (docs/reference/scene_file.md).
#pragma once

#include "scene/yaml_reader.h"
#include "taxelsim/grasp.h"
#include "taxelsim/robot.h"

namespace taxelsim {

// Completes `grasp`, whose sensors have been read. simulation_rate: Hz.
void readGrasp(const YamlMap& scene, const Manipulator& robot, double simulation_rate, int num_steps, Grasp& grasp);

}  // namespace taxelsim
