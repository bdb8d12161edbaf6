// The point spread function -> the kernel or the lists of sources that the image pass reads.
#pragma once

#include "simulation/pack/pack_sensor.h"
#include "taxelsim/sensor.h"

namespace taxelsim {

// Fills spread_rows, spread_scale and num_entries; needs one_grid and rotates_shear.
void packSpread(const Sensor& sensor, PackedSensor& packed);

}  // namespace taxelsim
