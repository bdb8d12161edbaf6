// Sensors whose skin is an elastic layer, and random contacts on them.
#pragma once

#include <vector>

#include "simulation/comparison.h"
#include "support/random_scene.h"

namespace taxelsim::support {

inline constexpr double kModulus = 1e6;  // Pa
// Iterations enough for any contact here, to what float32 leaves of the residual.
inline constexpr int kManyIterations = 300;
inline constexpr double kTightTolerance = 2e-5;

struct LayerOptions {
  double thickness = 2e-3;  // m
  double poisson_ratio = 0.49;
  ElasticLayer::Base base = ElasticLayer::Base::kBonded;
  double margin = 0;  // m
  int iterations = kManyIterations;
  double tolerance = kTightTolerance;
};

Sensor layerSensor(const LayerOptions& skin, const GridOptions& grid = {});

// Objects without a silhouette near the skin, where a sample may fall to either side: round ones, and a box on its edge or corner.
std::vector<Object> roundObjects(Random& random);

// One of them somewhere on the first patch or its border, up to 1.1 thicknesses deep.
Touch randomTouch(Random& random, const Sensor& sensor, const std::vector<Object>& objects);

// Where an object goes that rolls, slides, twists, lifts a little or rests: by up to `size` (m) along each axis.
Pose nextPose(Random& random, const Pose& X_SO, double size);

// What the device's sums over the taxels may miss of the twin's of `force` (N) at `deepest` (m), solved to kTightTolerance. The residual
// counts displacements; under a wide contact on a nearly incompressible layer pressures of long waves move little, and their error is some
// forty times the residual (seen: thirty-five). Beside that, heights are rounded: forces of a depth that is off by the margin.
double forceSlack(double force, double deepest);

}  // namespace taxelsim::support
