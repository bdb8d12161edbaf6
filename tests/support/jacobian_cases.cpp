#include "support/jacobian_cases.h"

#include "base/vector3.h"
#include "reference/contact_features.h"
#include "reference/frame.h"
#include "support/test.h"

namespace taxelsim::support {
namespace {

// Features of the row's own image.
struct RowFeatures {
  Vector3 center{0, 0, 0};
  double force = 0, angle = 0;
};

struct AllFeatures {
  std::vector<bool> reports;
  RowFeatures sensor, measured;
  std::vector<RowFeatures> patches;
  std::array<double, 6> wrench{};
};

RowFeatures rowOf(const reference::Features& features) {
  return {features.center_of_pressure, features.total_force, features.edge_angle};
}

// Of the readout without rounding, whose steps would show in differences.
RowFeatures measuredRow(const Sensor& sensor, const std::vector<double>& spread_force) {
  std::vector<double> force;
  for (std::size_t t = 0; t < spread_force.size(); ++t) {
    const double x = reference::gainOf(sensor.readout, t) * spread_force[t] - reference::triggerOf(sensor.readout, t);
    force.push_back(std::max(x, 0.0));
  }
  return rowOf(reference::featuresOf(sensor, force, std::vector<bool>(force.size(), true)));
}

AllFeatures featuresOf(const JacobianCase& contact) {
  Sensor fine = contact.sensor;
  fine.samples_per_taxel = kFineSamples;
  const reference::Frame frame = reference::simulateFrame(fine, {.objects = contact.placed()});
  AllFeatures all{
      reportingTaxels(fine, frame.spread_force), rowOf(frame.clean), measuredRow(fine, frame.spread_force), {}, frame.contact.wrench};
  const reference::ContactRows rows = reference::contactFeatures(fine, reference::cleanContactImage(fine, frame.spread_force));
  for (const reference::ContactFeatures& patch : rows.patches) all.patches.push_back(rowOf(patch));
  return all;
}

void addColumn(const RowFeatures& low, const RowFeatures& high, std::size_t k, double per, FeatureChanges& changes) {
  for (std::size_t axis = 0; axis < 3; ++axis) changes.center_of_pressure[axis][k] += per * (high.center[axis] - low.center[axis]);
  changes.total_force[k] += per * (high.force - low.force);
  changes.edge_angle[k] += per * std::remainder(high.angle - low.angle, std::numbers::pi);
}

JacobianCase moved(JacobianCase contact, std::size_t k, double step) {
  for (Pose& X_SO : contact.X_SO) X_SO = afterTwist(X_SO, k, step);
  return contact;
}

double largestOf(const std::array<double, 6>& row, std::size_t first) {
  return std::max({std::abs(row[first]), std::abs(row[first + 1]), std::abs(row[first + 2])});
}

Object roundSolid(Random& random) {
  switch (random.integer(0, 4)) {
    case 0:
      return Object("sphere", Sphere{random.uniform(8e-3, 20e-3)});
    case 1:
      return Object("cylinder", Cylinder{random.uniform(8e-3, 15e-3), 200e-3});
    case 2:
      return Object("capsule", Capsule{random.uniform(8e-3, 12e-3), random.uniform(2e-3, 8e-3)});
    case 3:
      return Object("torus", Torus{random.uniform(11e-3, 14e-3), random.uniform(8e-3, 10e-3)});
    default:
      return Object("half_space", HalfSpace{});
  }
}

// Axes of long solids lie within 6 degrees of the skin; a half-space is tilted by the same.
Quaternion lying(Random& random, const Object& object) {
  const bool is_long = std::holds_alternative<Cylinder>(object.shape) || std::holds_alternative<Capsule>(object.shape);
  const Quaternion down = is_long ? axisAngle({1, 0, 0}, std::numbers::pi / 2) : Quaternion{1, 0, 0, 0};
  return random.tilt(std::holds_alternative<Torus>(object.shape) ? 0.0 : 0.1) * down;
}

void pressOn(Random& random, const GridPatch& patch, const Object& object, JacobianCase& contact) {
  // In the frame of the patch, so that a tilted patch is met face to face.
  Sensor alone = contact.sensor;
  alone.patches = {patch};
  alone.patches[0].X_SP = {};
  const double x = random.uniform(-0.4, 0.4) * patch.num_rows * patch.pitch[0],
               y = random.uniform(-0.4, 0.4) * patch.num_cols * patch.pitch[1];
  const bool flat = std::holds_alternative<HalfSpace>(object.shape);
  // A half-space tilted by 0.1 rad is met at a corner; deep enough for a contact beyond the corner.
  const double depth = flat ? random.uniform(1.2e-3, 1.8e-3) : random.uniform(0.7e-3, 1.2e-3);
  const Pose X_PO = poseAtDepth(alone, object, lying(random, object), x, y, depth);
  contact.objects.push_back(object);
  contact.X_SO.push_back(patch.X_SP * X_PO);
}

}  // namespace

std::vector<bool> reportingTaxels(const Sensor& sensor, const std::vector<double>& spread_force) {
  std::vector<bool> reports;
  for (std::size_t t = 0; t < spread_force.size(); ++t) {
    const double trigger = reference::triggerOf(sensor.readout, t);
    reports.push_back(trigger == 0 || reference::gainOf(sensor.readout, t) * spread_force[t] > trigger);
  }
  return reports;
}

Pose afterTwist(const Pose& X_SO, std::size_t k, double step) {
  Pose X_ST;  // of the moved sensor
  Vector3 axis{0, 0, 0};
  axis[k % 3] = 1;
  if (k < 3) {
    X_ST.position = scale(step, axis);
  } else {
    X_ST.rotation = axisAngle(axis, step);
  }
  return inverse(X_ST) * X_SO;
}

std::vector<reference::PlacedObject> JacobianCase::placed() const {
  std::vector<reference::PlacedObject> result;
  for (std::size_t n = 0; n < objects.size(); ++n) result.push_back({&objects[n], X_SO[n]});
  return result;
}

JacobianCase randomJacobianCase(Random& random, JacobianKind kind) {
  JacobianCase contact;
  Sensor& sensor = contact.sensor;
  sensor = gridSensor({.num_rows = random.integer(6, 10),
                       .num_cols = random.integer(6, 14),
                       .pitch_x = random.uniform(2.5e-3, 3.4e-3),
                       .pitch_y = random.uniform(2.5e-3, 3.4e-3),
                       .thickness = 4e-3});
  const double exponent = random.chance(0.7) ? 1 : random.uniform(1, 2);
  sensor.skin.law = Winkler{1e5 / std::pow(1e-3, exponent), exponent, 0};
  if (random.chance(0.7)) sensor.psf = gaussianPsf(random.uniform(0.3, 0.7), 3);
  sensor.patches[0].X_SP = {{random.uniform(-3e-3, 3e-3), random.uniform(-3e-3, 3e-3), random.uniform(-2e-3, 2e-3)}, random.tilt(0.2)};
  // Each taxel has a trigger of its own; the nominal trigger is 0, since a change of it would step all readings. Saturates at 64 N.
  sensor.readout.curve = {64};
  if (kind == JacobianKind::kPatches) {
    const int num_patches = random.integer(2, 3);
    for (int p = 1; p < num_patches; ++p) {
      sensor.patches.push_back(sensor.patches[0]);
      sensor.patches.back().num_rows = random.integer(6, 9);
      sensor.patches.back().X_SP = {{80e-3 * p, random.uniform(-5e-3, 5e-3), random.uniform(-5e-3, 5e-3)}, random.tilt(0.3)};
    }
  }
  const int num_taxels = numTaxels(sensor);
  for (int t = 0; t < num_taxels; ++t) {
    sensor.readout.taxel_gain.push_back(random.uniform(0.8, 1.2));
    sensor.readout.taxel_trigger.push_back(random.chance(0.9) ? 0 : random.uniform(0, 0.02));
  }
  if (kind == JacobianKind::kWalls) {
    const Object box("box", Box{{random.uniform(8e-3, 14e-3), random.uniform(8e-3, 14e-3), 10e-3}});
    const GridPatch& patch = sensor.patches[0];
    const Pose X_PO{{random.uniform(-4e-3, 4e-3), random.uniform(-4e-3, 4e-3), 5e-3 - random.uniform(0.8e-3, 1.2e-3)}, random.tilt(0.03)};
    contact.has_walls = true;
    contact.objects.push_back(box);
    contact.X_SO.push_back(patch.X_SP * X_PO);
    return contact;
  }
  for (const GridPatch& patch : sensor.patches) {
    Object object = roundSolid(random);
    // Large or infinite objects would also touch the other patches.
    while (kind == JacobianKind::kPatches && !std::holds_alternative<Sphere>(object.shape) &&
           !std::holds_alternative<Capsule>(object.shape)) {
      object = roundSolid(random);
    }
    pressOn(random, patch, object, contact);
  }
  return contact;
}

JacobianChanges centralDifferences(const JacobianCase& contact) {
  JacobianChanges changes;
  changes.patches.resize(contact.sensor.patches.size());
  double lever = 0;  // of the farthest taxel
  for (const Vector3& p_S : taxelPositions(contact.sensor)) lever = std::max(lever, length(p_S));
  for (std::size_t k = 0; k < 6; ++k) {
    const double way = contact.has_walls ? 2 * kJacobianStep : kJacobianStep;
    const double step = k < 3 ? way : std::min(kJacobianTurn, way / lever);
    // Richardson extrapolation of a step and half a step: the error is of fourth order. Not for walls, which cross borders of taxels within
    // a step.
    std::vector<std::pair<double, double>> sizes{{step, -1.0 / 3}, {step / 2, 4.0 / 3}};
    if (contact.has_walls) sizes = {{step, 1}};
    for (const auto& [size, weight] : sizes) {
      const AllFeatures before = featuresOf(moved(contact, k, -size)), after = featuresOf(moved(contact, k, size));
      if (changes.reports.empty()) changes.reports = before.reports;
      changes.triggers_hold = changes.triggers_hold && before.reports == changes.reports && after.reports == changes.reports;
      const double per = weight / (2 * size);
      addColumn(before.sensor, after.sensor, k, per, changes.sensor);
      addColumn(before.measured, after.measured, k, per, changes.measured);
      for (std::size_t p = 0; p < changes.patches.size(); ++p) addColumn(before.patches[p], after.patches[p], k, per, changes.patches[p]);
      for (std::size_t c = 0; c < 6; ++c) changes.contact_wrench[c][k] += per * (after.wrench[c] - before.wrench[c]);
    }
  }
  return changes;
}

void JacobianErrors::Entry::add(double error) {
  largest = std::max(largest, std::abs(error));
  sum_of_squares += error * error;
  ++count;
}

void JacobianErrors::add(const FeatureChanges& found, const FeatureChanges& expected, const JacobianScale& scale) {
  constexpr double kLeastConfidence = 0.2;  // below, an axis is hardly one
  for (const std::size_t first : {0u, 3u}) {
    const bool turns = first == 3;
    const double arm = turns ? scale.size + scale.lever : 1;
    double center = arm * std::max(1.0, scale.apart * std::abs(expected.total_force[2]) / scale.force);
    for (const auto& row : expected.center_of_pressure) center = std::max(center, largestOf(row, first));
    const double force = std::max(largestOf(expected.total_force, first), arm * std::abs(expected.total_force[2]));
    const double angle = std::max(largestOf(expected.edge_angle, first), arm / (scale.size * scale.confidence));
    for (std::size_t k = first; k < first + 3; ++k) {
      for (std::size_t axis = 0; axis < 3; ++axis) {
        entries_[turns].add((found.center_of_pressure[axis][k] - expected.center_of_pressure[axis][k]) / center);
      }
      entries_[2 + turns].add((found.total_force[k] - expected.total_force[k]) / force);
      if (scale.confidence > kLeastConfidence) entries_[4 + turns].add((found.edge_angle[k] - expected.edge_angle[k]) / angle);
    }
  }
}

void JacobianErrors::addWrench(const std::array<std::array<double, 6>, 6>& found, const std::array<std::array<double, 6>, 6>& expected,
                               const JacobianScale& scale) {
  double stiffness = 0;
  for (std::size_t c = 0; c < 3; ++c) stiffness = std::max(stiffness, largestOf(expected[c], 0));
  for (std::size_t c = 0; c < 6; ++c) {
    for (std::size_t k = 0; k < 6; ++k) {
      double largest = stiffness * std::pow(scale.size + scale.lever, (c >= 3) + (k >= 3));
      for (std::size_t other = c / 3 * 3; other < c / 3 * 3 + 3; ++other)
        largest = std::max(largest, largestOf(expected[other], k / 3 * 3));
      entries_[6 + (k >= 3)].add((found[c][k] - expected[c][k]) / largest);
    }
  }
}

double JacobianErrors::worst() const {
  double worst = 0;
  for (const std::size_t n : {0u, 1u, 2u, 3u, 6u, 7u}) worst = std::max(worst, entries_[n].largest);
  return worst;
}

double JacobianErrors::worstAngle() const {
  return std::max(entries_[4].largest, entries_[5].largest);
}

void JacobianErrors::print(const char* title) const {
  constexpr std::array<const char*, 8> kNames{"center by v", "center by w", "force by v",  "force by w",
                                              "angle by v",  "angle by w",  "wrench by v", "wrench by w"};
  for (std::size_t n = 0; n < entries_.size(); ++n) {
    const Entry& entry = entries_[n];
    if (entry.count == 0) continue;
    std::printf("%s, %s: largest %.2f %%, root mean square %.2f %%\n", title, kNames[n], 100 * entry.largest,
                100 * std::sqrt(entry.sum_of_squares / entry.count));
  }
}

}  // namespace taxelsim::support
