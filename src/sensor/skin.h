// The skin as a surface in space, over all patches of a sensor: neighbours of taxels, and how deep a patch sees into the body.
#pragma once

#include <array>
#include <vector>

#include "taxelsim/sensor.h"

namespace taxelsim {

// Whether all normals point along z of S, so that the taxels' forces sum to the load.
bool isLevel(const Sensor& sensor);

// Weight of the point spread function at a distance (m) along the skin; 0 beyond its reach. psf.sigma > 0.
double skinWeight(const Psf& psf, double distance);

struct SkinNeighbour {
  int taxel = 0;
  double weight = 0;
};

// For every taxel: the taxels within psf.reach along the skin, including itself, ascending; psf.sigma > 0. The relation and the weights
// are symmetric. Throws Error(kInput) if a taxel has more than kMaxSpreadTaxels.
std::vector<std::vector<SkinNeighbour>> skinNeighbours(const Sensor& sensor);

// Parallel transport of shear along the skin, by the shortest rotation from the normal of frame P to that of frame Q: cosine and sine of
// the angle from x of Q to the rotated x of P. (1, 0) for opposite normals, whose shortest rotation is not unique.
std::array<double, 2> turnAlongSkin(const Quaternion& R_SP, const Quaternion& R_SQ);

// Depth under the skin up to which each patch sees surfaces, m, (num_patches). It keeps an object at the far side of a finger from being a
// contact of the near side. A point p - t n under a taxel at p with normal n is nearer to another part q of the skin once
//   t > |p - q|^2 / (2 n . (p - q)),
// the radius of the ball inside the body that touches the skin at p and q. The result is the minimum over all q with opposing normals
// (n . m < 0, since only an object at such a q can meet the line), at least the skin's thickness; infinite without such a q.
std::vector<double> viewDepths(const Sensor& sensor);

}  // namespace taxelsim
