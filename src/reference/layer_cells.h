// Cells of an elastic layer's nodes with DepthSampling::kArea: what an edge of an object covers of them, and how soft that makes the nodes.
//
//        object                    A smooth surface is met at the height in the middle of a cell, as with points: where it leaves the skin,
//        |     |                   its depth varies over the cell from 0. An edge cuts a cell where the depth hardly varies over what is
//   +----|--+--|----+              covered; there the mean displacement over the covered part is the mean depth of that part.
//   |    |##|##|    |  cells
//   +----|--+--|----+              Both limits, and the compliance of a part, are in shaders/elastic_layer/cells.glsl and
//        c1   c2     centroids     shaders/depth/area/cell_depths.glsl.
#pragma once

#include <array>
#include <span>
#include <vector>

#include "reference/depth.h"
#include "sensor/elastic_layer.h"
#include "taxelsim/sensor.h"

namespace taxelsim::reference {

// All of shape (nodes); empty where cells are whole.
struct LayerCells {
  std::vector<double> height;                // m along z of P: mean over what is covered
  std::vector<double> covered;               // share that is covered
  std::vector<double> share;                 // that counts as covered, 1 without an edge; 0 where nothing touches
  std::vector<double> edge;                  // 0 to 1: how far an edge bounds what is covered
  std::vector<std::array<double, 2>> place;  // m, in P, from the node to the centroid
  std::vector<int> touching;                 // index of the object, or kNoContact
  std::vector<double> compliance;            // m/Pa: what a node's own pressure moves it by more than that of a whole cell
};

// Cells of the nodes under the objects after a translation by `offset` (m) along z of S, with the heights of their poses; by exact clipping
// and rays, area_depth.h. Empty without area sampling.
LayerCells layerCells(const Sensor& sensor, const LayerNodes& nodes, std::span<const PlacedObject> objects, double offset = 0);

// The same at full depth, for a load search; the translation is along z of P.
LayerCells layerCellsAtFullDepth(const Sensor& sensor, const LayerNodes& nodes, std::span<const PlacedObject> objects);

// Compliances of the cells of an elastic layer.
struct NodeCompliance {
  double whole = 0;         // m/Pa, of a whole cell
  CellCompliance of_parts;  // relative to it
};
NodeCompliance nodeCompliance(const Sensor& sensor, const LayerNodes& nodes);

// LayerCells::compliance from the other arrays.
std::vector<double> cellCompliances(const LayerCells& cells, const LayerNodes& nodes, const NodeCompliance& compliance);

// Heights that the nodes meet, from those in the middle of their cells: both (nodes), m.
std::vector<double> heightsOfCells(const LayerCells& cells, std::vector<double> heights);

}  // namespace taxelsim::reference
