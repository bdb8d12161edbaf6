// Sensors, objects and poses for tests: fixed ones by name, random ones by seed. A seed gives the same scene on every machine.
#pragma once

#include "reference/depth.h"
#include "support/test.h"
#include "taxelsim/object.h"
#include "taxelsim/sensor.h"

namespace taxelsim::support {

// Random numbers that do not depend on the standard library.
class Random {
 public:
  explicit Random(std::uint64_t seed) : engine_(seed) {}

  double uniform() { return static_cast<double>(engine_() >> 11) * 0x1p-53; }  // [0, 1)
  double uniform(double min, double max) { return min + (max - min) * uniform(); }
  int integer(int min, int max) { return min + static_cast<int>(uniform() * (max - min + 1)); }  // both ends included
  bool chance(double probability) { return uniform() < probability; }
  Quaternion rotation();              // uniform over all rotations
  Quaternion tilt(double max_angle);  // any yaw, then up to max_angle about an axis in the xy plane

 private:
  std::mt19937_64 engine_;
};

// One level grid in the middle of S; identity PSF; one count per newton, no trigger.
struct GridOptions {
  int num_rows = 6;
  int num_cols = 14;
  double pitch_x = 3.4e-3;  // m
  double pitch_y = 3.4e-3;  // m
  int samples_per_taxel = 4;
  double thickness = 1.45e-3;  // m
  Winkler law{1.73e8, 1, 0};
};
Sensor gridSensor(const GridOptions& options = {});

// Adds a copy of the first patch.
void addPatch(Sensor& sensor, const Pose& X_SP);

// The readout of the paper: 12 bit, 0.2 N + 4.1667e-4 N per count.
Readout paperReadout();

// Limits of a random sensor.
struct SensorRange {
  int max_rows = 12;
  int max_cols = 16;
  int max_patches = 1;
  double max_patch_tilt = 0;  // rad
  int max_kernel = 9;
};
Sensor randomSensor(Random& random, const SensorRange& range = {});

// Meshes, m.
Mesh boxMesh(const Vector3& size);
Mesh icosphere(double radius, int num_subdivisions, double noise, Random& random);  // noise: relative, radial
Mesh prism(const std::vector<std::array<double, 2>>& outline_xz, double length_y);  // convex outline, centred along y
Mesh triangleSoup(int num_triangles, double size, Random& random);
Mesh sheetWithHoles(int num_cells, double size, double roughness, double hole_probability, Random& random);  // open, z about 0

Object randomMeshObject(Random& random, double size);
Object randomPolyhedron(Random& random, double size);  // a mesh: a convex prism of 5 to 16 faces
Object randomSolid(Random& random, double size);
// A rotation in which the object has a lowest surface everywhere (half-spaces are only tilted).
Quaternion randomRotation(Random& random, const Object& object);

// The pose with rotation R_SO whose origin is at (x, y) and whose deepest sample is `depth` (m) below first touch; over the middle of the
// first patch if no part of the object lies over the sensor.
Pose poseAtDepth(const Sensor& sensor, const Object& object, const Quaternion& R_SO, double x, double y, double depth);

// Random rotation and position over the sensor, up to 1.2 thicknesses deep.
Pose randomContact(Random& random, const Sensor& sensor, const Object& object);

// `count` objects of this size (m): with probability `solid_share` a solid, else a mesh, a polyhedron if `all_convex`.
std::vector<Object> randomObjects(Random& random, int count, double size, double solid_share, bool all_convex);

// A workgroup size for ModelOptions: 0 (default) or a power of two from 4 to 256.
int randomWorkgroup(Random& random);

}  // namespace taxelsim::support
