// Sensors with taxel lists: analytic fingertips and random lists. S lies in the apex of the skin.
#pragma once

#include "support/random_scene.h"

namespace taxelsim::support {

// Rings of taxels on a cylinder along y, axis at z = -radius: `num_around` from -half_angle to half_angle (rad, of the outermost centres),
// `num_along` along y.
Sensor cylinderFingertip(double radius, double half_angle, int num_around, int num_along, double pitch_along);

// A taxel at every vertex of an icosphere within `half_angle` (rad) of its apex, centre at z = -radius; all taxels have the size with which
// they cover the sphere.
Sensor sphereFingertip(double radius, int num_subdivisions, double half_angle);

// Random taxels on the upper part of an ellipsoid, up to 100 degrees from the apex, with random tilt of normals and random sizes.
Sensor randomTaxels(Random& random, int num_taxels);

// One of these by `kind` (modulo 3), with a PSF along the skin.
Sensor curvedSensor(Random& random, int kind);

// Pose of an object in contact with a random taxel along its normal, up to 1.2 thicknesses deep.
Pose randomContactOnTaxel(Random& random, const Sensor& sensor, const Object& object);

}  // namespace taxelsim::support
