// An elastic layer -> a sensor of its solver nodes for the contact pass, and the table of influence for elastic_layer.comp.
#pragma once

#include <vector>

#include "sensor/elastic_layer.h"
#include "taxelsim/sensor.h"

namespace taxelsim {

struct PackedLayer {
  LayerNodes nodes;
  Sensor node_sensor;            // the nodes as taxels of one sample
  std::vector<float> influence;  // (num_rows x 2 rows of strips) by distance in rows and columns, relative to the influence of a cell on
                                 // itself; distance 0 is in the middle of a row
  float reach = 0;               // gaps that matter, in depths of the deepest node
  CellCompliance cells{};
  float node_force = 0;  // N: of a node under the pressure that moves its own cell by the skin's thickness
};

// The sensor's law must be ElasticLayer. Throws Error(kInput) where forces are beyond float32.
PackedLayer packLayer(const Sensor& sensor);

}  // namespace taxelsim
