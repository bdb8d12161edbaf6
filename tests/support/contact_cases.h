// Random contacts with known features (edges across an array, spheres, plates, tilted punches) and the expected errors.
#pragma once

#include "support/random_scene.h"
#include "support/test.h"
#include "taxelsim/contact_type.h"

namespace taxelsim::support {

Sensor wts0614();

// Noise of scenes/sensors/wts0614_soft_cover.yaml, counts.
inline constexpr double kWtsNoise = 17;

struct ContactCase {
  Object object;
  Pose X_SO;
  ContactType type = ContactType::kNone;
  double angle = 0;  // rad, of an edge
};

// A cylinder of 2 to 20 mm radius right across the array, at +-85 degrees to its rows, 0.5 to 1 mm deep.
ContactCase randomEdge(Random& random);
// 3 to 8 mm radius, 0.3 to 0.8 mm deep.
ContactCase randomSphere(Random& random);
// A box of 14 to 19 mm a side, wholly on the array, 0.2 to 0.6 mm deep.
ContactCase randomPlate(Random& random);

// A box whose lower face is turned by small angles about x and y, in full contact.
struct TiltedPunch {
  Object object;
  Pose X_SO;
  std::array<double, 2> tilt{0, 0};  // rad
  double depth = 0;                  // m, in the middle of its face
};
TiltedPunch randomPunch(Random& random, double side);

// Errors of angles modulo pi, degrees.
class AngleErrors {
 public:
  void add(double found, double expected);
  double quantile(double share) const;

 private:
  std::vector<double> errors_;
};

// Edges cut off by the array, with noise: the principal axis of all forces has an error of degrees, the axis under a window a tenth of
// that.
void expectWindowHelps(const AngleErrors& plain, const AngleErrors& windowed);

// Largest error of the tilt about an axis, rad, if the face may end anywhere outside the core.
double tiltSlack(const Sensor& sensor, const std::vector<int>& core, double depth, int axis);

}  // namespace taxelsim::support
