// Load search of the reference: the offset along z of S at which the objects press on the skin with a given force along -z of S.
//
//   force ^                        *   full_depth: the deepest sample is compressed by the skin thickness
//         |                   *
//    load |- - - - - - - - *
//         |             *  |
//         |        *       |
//         +----*-----------|---------> depth
//       first_touch      offset
//
// The force at rest is monotone in the depth, so bisection between first_touch and full_depth finds the root to the last bit. Over level
// patches the heights are computed once and shifted. Over tilted patches the objects also move sideways: every evaluation computes the
// heights anew, and the force may jump where an edge reaches a sample. A load inside such a jump counts as not reached. With
// DepthSampling::kArea every evaluation computes the means over the cells; full depth is that of coveredDepths().
#pragma once

#include <span>
#include <vector>

#include "reference/contact.h"
#include "reference/depth.h"
#include "reference/relaxation.h"

namespace taxelsim::reference {

struct LoadResult {
  double offset = 0;  // m, added to z of every pose: carries the load; full_depth if the load is too large; 0 if no object is over the skin
  bool reached = false;    // whether the skin carries the load between first_touch and full_depth
  double first_touch = 0;  // m: offset at which an object first touches a sample, or a cell
  double full_depth = 0;   // m: offset at which the deepest sample reaches the skin thickness
};

// The objects, translated by `offset` (m) along z of S.
std::vector<PlacedObject> movedAlongZ(std::span<const PlacedObject> objects, double offset);

// Component along the load, -z of S, of the force that the objects exert through the normal forces of the taxels, N.
double forceAlongLoad(const Sensor& sensor, const Contact& contact);

// `load` (N, >= 0): forceAlongLoad() at rest. `skin`: state of a relaxing skin at the end of the step; default: never loaded.
// Not for ElasticLayer: see loadedLayerContact() in elastic_layer.h.
LoadResult findLoad(const Sensor& sensor, std::span<const PlacedObject> objects, double load, const SkinStep& skin = {});

}  // namespace taxelsim::reference
