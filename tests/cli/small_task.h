// A scene of 40 short episodes with a task and two controllers, of which one does nothing.
#pragma once

#include "support/test.h"

namespace taxelsim::testing {

inline const std::string kSmallTask = std::string("format_version: 1\nname: small\nkind: servo\nsensor: ") + TAXELSIM_SOURCE_DIR +
                                      R"(/scenes/sensors/wts0614_soft_cover.yaml
objects: [{cylinder: {radius_mm: 5, length_mm: 100}, orientation: {rpy_deg: [90, 0, 0]}, edge: [0, 0, 1]}]
episode: {num_steps: 60}
randomization: {yaw_deg: [-40, 40], load: [1, 3]}
controllers:
  - {name: fast, tactile_servo: {edge_angle: {reference_deg: 90, kp: 10}, max_angular_velocity: 20}}
  - {name: none, tactile_servo: {edge_angle: {reference_deg: 90, kp: 0}}}
task: {edge_angle: {reference_deg: 90, tolerance_deg: 3}, hold: 0.1}
data_set: {episodes: 40, seed: 3}
)";

inline void writeSmallTask(const std::filesystem::path& file) {
  std::ofstream(file) << kSmallTask;
}

}  // namespace taxelsim::testing
