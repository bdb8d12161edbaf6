// One frame of one sensor as a figure.
#pragma once

#include <filesystem>
#include <string>

#include "taxelsim/sensor.h"
#include "taxelsim/simulator.h"

namespace taxelsim::cli {

// Writes a PNG with the tactile image of `frame`, one panel per patch or one for a list of taxels. A sensor of three-axis taxels has as
// many panels more: the counts along the normal, and those along x and y as arrows. `what`: the objects, for the title. Throws Error(kIo)
// if the file cannot be written.
void writeFrameFigure(const std::filesystem::path& file, const Sensor& sensor, const FrameView& frame, const std::string& what);

}  // namespace taxelsim::cli
