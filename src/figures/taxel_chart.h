// Where the taxels of a curved or irregular sensor go in a picture. Not a projection to measure in.
#pragma once

#include <optional>

#include "figures/tactile_figure.h"
#include "taxelsim/dataset.h"
#include "taxelsim/sensor.h"

namespace taxelsim::cli {

// Outlines of the taxels of a list (isTaxelList()), (num_taxels), the skin unrolled from where it looks along its mean normal: a taxel
// whose normal leans by an angle a in some direction moves out that way by a / sin(a), so that a cylinder becomes a rectangle and a sphere
// keeps its distances from the middle.
std::vector<TaxelOutline> unrolled(const Sensor& sensor);

// Outlines of all taxels of a sensor, (num_taxels): of a list unrolled(), of grids where they lie in the xy plane of S.
std::vector<TaxelOutline> outlinesOf(const Sensor& sensor);

// The taxels that a data set's scene lists in place; none where the sensor is something else or came from a mesh or URDF.
std::optional<Sensor> listedTaxels(const Manifest& manifest);

inline constexpr const char* kUnrolled = "unrolled along the skin; x runs down, y to the right";

}  // namespace taxelsim::cli
