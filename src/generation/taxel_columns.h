// Columns of arrays over the taxels of a sensor.
#pragma once

#include <set>
#include <string>
#include <vector>

#include "generation/columns.h"

namespace taxelsim {

// tactile_image, and taxel_counts of three-axis taxels, where `groups` has them.
void addMeasuredTaxels(const Sensor& sensor, const std::set<std::string>& groups, std::vector<FrameColumn>& columns);

// Forces and depths of the ground truth, where `groups` has them.
void addTrueTaxels(const Sensor& sensor, const std::set<std::string>& groups, std::vector<FrameColumn>& columns);

// Force and number of the contact points that lie on no taxel, of scenes of contact points.
void addOffArrayPoints(std::vector<FrameColumn>& columns);

}  // namespace taxelsim
