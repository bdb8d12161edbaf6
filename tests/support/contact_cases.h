// Contacts whose features are known: edges across an array, spheres, plates and tilted punches, by seed; and what may be expected of them.
#pragma once

#include <array>
#include <vector>

#include "support/random_scene.h"
#include "taxelsim/contact_type.h"

namespace taxelsim::support {

Sensor wts0614();

// Counts: a loaded taxel of the family, scenes/sensors/wts0614.yaml.
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

// Errors of angles that are known up to pi, degrees.
class AngleErrors {
 public:
  void add(double found, double expected);
  double quantile(double share) const;

 private:
  std::vector<double> errors_;
};

// Of edges that the array cuts off, with noise: axes of all forces err by degrees, those under a window by a tenth of that.
void expectWindowHelps(const AngleErrors& plain, const AngleErrors& windowed);

// By how much (rad) the tilt about an axis may be off where the face ends anywhere beside the core.
double tiltSlack(const Sensor& sensor, const std::vector<int>& core, double depth, int axis);

}  // namespace taxelsim::support
