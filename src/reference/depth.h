// Stage 1 of the reference, depth: height of the lowest object surface over every sample of the skin.
//
// A ray runs through each sample along z of its patch. Triangles are rasterised with edge functions (J. Pineda, "A parallel algorithm for
// polygon rasterization", SIGGRAPH 1988) and interpolated in barycentric coordinates; a sample on an edge or vertex is covered. Solids are
// intersected in closed form (solids.h). The lowest surface of all objects wins.
#pragma once

#include <array>
#include <limits>
#include <span>
#include <vector>

#include "reference/samples.h"
#include "taxelsim/object.h"
#include "taxelsim/sensor.h"

namespace taxelsim::reference {

// An object and its pose in S. `object` is not owned.
struct PlacedObject {
  const Object* object = nullptr;
  Pose X_SO;
};

// Parallel rays through the samples of a patch.
struct Rays {
  Vector3 direction_P{0, 0, 1};                                 // z > 0; need not be of unit length. Heights are multiples of it
  std::array<double, 2> shift_P{0, 0};                          // m: added to every sample position, to probe silhouettes
  double view_depth = std::numeric_limits<double>::infinity();  // m: surfaces at heights below -view_depth are ignored
};

// Height of the lowest surface over each sample, (num_taxels x s x s), m along z of the sample's patch: +infinity where there is no
// surface, -infinity under a half-space that opens downwards. Surfaces deeper than the patch's view depth (viewDepths() in sensor/skin.h)
// are ignored.
std::vector<double> surfaceHeights(const Sensor& sensor, std::span<const PlacedObject> objects,
                                   const std::array<double, 2>& shift_P = {0, 0});

// As surfaceHeights() for one patch and arbitrary rays. Appends to `heights` in the order of samplesOf().
void appendHeights(const GridPatch& patch, int samples_per_taxel, std::span<const PlacedObject> objects, const Rays& rays,
                   std::vector<double>& heights);

// Signed penetration d = clamp(-height, -reach, thickness), (num_taxels x s x s), m. `thickness` and `reach` in m, >= 0.
std::vector<double> penetrations(std::span<const double> heights, double thickness, double reach = 0);

}  // namespace taxelsim::reference
