// The skin as a surface in space, over all patches of a sensor: which taxels are neighbours, and how far a patch looks into the body.
#pragma once

#include <array>
#include <vector>

#include "taxelsim/sensor.h"

namespace taxelsim {

// Weight of the point spread function at a distance (m) along the skin; 0 beyond its reach. psf.sigma > 0.
double skinWeight(const Psf& psf, double distance);

struct SkinNeighbour {
  int taxel = 0;
  double weight = 0;
};

// Of every taxel the taxels within psf.reach along the skin, itself among them, by number; psf.sigma > 0. The relation and the weights are
// symmetric. Throws Error(kInput) when a taxel reaches more than kMaxSpreadTaxels.
std::vector<std::vector<SkinNeighbour>> skinNeighbours(const Sensor& sensor);

// How shear is carried along the skin, by the shortest turn from the normal of the taxel with frame P to that of the one with frame Q:
// cosine and sine of the angle from x of Q to x of P so turned. (1, 0) between opposite normals, where no turn is the shortest.
std::array<double, 2> turnAlongSkin(const Quaternion& R_SP, const Quaternion& R_SQ);

// How deep under its skin (m) each patch sees surfaces, (num_patches): an object at the far side of a finger is met by lines through the
// finger, and is no contact of the near side. A point p - t n under a taxel at p with normal n is nearer to another part q of the skin once
//   t > |p - q|^2 / (2 n . (p - q)),
// the radius of the ball inside the body that touches the skin at p and q. The least of these over all q whose normals look the other way
// (n . m < 0: only there can what touches q from outside meet the line), at least the skin's thickness; infinite where there is none.
std::vector<double> viewDepths(const Sensor& sensor);

}  // namespace taxelsim
