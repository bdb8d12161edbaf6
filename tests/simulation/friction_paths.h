// Sensors whose skin keeps state from step to step, random paths of objects over them, and independence of the batch along these.
#pragma once

#include "simulation/comparison.h"
#include "support/random_scene.h"
#include "support/test.h"

namespace taxelsim::support {

// A sensor with friction that uses every branch of the passes: two patches, one of them tilted, damping and a PSF.
Sensor frictionSensor();

// The same with LuGre bristles instead of springs: shear depends on velocity.
Sensor bristleSensor();

// Random paths of objects that roll, slide, lift off and touch again.
struct ObjectPaths {
  std::vector<Object> objects;
  std::vector<std::vector<Touch>> touches;  // (steps x instances)
  std::vector<float> loads;                 // (instances), N; every third under a load, if wanted
};

// `step_size` (m): largest translation per step along each axis.
ObjectPaths randomPaths(const Sensor& sensor, int num_instances, int num_slots, bool with_loads, double step_size = 0.2e-3);

// Paths of five instances on an elastic layer, two of them under a load: objects roll, slide, jump and lift. Pins and boxes where areas are
// sampled, else round objects.
ObjectPaths layerPaths(const Sensor& sensor, int num_slots);

// Simulates the given instances in one batch, in that order. Returns the bits of each instance after every step. Steps take the times `dt`
// (s) in turn.
std::vector<std::vector<std::uint32_t>> runPaths(const Model& model, const ObjectPaths& paths, const std::vector<int>& instances,
                                                 const std::vector<double>& dt = {1e-3}, const OutputOptions& outputs = {});

// Workgroups of the contact pass and of the image pass; 0: default.
using Workgroups = std::array<int, 2>;

// Expects the same bits of every instance with each of these workgroups, and with the first of them in reverse order, after a reset, and
// for some instances alone.
void expectIndependentOfBatch(const Sensor& sensor, const ObjectPaths& paths, const std::vector<Workgroups>& workgroups,
                              const OutputOptions& outputs = {});

// 0 .. count - 1.
std::vector<int> upTo(int count);

}  // namespace taxelsim::support
