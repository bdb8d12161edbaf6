#include "simulation/passes/layer_memory.h"

#include <string>

#include "taxelsim/error.h"

namespace taxelsim {

// The formula of shaders/elastic_layer.comp.
void checkLayerFits(const DeviceInfo& info, const Sensor& sensor, const LayerNodes& nodes, std::uint32_t lanes) {
  const std::uint32_t friction = hasFriction(sensor.skin) ? 8 * lanes + 512 : 0;
  const std::uint32_t bytes = 16 * lanes + 8 * static_cast<std::uint32_t>(nodes.num_rows) + 12 + friction;
  if (bytes <= info.shared_memory) return;
  throw Error(ErrorKind::kInput, "samples_per_taxel: " + std::to_string(sensor.samples_per_taxel) +
                                     " is not allowed: an elastic layer with " + std::to_string(nodes.num_rows) +
                                     " rows of samples takes " + std::to_string(bytes) + " bytes of shared memory, device \"" + info.name +
                                     "\" has " + std::to_string(info.shared_memory));
}

}  // namespace taxelsim
