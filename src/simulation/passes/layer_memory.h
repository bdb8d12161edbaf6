// Shared memory of the elastic layer pass, which has a range of strips for each row of nodes.
#pragma once

#include <cstdint>

#include "sensor/elastic_layer.h"
#include "taxelsim/device.h"

namespace taxelsim {

// Throws Error(kInput) if the layer of `sensor` does not fit into the device's shared memory. `lanes`: partial sums of the pass.
void checkLayerFits(const DeviceInfo& info, const Sensor& sensor, const LayerNodes& nodes, std::uint32_t lanes);

}  // namespace taxelsim
