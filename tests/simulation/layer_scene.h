// Sensors with an elastic layer as skin, and random contacts on them.
#pragma once

#include <vector>

#include "simulation/comparison.h"
#include "support/random_scene.h"

namespace taxelsim::support {

inline constexpr double kModulus = 1e6;  // Pa
// Enough iterations for any contact here to converge to float32 rounding.
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

// Objects without a silhouette near the skin, where a sample could fall to either side: round objects, and a box on its edge or corner.
std::vector<Object> roundObjects(Random& random);

// Random objects on the first patch or its border, up to 1.1 thicknesses deep.
Touch randomTouch(Random& random, const Sensor& sensor, const std::vector<Object>& objects, int num_slots = 1);

// Next pose of an object that rolls, slides, twists, lifts a little or rests: up to `size` (m) along each axis.
Pose nextPose(Random& random, const Pose& X_SO, double size);

// Error of sums over the taxels, for a force (N) at `deepest` (m), solved to kTightTolerance. The residual measures displacements; under a
// wide contact on a nearly incompressible layer, long waves of pressure cause little displacement, and their error is about forty times the
// residual (measured: thirty-five). The rounding of heights adds the force of a depth error of kMarginZ.
double forceSlack(double force, double deepest);

}  // namespace taxelsim::support
