// What a sweep runs on: sensors, objects and batches, all made in code, so that the program needs no files.
#pragma once

#include <string>
#include <vector>

#include "bench_objects.h"
#include "taxelsim/object.h"
#include "taxelsim/sensor.h"

namespace taxelsim::bench {

struct SweepCase {
  std::string name;
  Sensor sensor;
  Object object;
  PoseSpread spread;
  int num_instances = 0;      // wanted; a device may hold fewer
  bool has_clusters = false;  // the object is a mesh whose clusters are culled
  std::string published{};    // what others report of such a case; empty: nothing
};

// scenes/sensors/wts0614.yaml.
Sensor wts0614();

// In the order in which they run.
std::vector<SweepCase> sweepCases();

// Those of `names`, in the same order; empty: all. Throws Error(kInput) for an unknown name.
std::vector<SweepCase> casesNamed(const std::vector<std::string>& names);

}  // namespace taxelsim::bench
