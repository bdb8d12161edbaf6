// One frame of one sensor as JSON and as text, from the feature table.
#pragma once

#include <string>

#include "taxelsim/sensor.h"
#include "taxelsim/simulator.h"

namespace taxelsim::cli {

// `frame`: of one instance, with contact features and clean contact features.
std::string frameJson(const Sensor& sensor, const FrameView& frame);

// The same on stdout, for people.
void printFrame(const Sensor& sensor, const FrameView& frame);

}  // namespace taxelsim::cli
