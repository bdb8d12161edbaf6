// Cases of a sweep: sensors, objects and batches, all defined in code, so that the program needs no files.
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
  int num_instances = 0;      // requested; a device may hold fewer
  bool has_clusters = false;  // whether the object is a mesh with clusters
  std::string published{};    // published figure for a similar case; empty: none
};

// The sensor of bench/sensors/wts0614.yaml.
Sensor wts0614();

// All cases, in running order.
std::vector<SweepCase> sweepCases();

// The cases of `names`, in running order; empty: all. Throws Error(kInput) for an unknown name.
std::vector<SweepCase> casesNamed(const std::vector<std::string>& names);

}  // namespace taxelsim::bench
