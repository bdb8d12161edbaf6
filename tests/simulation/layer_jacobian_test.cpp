// The tactile Jacobian of an elastic layer: the twin against differences of moved sensors, the device against the twin.
#include "layer_scene.h"
#include "reference/tactile_jacobian.h"
#include "support/cases.h"
#include "support/jacobian_cases.h"
#include "support/test.h"

namespace taxelsim {
namespace {

using reference::ByTwist;
using reference::TactileJacobian;
using support::layerSensor;
using support::Random;
using support::Touch;

constexpr double kDt = 0.01;      // s
constexpr double kStep = 3e-5;    // m, and as far as the farthest taxel moves by a turn
constexpr double kExtent = 0.02;  // m, half of the array's diagonal or so
constexpr OutputOptions kAll{.tactile_jacobian = true, .clean_tactile_jacobian = true};

using Block = std::vector<double>;

constexpr std::size_t kNumBlocks = 15;

// Blocks for the comparison: derivatives of centre of pressure, force, edge angle, and force and torque of the wrench, by sliding (v along
// x and y), pressing (v along z) and rotation (w).
template <typename Center, typename Force, typename Angle, typename Wrench>
std::vector<Block> blocksOf(Center center, Force force, Angle angle, Wrench wrench) {
  std::vector<Block> blocks;
  for (const auto& [first, end] : {std::pair<std::size_t, std::size_t>{0, 2}, {2, 3}, {3, 6}}) {
    Block of_center, of_force, of_angle, of_push, of_torque;
    for (std::size_t k = first; k < end; ++k) {
      for (const std::size_t axis : {0, 1}) of_center.push_back(center(axis, k));
      of_force.push_back(force(k));
      of_angle.push_back(angle(k));
      for (const std::size_t axis : {0, 1, 2}) of_push.push_back(wrench(axis, k));
      for (const std::size_t axis : {3, 4, 5}) of_torque.push_back(wrench(axis, k));
    }
    blocks.insert(blocks.end(), {of_center, of_force, of_angle, of_push, of_torque});
  }
  return blocks;
}

std::vector<Block> blocksOf(const TactileJacobian& twin) {
  return blocksOf([&](std::size_t axis, std::size_t k) { return twin.clean.center_of_pressure[axis][k]; },
                  [&](std::size_t k) { return twin.clean.total_force_by_twist[k]; },
                  [&](std::size_t k) { return twin.clean.edge_angle[k]; },
                  [&](std::size_t axis, std::size_t k) { return twin.contact_wrench[axis][k]; });
}

std::vector<Block> blocksOf(const FrameView& frame, std::size_t i) {
  const CleanTactileJacobianView& view = frame.ground_truth.jacobian;
  const std::size_t row = i * static_cast<std::size_t>(view.num_rows);
  return blocksOf([&](std::size_t axis, std::size_t k) { return view.center_of_pressure[18 * row + 6 * axis + k]; },
                  [&](std::size_t k) { return view.total_force[6 * row + k]; }, [&](std::size_t k) { return view.edge_angle[6 * row + k]; },
                  [&](std::size_t axis, std::size_t k) { return view.contact_wrench[36 * i + 6 * axis + k]; });
}

// Largest error of each block, relative to the largest entry of the block, or to `floors` if that is larger.
std::vector<double> errorsOf(const std::vector<Block>& found, const std::vector<Block>& expected, const std::vector<double>& floors) {
  std::vector<double> errors;
  for (std::size_t b = 0; b < found.size(); ++b) {
    double largest = floors[b], worst = 0;
    for (std::size_t n = 0; n < found[b].size(); ++n) {
      largest = std::max(largest, std::abs(expected[b][n]));
      worst = std::max(worst, std::abs(found[b][n] - expected[b][n]));
    }
    errors.push_back(worst / largest);
  }
  return errors;
}

// Typical sizes of the blocks: sliding moves the centre by the same distance, pressing enlarges the contact by the relative growth of the
// force, rotation combines both at half the array.
std::vector<double> floorsFor(const reference::FeatureJacobian& row) {
  const double size = std::sqrt(row.trace), stiffness = std::abs(row.total_force_by_twist[2]),
               growth = stiffness / row.features.total_force;
  const std::vector<double> slide{1, stiffness, 1 / size / row.features.edge_confidence, stiffness, stiffness * size};
  const std::vector<double> press{size * growth, stiffness, growth / row.features.edge_confidence, stiffness, stiffness * size};
  std::vector<double> floors = slide;
  floors.insert(floors.end(), press.begin(), press.end());
  for (std::size_t b = 0; b < press.size(); ++b) floors.push_back(std::max(slide[b], press[b]) * size);
  return floors;
}

reference::Frame frameOf(const Sensor& sensor, const std::vector<Object>& objects, const Touch& touch) {
  return reference::simulateFrame(sensor, {.objects = touch.placed(objects)});
}

// Central differences of the features of the same solver for a moved sensor.
std::vector<Block> differencesOf(const Sensor& sensor, const std::vector<Object>& objects, const Touch& touch) {
  std::array<std::array<reference::Frame, 2>, 6> frames;
  std::array<double, 6> steps{};
  for (std::size_t k = 0; k < 6; ++k) {
    steps[k] = k < 3 ? kStep : kStep / kExtent;
    for (const std::size_t side : {0, 1}) {
      Touch moved = touch;
      for (Pose& X_SO : moved.X_SO) X_SO = support::afterTwist(X_SO, k, side == 0 ? -steps[k] : steps[k]);
      frames[k][side] = frameOf(sensor, objects, moved);
    }
  }
  const auto rate = [&](std::size_t k, auto value) { return (value(frames[k][1]) - value(frames[k][0])) / (2 * steps[k]); };
  return blocksOf(
      [&](std::size_t axis, std::size_t k) { return rate(k, [&](const reference::Frame& f) { return f.clean.center_of_pressure[axis]; }); },
      [&](std::size_t k) { return rate(k, [](const reference::Frame& f) { return f.clean.total_force; }); },
      [&](std::size_t k) {
        return std::remainder(frames[k][1].clean.edge_angle - frames[k][0].clean.edge_angle, std::acos(-1)) / (2 * steps[k]);
      },
      [&](std::size_t axis, std::size_t k) { return rate(k, [&](const reference::Frame& f) { return f.wrench[axis]; }); });
}

struct LayerContactCase {
  Sensor sensor;
  std::vector<Object> objects;
  Touch touch;
};

// A capsule across the array with a distinct principal axis, covering several nodes, slightly tilted.
LayerContactCase randomCase(Random& random, int samples_per_taxel) {
  const auto base = random.uniform(0, 1) < 0.5 ? ElasticLayer::Base::kBonded : ElasticLayer::Base::kHalfSpace;
  LayerContactCase contact{layerSensor({.base = base, .margin = random.uniform(0, 1) < 0.5 ? 0 : 3.4e-3}), {}, {}};
  contact.sensor.samples_per_taxel = samples_per_taxel;
  const double radius = random.uniform(8e-3, 16e-3), depth = random.uniform(0.3e-3, 0.7e-3);
  contact.objects = {Object(Capsule{.radius = radius, .length = random.uniform(4e-3, 8e-3)})};
  const Quaternion laid =
      axisAngle({0, 0, 1}, random.uniform(-1.5, 1.5)) * axisAngle({1, 0, 0}, std::acos(-1) / 2 + random.uniform(-0.05, 0.05));
  contact.touch = {{0}, {{{random.uniform(-3e-3, 3e-3), random.uniform(-3e-3, 3e-3), radius - depth}, laid}}};
  return contact;
}

// Nodes enter and leave the contact one by one, each with a force of about the 3/2 power of its size, and slopes are differences of
// neighbours: the relative error is the square of the spacing over the half-width of the contact, about (1.7 / 4)^2 and (0.85 / 4)^2.
TEST(LayerJacobianTwin, MatchesDifferencesOfMovedSensors) {
  for (const auto& [samples, allowed] : {std::pair{2, 0.15}, {4, 0.05}}) {
    Random random(3);
    std::vector<double> worst(kNumBlocks, 0);
    for (int n = 0; n < 6; ++n) {
      const LayerContactCase contact = randomCase(random, samples);
      const reference::Frame frame = frameOf(contact.sensor, contact.objects, contact.touch);
      ASSERT_GT(frame.clean.total_force, 0);
      const TactileJacobian twin = reference::tactileJacobian(contact.sensor, frame);
      const std::vector<double> errors =
          errorsOf(blocksOf(twin), differencesOf(contact.sensor, contact.objects, contact.touch), floorsFor(twin.clean));
      for (std::size_t b = 0; b < worst.size(); ++b) worst[b] = std::max(worst[b], errors[b]);
    }
    for (std::size_t b = 0; b < worst.size(); ++b) EXPECT_LE(worst[b], allowed) << samples << " samples, block " << b;
    std::printf("%d x %d samples; centre, force, angle, push and torque by sliding, pressing, turning:", samples, samples);
    for (const double error : worst) std::printf(" %.3f", error);
    std::printf("\n");
  }
}

// The conjugate gradients of the device stop at 1e-4; its contact may differ by a node at the rim, one of some hundreds.
constexpr double kLikeTwin = 0.02;

TEST(LayerJacobianOnEveryDriver, MatchesTheTwin) {
  std::vector<double> worst(kNumBlocks, 0);
  for (int n = 0; n < support::numCases(2, 6); ++n) {
    Random random(static_cast<std::uint64_t>(20 + n));
    const LayerContactCase contact = randomCase(random, 2 + n % 2);
    Simulator simulator = support::makeSimulator(contact.sensor, contact.objects, {.outputs = kAll});
    const FrameView view = support::stepOnce(simulator, {contact.touch}, kDt);
    const reference::Frame frame = frameOf(contact.sensor, contact.objects, contact.touch);
    const TactileJacobian twin = reference::tactileJacobian(contact.sensor, frame);
    const std::vector<double> errors = errorsOf(blocksOf(view, 0), blocksOf(twin), floorsFor(twin.clean));
    for (std::size_t b = 0; b < worst.size(); ++b) worst[b] = std::max(worst[b], errors[b]);
  }
  for (std::size_t b = 0; b < worst.size(); ++b) EXPECT_LE(worst[b], kLikeTwin) << "block " << b;
}

// A batch with loads computes heights in another variant of the contact pass. On a half-space the skin does not bulge, so that no height
// above the skin is within reach, but the slopes at the rim of the contact need them.
TEST(LayerJacobianOnEveryDriver, IndependentOfLoadDrivenNeighbours) {
  constexpr int kNumInstances = 9;
  const Sensor sensor = layerSensor({.base = ElasticLayer::Base::kHalfSpace}, {.num_rows = 3, .num_cols = 4, .samples_per_taxel = 2});
  const std::vector<Object> objects{Object("ball", Sphere{6e-3}), Object("box", Box{{8e-3, 6e-3, 1e-2}})};
  Random random(7);
  std::vector<Touch> touches{{{0}, {{.position = {0, 0, 5.5e-3}}}}};
  while (touches.size() < kNumInstances) touches.push_back(support::randomTouch(random, sensor, objects));
  const Model model(support::sharedDevice(), {.sensor = sensor, .objects = objects});
  Simulator pose_driven(model, {.num_instances = kNumInstances, .outputs = kAll});
  Simulator mixed(model, {.num_instances = kNumInstances, .outputs = kAll});
  mixed.setLoad(0, 0.5f);
  bool has_jacobian = false;
  for (int frame = 0; frame < 2; ++frame) {
    for (Simulator* simulator : {&pose_driven, &mixed}) {
      support::setTouches(*simulator, touches);
      simulator->step(kDt);
    }
    const FrameView expected = pose_driven.read(), found = mixed.read();
    EXPECT_EQ(found.ground_truth.load_reached[0], 1);
    for (int i = 1; i < kNumInstances; ++i) {
      EXPECT_EQ(support::bitsOf(found, i, kNumInstances), support::bitsOf(expected, i, kNumInstances))
          << "instance " << i << ", frame " << frame;
      has_jacobian = has_jacobian || expected.ground_truth.jacobian.contact_wrench[static_cast<std::size_t>(36 * i + 6 * 2 + 2)] != 0;
    }
    for (Touch& touch : touches) touch.X_SO[0] = support::nextPose(random, touch.X_SO[0], 2e-4);
  }
  EXPECT_TRUE(has_jacobian);
}

}  // namespace
}  // namespace taxelsim
