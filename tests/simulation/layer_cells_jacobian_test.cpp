// The tactile Jacobian of an elastic layer with area sampling: the twin against its own differences, the device against the twin and
// against differences of its frames.
#include "reference/tactile_jacobian.h"
#include "simulation/comparison.h"
#include "simulation/layer_scene.h"
#include "support/cases.h"
#include "support/jacobian_cases.h"
#include "support/test.h"

namespace taxelsim {
namespace {

using support::layerSensor;
using support::Random;
using support::Touch;

constexpr double kDt = 0.01;       // s
constexpr double kLength = 0.012;  // m, of objects
constexpr double kLever = 3e-3;    // m: a rotation moves what is in contact by about as much
constexpr OutputOptions kJacobians{.clean_tactile_jacobian = true, .taxel_jacobian = true};

// Cells of 0.85 mm.
Sensor cellSensor(ElasticLayer::Base base = ElasticLayer::Base::kBonded) {
  Sensor sensor = layerSensor({.poisson_ratio = base == ElasticLayer::Base::kBonded ? 0.49 : 0.3, .base = base},
                              {.num_rows = 3, .num_cols = 3, .pitch_x = 3.4e-3, .pitch_y = 3.4e-3, .samples_per_taxel = 4});
  sensor.depth_sampling = DepthSampling::kArea;
  return sensor;
}

// A pin as a prism along y, of which the twin clips facets.
Object prismPin(double radius) {
  constexpr int kSides = 48;
  std::vector<std::array<double, 2>> outline;
  for (int i = 0; i < kSides; ++i) {
    const double angle = 2 * std::numbers::pi * i / kSides;
    outline.push_back({radius * std::cos(angle), radius * std::sin(angle)});
  }
  return {"pin", support::prism(outline, kLength)};
}

Touch placeOf(Random& random, const Quaternion& standing, double tilt = 0) {
  const double yaw = random.uniform(-1, 1), towards = random.uniform(-3, 3);
  const Quaternion turned = axisAngle({std::cos(towards), std::sin(towards), 0}, tilt) * axisAngle({0, 0, 1}, yaw) * standing;
  const double depth = random.uniform(0.4e-3, 0.9e-3);
  return {{0}, {{{random.uniform(-1.7e-3, 1.7e-3), random.uniform(-1.7e-3, 1.7e-3), kLength / 2 - depth}, turned}}};
}

double stepOf(std::size_t k, double length) {
  return k < 3 ? length : length / kLever;
}

Touch afterTwist(Touch touch, std::size_t k, double step) {
  for (Pose& X_SO : touch.X_SO) X_SO = support::afterTwist(X_SO, k, step);
  return touch;
}

// Sums of squares of differences and of what a Jacobian differs from them, per coordinate of the twist and place.
struct Errors {
  std::array<std::vector<double>, 6> error, size;
  void beginPlace() {
    for (std::size_t k = 0; k < 6; ++k) {
      error[k].push_back(0);
      size[k].push_back(0);
    }
  }
  void add(std::size_t k, double found, double expected) {
    error[k].back() += (found - expected) * (found - expected);
    size[k].back() += expected * expected;
  }
  // Median over the places, of the root mean square of the differences.
  double of(std::size_t k) const {
    std::vector<double> sorted = error[k];
    std::sort(sorted.begin(), sorted.end());
    const double mean = std::accumulate(size[k].begin(), size[k].end(), 0.0) / static_cast<double>(sorted.size());
    return std::sqrt(sorted[sorted.size() / 2] / std::max(mean, 1e-30));
  }
};

void print(const char* name, const Errors& errors) {
  std::printf("%s by vx vy vz wx wy wz:", name);
  for (std::size_t k = 0; k < 6; ++k) std::printf(" %.3f", errors.of(k));
  std::printf("\n");
}

// ---- the twin ----

// An outline is a straight line in each cell. The area of a cell that a round pin or a corner of a box cuts is right, but not where it
// leaves the cell: an arc of radius r over a cell of width h departs from its chord by h^2 / (8 r), 0.05 h for 2 mm. Forces of single
// taxels, between which the outline passes, have a few times this error; torques, in which these errors cancel, less. Without the motion of
// the outline the error of both is 1 and 0.8.
TEST(LayerCellsJacobianTwin, MatchesDifferencesOfMovedSensors) {
  constexpr double kStep = 1e-6, kForceError = 0.25, kTorqueError = 0.12;
  constexpr int kPlaces = 3;
  const Quaternion standing = axisAngle({1, 0, 0}, std::numbers::pi / 2);
  const Sensor sensor = cellSensor();
  for (const bool is_pin : {true, false}) {
    const std::vector<Object> objects{is_pin ? prismPin(2e-3) : Object("box", Box{{3e-3, 5e-3, kLength}})};
    Random random(11);
    Errors of_taxels, of_torque;
    for (int n = 0; n < kPlaces; ++n) {
      of_taxels.beginPlace();
      of_torque.beginPlace();
      const Touch touch = placeOf(random, is_pin ? standing : Quaternion{1, 0, 0, 0});
      const auto frameOf = [&](const Touch& at) { return reference::simulateFrame(sensor, {.objects = at.placed(objects)}); };
      const reference::Frame frame = frameOf(touch);
      const reference::TactileJacobian twin = reference::tactileJacobian(sensor, frame);
      for (const std::size_t k : {0, 1, 2, 5}) {
        const double step = stepOf(k, kStep);
        const reference::Frame low = frameOf(afterTwist(touch, k, -step)), high = frameOf(afterTwist(touch, k, step));
        for (std::size_t t = 0; t < twin.taxel_force.size(); ++t) {
          of_taxels.add(k, twin.taxel_force[t][k], (high.contact.taxel_force[t] - low.contact.taxel_force[t]) / (2 * step));
        }
        for (const std::size_t axis : {3, 4}) {
          of_torque.add(k, twin.contact_wrench[axis][k], (high.wrench[axis] - low.wrench[axis]) / (2 * step));
        }
      }
    }
    for (const std::size_t k : {0, 1, 2, 5}) {
      EXPECT_LT(of_taxels.of(k), kForceError) << "coordinate " << k << (is_pin ? " of a pin" : " of a box");
      EXPECT_LT(of_torque.of(k), kTorqueError) << "coordinate " << k << (is_pin ? " of a pin" : " of a box");
    }
    print(is_pin ? "twin, pin, taxels" : "twin, box, taxels", of_taxels);
    print(is_pin ? "twin, pin, torque" : "twin, box, torque", of_torque);
  }
}

// ---- the device and the twin ----

// Centroids have 11 bits of a cell, so that the direction of an outline near the middle of its cell's centroid is off by some parts in a
// thousand, and the device's conjugate gradients stop at 1e-4.
constexpr double kLikeTwin = 0.03;

void expectLikeTwin(const FrameView& frame, std::size_t i, const reference::TactileJacobian& twin) {
  const std::size_t num_taxels = twin.taxel_force.size();
  for (std::size_t k = 0; k < 6; ++k) {
    double largest = 0;
    for (std::size_t t = 0; t < num_taxels; ++t) largest = std::max(largest, std::abs(twin.taxel_force[t][k]));
    for (std::size_t t = 0; t < num_taxels; ++t) {
      EXPECT_NEAR(frame.ground_truth.taxel_jacobian[(6 * i + k) * num_taxels + t], twin.taxel_force[t][k], kLikeTwin * largest)
          << "taxel " << t << ", coordinate " << k;
    }
    for (std::size_t axis = 0; axis < 6; ++axis) {
      const double reach = axis < 3 ? 1 : 2 * kLever;
      EXPECT_NEAR(frame.ground_truth.jacobian.contact_wrench[36 * i + 6 * axis + k], twin.contact_wrench[axis][k],
                  2 * kLikeTwin * largest * reach)
          << "axis " << axis << ", coordinate " << k;
    }
  }
}

// Pins and boxes, level and tilted, without and with relaxation: pressed, held and slid.
TEST(LayerCellsJacobianOnEveryDriver, MatchesTheTwin) {
  constexpr int kInstances = 4, kFrames = 3;
  const std::vector<Object> objects{prismPin(1e-3), Object("box", Box{{3e-3, 5e-3, kLength}})};
  const Quaternion standing = axisAngle({1, 0, 0}, std::numbers::pi / 2);
  for (const bool relaxes : {false, true}) {
    Sensor sensor = cellSensor(relaxes ? ElasticLayer::Base::kBonded : ElasticLayer::Base::kHalfSpace);
    sensor.patches[0].X_SP = {{0.001, -0.002, 0.0005}, {std::cos(0.2), 0, 0, std::sin(0.2)}};
    if (relaxes) sensor.skin.relaxation = {{0.5, 0.02}};
    Simulator simulator = support::makeSimulator(sensor, objects, {.num_instances = kInstances, .outputs = kJacobians});
    Random random(21);
    std::vector<Touch> touches;
    for (int i = 0; i < kInstances; ++i) {
      touches.push_back(placeOf(random, i % 2 == 0 ? standing : Quaternion{1, 0, 0, 0}, i < 2 ? 0 : 0.02));
      touches.back().ids = {i % 2};
    }
    std::vector<reference::SkinHistory> skins(kInstances, reference::SkinHistory(sensor.skin.relaxation));
    for (int f = 0; f < (relaxes ? kFrames : 1); ++f) {
      const FrameView frame = support::stepOnce(simulator, touches, kDt);
      for (std::size_t i = 0; i < kInstances; ++i) {
        SCOPED_TRACE((relaxes ? "relaxing, frame " : "frame ") + std::to_string(f) + " instance " + std::to_string(i));
        const auto placed = touches[i].placed(objects);
        const reference::Frame twin =
            reference::simulateFrame(sensor, {.objects = placed, .dt = kDt, .skin = relaxes ? &skins[i] : nullptr});
        expectLikeTwin(frame, i, reference::tactileJacobian(sensor, twin));
        if (f == 1) touches[i].X_SO[0].position[0] += 0.1e-3;
      }
    }
  }
}

// ---- differences of the device's frames ----

// Level pins and a box at many places on the array, as the twin against its differences. With points the forces are those of the samples
// that the outline has passed: the Jacobian does not include them, an error of 1.
TEST(LayerCellsJacobianOnEveryDriver, MatchesDifferencesOfItsFrames) {
  constexpr int kPlaces = 24;
  constexpr double kStep = 2e-5;  // m: 24 units of a centroid's place
  constexpr double kForceError = 0.2, kTorqueError = 0.1;
  const std::vector<Object> objects{Cylinder{1e-3, kLength}, Box{{3e-3, 5e-3, kLength}}};
  const Sensor sensor = cellSensor();
  const Model model(support::sharedDevice(), {.sensor = sensor, .objects = objects});
  const auto num_taxels = static_cast<std::size_t>(numTaxels(sensor));
  constexpr std::array<std::size_t, 4> kCoordinates{0, 1, 2, 5};
  constexpr std::size_t kPoses = 1 + 2 * kCoordinates.size();
  Simulator simulator(model, {.num_instances = static_cast<int>(kPlaces * kPoses), .outputs = kJacobians});
  for (const int id : {0, 1}) {
    Random random(11);
    std::vector<Touch> touches;
    for (int n = 0; n < kPlaces; ++n) {
      Touch touch = placeOf(random, {1, 0, 0, 0});
      touch.ids = {id};
      touches.push_back(touch);
      for (const std::size_t k : kCoordinates) {
        for (const int side : {-1, 1}) touches.push_back(afterTwist(touch, k, side * stepOf(k, kStep)));
      }
    }
    const GroundTruthView truth = support::stepOnce(simulator, touches, kDt).ground_truth;
    Errors of_taxels, of_torque;
    for (std::size_t n = 0; n < kPlaces; ++n) {
      const std::size_t first = n * kPoses;
      of_taxels.beginPlace();
      of_torque.beginPlace();
      for (std::size_t c = 0; c < kCoordinates.size(); ++c) {
        const std::size_t k = kCoordinates[c], low = first + 1 + 2 * c, high = low + 1;
        const double step = stepOf(k, kStep);
        for (std::size_t t = 0; t < num_taxels; ++t) {
          const double change = truth.tactile_normal_force[high * num_taxels + t] - truth.tactile_normal_force[low * num_taxels + t];
          of_taxels.add(k, truth.taxel_jacobian[(6 * first + k) * num_taxels + t], change / (2 * step));
        }
        for (const std::size_t axis : {3, 4}) {
          const double change = truth.contact_wrench[6 * high + axis] - truth.contact_wrench[6 * low + axis];
          of_torque.add(k, truth.jacobian.contact_wrench[36 * first + 6 * axis + k], change / (2 * step));
        }
      }
    }
    for (const std::size_t k : kCoordinates) {
      EXPECT_LT(of_taxels.of(k), kForceError) << "coordinate " << k << " of object " << id;
      EXPECT_LT(of_torque.of(k), kTorqueError) << "coordinate " << k << " of object " << id;
    }
    print(id == 0 ? "pin, taxels" : "box, taxels", of_taxels);
    print(id == 0 ? "pin, torque" : "box, torque", of_torque);
  }
}

}  // namespace
}  // namespace taxelsim
