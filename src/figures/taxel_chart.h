// Flat layout of the taxels of a curved or irregular sensor, for figures only.
#pragma once

#include <array>
#include <optional>
#include <vector>

#include "figures/tactile_figure.h"
#include "taxelsim/dataset.h"
#include "taxelsim/sensor.h"

namespace taxelsim::figures {

// Outlines of the taxels of a list (isTaxelList()), (num_taxels). The skin is unrolled around its mean normal: a taxel whose normal leans
// by an angle a moves outwards in this direction by a / sin(a). A cylinder becomes a rectangle; a sphere keeps distances from the centre.
std::vector<TaxelOutline> unrolled(const Sensor& sensor);

// Corners of all taxels in S, (num_taxels x 4), m, in the order of TaxelOutline: clockwise seen from outside.
std::vector<std::array<Vector3, 4>> tilesOf(const Sensor& sensor);

// Outlines of all taxels of a sensor, (num_taxels): unrolled() for a list, positions in the xy plane of S for grids.
std::vector<TaxelOutline> outlinesOf(const Sensor& sensor);

// The taxels that the scene of a data set lists; none for other sensors, or for taxels from a mesh or URDF.
std::optional<Sensor> listedTaxels(const Manifest& manifest);

inline constexpr const char* kUnrolled = "unrolled along the skin; x points down, y to the right";

}  // namespace taxelsim::figures
