// Sensors of taxels with places of their own: fingertips by formula, random lists by seed. S lies in the apex of the skin.
#pragma once

#include "support/random_scene.h"

namespace taxelsim::support {

// Rings of taxels on a cylinder along y, axis at z = -radius: `num_around` from -half_angle to half_angle (rad, of the outermost centres),
// `num_along` along y.
Sensor cylinderFingertip(double radius, double half_angle, int num_around, int num_along, double pitch_along);

// A taxel at every vertex of an icosphere no farther than `half_angle` (rad) from its apex, centre at z = -radius; all of one size, which
// together cover a sphere.
Sensor sphereFingertip(double radius, int num_subdivisions, double half_angle);

// Taxels anywhere on the upper part of an ellipsoid, up to 100 degrees down, normals a little off, sizes differing.
Sensor randomTaxels(Random& random, int num_taxels);

// One of these by the number `kind`, with a spread along the skin.
Sensor curvedSensor(Random& random, int kind);

// Some object in contact with a random taxel of the sensor, along its normal, at a depth up to 1.2 times the skin's thickness.
Pose randomContactOnTaxel(Random& random, const Sensor& sensor, const Object& object);

}  // namespace taxelsim::support
