// Oracle of the tactile Jacobian: random contacts, and central differences of features on a much finer sample grid.
#pragma once

#include "support/random_scene.h"
#include "support/test.h"

namespace taxelsim::support {

// Half of the difference between the two poses.
inline constexpr double kJacobianStep = 0.1e-3;     // m
inline constexpr double kJacobianTurn = 0.0174533;  // rad: 1 degree, less where that moves a taxel farther than by the step
// Samples per side of a taxel for these differences.
inline constexpr int kFineSamples = 32;

// Pose of an object after the sensor moved by `step` along coordinate k of its twist: v of the origin of S, then w, in S.
Pose afterTwist(const Pose& X_SO, std::size_t k, double step);

// A contact in which no wall of an object and no limit of the depth is crossed within the step: deeper than the step, and far from full
// depth.
struct JacobianCase {
  Sensor sensor;  // with `samples_per_taxel` to be set
  std::vector<Object> objects;
  std::vector<Pose> X_SO;
  bool has_walls = false;

  std::vector<reference::PlacedObject> placed() const;
};

enum class JacobianKind {
  kRound,    // one round solid over one patch
  kWalls,    // a box or prism, whose vertical walls are in the contact
  kPatches,  // round solids over up to three patches, tilted against each other, each touched by its own
};
JacobianCase randomJacobianCase(Random& random, JacobianKind kind);

// Derivatives of centre of pressure, force and edge angle of a row, and of the wrench.
struct FeatureChanges {
  std::array<std::array<double, 6>, 3> center_of_pressure{};
  std::array<double, 6> total_force{}, edge_angle{};
};
struct JacobianChanges {
  FeatureChanges sensor;
  std::vector<FeatureChanges> patches;
  FeatureChanges measured;
  std::vector<bool> reports;  // (num_taxels): as reportingTaxels(), at all these poses
  bool triggers_hold = true;  // they do so alike: else the readout has a kink there
  std::array<std::array<double, 6>, 6> contact_wrench{};
};

// Which taxels report a value, or have no trigger.
std::vector<bool> reportingTaxels(const Sensor& sensor, const std::vector<double>& spread_force);

// Central differences of the features of the reference on kFineSamples.
JacobianChanges centralDifferences(const JacobianCase& contact);

// Properties of the image of a row that scale its errors.
struct JacobianScale {
  double size = 0;        // m: root of the sum of its second moments
  double lever = 0;       // m: of its centre of pressure about S's origin
  double confidence = 0;  // of its edge angle
  double apart = 0;       // m: distance between two contacts; force that moves from one to the other moves the centre by it
  double force = 1;       // N: its total force
};

// Largest errors of a set of contacts, each relative to the scale of its kind of entry: the largest one in the same row of the same contact
// by the same half of the twist, but no less than what that kind has in any contact. By v that is for a force the stiffness of the area in
// touch, for a centre 1, for an angle 1 over the contact's size and the angle's confidence, as it is a quotient by the difference of
// eigenvalues; by w the same times size and lever.
class JacobianErrors {
 public:
  void add(const FeatureChanges& found, const FeatureChanges& expected, const JacobianScale& scale);
  void addWrench(const std::array<std::array<double, 6>, 6>& found, const std::array<std::array<double, 6>, 6>& expected,
                 const JacobianScale& scale);

  // Over everything that was added but angles, and over angles.
  double worst() const;
  double worstAngle() const;
  void print(const char* title) const;

 private:
  struct Entry {
    double largest = 0, sum_of_squares = 0;
    int count = 0;
    void add(double error);
  };
  // Center, force, angle, wrench by v and by w.
  std::array<Entry, 8> entries_;
};

}  // namespace taxelsim::support
