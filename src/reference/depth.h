// Stage 1 of the reference: how far the lowest object surface lies under or over the undeformed skin, sample by sample.
#pragma once

#include <array>
#include <limits>
#include <span>
#include <vector>

#include "reference/samples.h"
#include "taxelsim/object.h"
#include "taxelsim/sensor.h"

namespace taxelsim::reference {

// An object and where it is.
struct PlacedObject {
  const Object* object = nullptr;
  Pose X_SO;
};

// The lines along which a patch looks.
struct Rays {
  Vector3 direction_P{0, 0, 1};                                 // z > 0; heights are counted along it, in multiples of it
  std::array<double, 2> shift_P{0, 0};                          // m: moves every sample, to see what sits on a silhouette
  double view_depth = std::numeric_limits<double>::infinity();  // m: surfaces farther below the skin are not seen
};

// Height over each sample of the lowest surface of all objects that its patch sees (sensor/skin.h, viewDepths), (num_taxels x s x s), m
// along z of the sample's patch; +infinity where there is none, -infinity under a half-space that opens downwards. A sample exactly on an
// edge counts as covered.
std::vector<double> surfaceHeights(const Sensor& sensor, std::span<const PlacedObject> objects,
                                   const std::array<double, 2>& shift_P = {0, 0});

// The same over the samples of one patch along any rays, appended to `heights` in the order of samplesOf().
void appendHeights(const GridPatch& patch, int samples_per_taxel, std::span<const PlacedObject> objects, const Rays& rays,
                   std::vector<double>& heights);

// Signed penetration d = clamp(-height, -reach, thickness), (num_taxels x s x s), m.
std::vector<double> penetrations(std::span<const double> heights, double thickness, double reach = 0);

}  // namespace taxelsim::reference
