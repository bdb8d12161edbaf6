// Tactile sensors in robot descriptions: the <sensor><tactile> element of Bielefeld University's extension of URDF (urdf_tactile,
// github.com/ubi-agni/tactile_toolbox). Other elements are ignored.
//
//   <robot>
//     <sensor name="...">
//       <tactile>
//         <array rows="16" cols="16" size="0.005 0.005" spacing="0.005 0.005" offset="0 0" order="row-major"/>   or else
//         <taxel idx="0" xyz="0.01 0.01 0" rpy="0 0 0"> <geometry> <box size="0.004 0.004 0.001"/> </geometry> </taxel> ...
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "taxelsim/robot.h"
#include "taxelsim/sensor.h"

namespace taxelsim {

inline constexpr std::uintmax_t kMaxUrdfBytes = std::uintmax_t{16} << 20;

// The taxels of sensor `name` in its own frame, which is S (its <origin> in the parent link is ignored), in the order of its data. Taxel
// (i, j) of an array is at (i spacing[0] - offset[0], j spacing[1] - offset[1], 0); `spacing` is `size` and
// `offset` is 0 where they are not given, a negative spacing flips. Data run along the columns first in row-major order (the default),
// along the rows in column-major (or col-major) order. A row-major array without gaps and flips is one grid patch; otherwise each taxel
// is a patch. A <taxel> is a box's x and y, or the square of the area of a cylinder's or sphere's disc; `idx` counts from 0. Throws
// Error(kInput), "file:line: ...", for what is missing, malformed, or more than `max_taxels` (of one grid: 128 x 128).
std::vector<GridPatch> loadUrdfTaxels(const std::filesystem::path& file, const std::string& name, int max_taxels);

// The place of sensor `name` on the robot: its <parent link> and its <origin xyz rpy>, identity without one. Throws as above.
SensorMount loadUrdfMount(const std::filesystem::path& file, const std::string& name);

}  // namespace taxelsim
