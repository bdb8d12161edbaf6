// How many taxels, samples, cells, triangles and nodes a frame touches: what its bytes and operations depend on (option_limits.h).
#pragma once

#include <map>
#include <nlohmann/json.hpp>
#include <optional>
#include <span>
#include <tuple>
#include <vector>

#include "sensor/elastic_layer.h"
#include "taxelsim/device.h"
#include "taxelsim/object.h"
#include "taxelsim/sensor.h"

namespace taxelsim::bench {

// Means over frames. A sample is a node of elastic_layer, and a cell with area sampling.
struct FrameCounts {
  double taxels = 0;           // of the sensor
  double touched_taxels = 0;   // with a sample under the object; for an elastic layer, with a node under pressure
  double spread_taxels = 0;    // to which the point spread brings force
  double samples = 0;          // of the taxels under the object; elastic_layer: nodes under the object or under pressure
  double touched_samples = 0;  // with depth > 0
  double edge_samples = 0;     // touched, next to one that is not: with area sampling such cells are covered in part

  // Meshes. 0 for an analytic solid.
  double triangles = 0;               // with a part under the skin's surface, over the array
  double triangles_over_samples = 0;  // of these, with a sample in their bounding box
  double facet_samples = 0;           // with area sampling: pairs of such a triangle that looks down and a cell that it covers in part

  // elastic_layer.
  double pressed_nodes = 0;  // under pressure
  double products = 0;       // samples times nodes under pressure

  // Measured by the timed simulator.
  double iterations = 0;        // of the solver of elastic_layer
  double regions = 0;           // with contact features of their own
  double reporting_taxels = 0;  // whose count is not 0
};

nlohmann::ordered_json toJson(const FrameCounts& counts);

// Counts frames of one object, from depths and pressures at every sample that the simulator outputs, and the poses.
class FrameCounter {
 public:
  // `X_SO`: the object's pose in every frame.
  FrameCounter(const Device& device, Object object, std::vector<Pose> X_SO);

  // Of a sensor with one grid patch. Sets all counts except those that the timed simulator measures. Nothing where an elastic layer has
  // more than kMaxTaxelsPerSide nodes along a side: pressures are counted on a sensor with a taxel per node.
  std::optional<FrameCounts> count(const Sensor& sensor);

 private:
  using Key = std::tuple<int, int, double, double, DepthSampling>;  // rows and columns of nodes, their spacing, sampling

  // Depths, (num_frames x num_rows x num_cols), m, of the samples of the first patch of `sensor`.
  const std::vector<float>& depths(const Sensor& sensor, const LayerNodes& nodes);
  // Forces of nodes of an elastic layer, (num_frames x num_rows x num_cols), N.
  std::vector<float> pressures(const Sensor& sensor, const LayerNodes& nodes) const;
  void countTriangles(const Sensor& sensor, const LayerNodes& nodes, FrameCounts& counts) const;

  Device device_;
  Object object_;
  std::vector<Pose> X_SO_;
  std::map<Key, std::vector<float>> depths_;
};

}  // namespace taxelsim::bench
