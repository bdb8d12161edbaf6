// Scaling with the number of instances: the same frames in batches of several sizes, in turns.
#pragma once

#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "peers/cases.h"
#include "report.h"
#include "taxelsim/device.h"

namespace taxelsim::bench {

struct BatchSizes {
  struct Size {
    int num_instances = 0;
    std::vector<double> seconds{};  // (repetitions), s for all frames in batches of num_instances, from poses to features
    std::vector<double> ratios{};   // (repetitions), frames/s relative to the largest batch in the same turn
  };

  std::string name, array;
  std::size_t num_frames = 0;  // per turn: size of the largest batch
  std::vector<Size> sizes;     // ascending

  double framesPerSecond(const Size& size) const { return static_cast<double>(num_frames) / summarise(size.seconds).median; }
};

// `work` has the instances of the largest batch; every size must divide it. Throws what Model and Simulator throw, and Error(kInput) for a
// size that does not.
BatchSizes timeBatchSizes(const Device& device, const Sensor& sensor, const Case& work, std::vector<int> sizes, int repetitions);

void print(const BatchSizes& result);
nlohmann::ordered_json toJson(const BatchSizes& result);

}  // namespace taxelsim::bench
