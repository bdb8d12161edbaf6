// The load search of the reference: how far along z of S the objects move until they rest on the skin with a given force.
#pragma once

#include <span>
#include <vector>

#include "reference/depth.h"
#include "reference/relaxation.h"

namespace taxelsim::reference {

struct LoadResult {
  double offset = 0;     // m, added to z of every pose: at the load; at full depth when it is too large; 0 when nothing lies over the skin
  bool reached = false;  // the skin carries the load between first touch and full depth
  double first_touch = 0;  // m: offset at which the objects begin to touch
  double full_depth = 0;   // m: offset at which the deepest sample is as deep as the skin is thick
};

// Objects after moving by `offset` along z of S.
std::vector<PlacedObject> movedAlongZ(std::span<const PlacedObject> objects, double offset);

// Finds the offset by bisection: force is the sum over the taxels at rest, `load` (N) >= 0. `skin`: of a skin that relaxes, at the end of
// the step. Not of ElasticLayer (reference/elastic_layer.h).
LoadResult findLoad(const Sensor& sensor, std::span<const PlacedObject> objects, double load, const SkinStep& skin = {});

}  // namespace taxelsim::reference
