// Shear of the law `elastic_layer` on the device against the twin on random paths, within bounds that are updated along each path.
#include "base/vector3.h"
#include "reference/elastic_layer.h"
#include "simulation/layer_scene.h"
#include "support/cases.h"
#include "support/test.h"

namespace taxelsim {
namespace {

using reference::PlacedObject;
using reference::PressedSkin;
using support::LayerOptions;
using support::layerSensor;
using support::Random;
using support::Touch;

constexpr double kDt = 1e-3;  // s
constexpr int kNumSteps = 6;

Sensor shearingSensor(Random& random, const LayerOptions& skin, int samples) {
  Sensor sensor = layerSensor(skin, {.num_rows = 8, .num_cols = 10, .samples_per_taxel = samples});
  const double shear_modulus = support::kModulus / (2 * (1 + skin.poisson_ratio));
  sensor.skin.friction = {shear_modulus / skin.thickness * std::pow(10, random.uniform(-0.5, 2)), random.uniform(0.1, 1.5)};
  return sensor;
}

// A displacement takes two rotations and a dozen float32 products, with an angle over arms of up to kArm; friction adds a few.
constexpr double kRounding = 64 * support::kUlp;
constexpr double kArm = 0.2;  // m
// Two surfaces closer than this may be in either order: heights are rounded, and on steep objects also positions.
constexpr double kNear = 4e-6;  // m

// Width of the bounds relative to the cone; wider ones would prove little.
constexpr double kLoosest = 0.02;

// State of one instance after a step, with bounds.
struct Tracked {
  reference::FrictionState state;
  std::vector<double> error;  // (nodes), Pa: how far the device's traction may be off
  std::vector<bool> sure;     // (nodes): that the twin's object is the one that touches
};

std::vector<bool> surelyLowest(const Sensor& sensor, const std::vector<PlacedObject>& placed) {
  const LayerNodes nodes = layerNodes(sensor);
  std::vector<std::vector<double>> heights;
  for (const PlacedObject& one : placed) heights.push_back(reference::layerHeights(sensor, nodes, {&one, 1}));
  std::vector<bool> sure(static_cast<std::size_t>(nodes.num_rows * nodes.num_cols), true);
  for (std::size_t n = 0; n < sure.size(); ++n) {
    double lowest = heights[0][n];
    for (const auto& own : heights) lowest = std::min(lowest, own[n]);
    int rivals = 0, bottomless = 0;
    for (const auto& own : heights) {
      rivals += std::max(own[n], -sensor.skin.thickness) < std::max(lowest, -sensor.skin.thickness) + kNear ? 1 : 0;
      bottomless += own[n] < -sensor.skin.thickness - kNear ? 1 : 0;
    }
    sure[n] = rivals <= 1 || rivals == bottomless;
  }
  return sure;
}

// Share of a step after touch: `descent` (m) per step, `depth` (m) below the skin at its end.
double shareInTouch(double depth, double descent) {
  return descent > 0 ? std::clamp(depth / descent, 0.0, 1.0) : 1;
}

// The twin's shear for pressures with an error of `pressure_error` (Pa), and the bound of its error. The cone is convex, so a step keeps
// the error of a node's traction, except for the rounding of the displacement, the share of a first step before touch and the width of the
// cone. If it is uncertain whether or by which object a node was touched, any traction inside the cone is allowed.
reference::ContactShear advance(const Sensor& sensor, const std::vector<PlacedObject>& placed, const PressedSkin& skin,
                                double pressure_error, Tracked& tracked) {
  const auto [stiffness, mu] = sensor.skin.friction;
  const Pose& X_SP = sensor.patches[0].X_SP;
  const reference::ContactShear shear = contactShear(sensor, placed, skin, tracked.state, kDt);
  Tracked now{shear.state, std::vector<double>(skin.points.size(), 0), surelyLowest(sensor, placed)};
  const bool is_first = tracked.state.objects.empty();
  for (std::size_t n = 0; n < skin.points.size(); ++n) {
    const double cone = mu * (skin.pressure[n] + pressure_error);
    if (skin.pressure[n] <= pressure_error) now.sure[n] = false;
    if (is_first) continue;
    const int number = skin.touching[n];
    const bool was_sure = number != reference::kNoContact && (tracked.sure[n] || (pressure_error == 0 && tracked.state.touching[n] < 0));
    if (!now.sure[n] || !was_sure) {
      now.error[n] = 2 * cone * (skin.pressure[n] + pressure_error > 0 ? 1 : 0);
      continue;
    }
    const auto slot = static_cast<std::size_t>(number);
    const Pose &from = tracked.state.objects[slot].X_SO, &to = placed[slot].X_SO;
    const Vector3 p_S = X_SP * Vector3{skin.points[n].position_P[0], skin.points[n].position_P[1], -skin.d[n]};
    const Vector3 u = rotate(inverse(X_SP).rotation, subtract(to * (inverse(from) * p_S), p_S));
    const Quaternion turn = to.rotation * inverse({{0, 0, 0}, from.rotation}).rotation;
    const double angle = 2 * std::hypot(turn[1], turn[2], turn[3]);
    const double margin = 2 * support::kMarginZ;  // of a height, and of an offset along z
    double way = kRounding * (length(u) + angle * kArm) + angle * margin;
    if (tracked.state.touching[n] != number) {
      way += std::hypot(u[0], u[1]) * (shareInTouch(skin.d[n] + margin, -u[2] - way) - shareInTouch(skin.d[n] - margin, -u[2] + way));
    }
    const double before = tracked.state.touching[n] == number ? tracked.error[n] : 0;
    now.error[n] = std::min(2 * cone, before + stiffness * way + mu * pressure_error + kRounding * cone);
  }
  tracked = now;
  return shear;
}

// The twin's skin under the device's own pressures, for a sensor with one node per taxel and a margin.
PressedSkin underItsPressures(const Sensor& sensor, const std::vector<PlacedObject>& placed, std::span<const float> taxel_force) {
  const LayerNodes nodes = layerNodes(sensor);
  reference::LayerContact contact;
  for (const double height : reference::layerHeights(sensor, nodes, placed)) {
    contact.overlap.push_back(std::min(-height, sensor.skin.thickness));
  }
  contact.solution.pressure.assign(contact.overlap.size(), 0);
  for (std::size_t t = 0; t < taxel_force.size(); ++t) {
    const std::size_t rows = t / static_cast<std::size_t>(sensor.patches[0].num_cols),
                      cols = t % static_cast<std::size_t>(sensor.patches[0].num_cols);
    const std::size_t node = (rows + static_cast<std::size_t>(nodes.margin_rows)) * static_cast<std::size_t>(nodes.num_cols) + cols +
                             static_cast<std::size_t>(nodes.margin_cols);
    contact.solution.pressure[node] = taxel_force[t] / nodes.area();
  }
  return pressedNodes(sensor, placed, contact);
}

struct PathKind {
  LayerOptions skin;
  int num_slots = 1;
  bool with_loads = false;
  double patch_tilt = 0;  // rad
};

// Simulates a batch along random paths and calls `check(instance, placed, frame)` for every frame.
template <typename Check>
void runPath(Random& random, const PathKind& kind, const Sensor& sensor, Check&& check) {
  constexpr int kNumInstances = 3;
  const std::vector<Object> objects = support::roundObjects(random);
  std::vector<Touch> touches(kNumInstances);
  std::vector<float> loads;
  for (Touch& touch : touches) {
    touch = support::randomTouch(random, sensor, objects, kind.num_slots);
    loads.push_back(kind.with_loads ? static_cast<float>(random.uniform(0.05, 2)) : kPoseDriven);
  }
  const int workgroups[] = {0, 4, 8, 16, 32, 64};
  const Model model(support::sharedDevice(), {.sensor = sensor, .objects = objects, .contact_workgroup = workgroups[random.integer(0, 5)]});
  Simulator simulator(model, {.num_instances = kNumInstances, .num_slots = kind.num_slots});
  simulator.setLoads(loads);
  for (int step = 0; step < kNumSteps; ++step) {
    const FrameView frame = support::stepOnce(simulator, touches, kDt);
    support::expectWellFormed(frame, sensor, kNumInstances);
    for (std::size_t i = 0; i < kNumInstances; ++i) {
      SCOPED_TRACE("step " + std::to_string(step) + ", instance " + std::to_string(i));
      check(i, touches[i].placed(objects, frame.ground_truth.load_offset[i]), frame);
    }
    for (Touch& touch : touches) {
      for (Pose& X_SO : touch.X_SO) X_SO = support::nextPose(random, X_SO, 0.1e-3);
    }
  }
}

// Farthest node from S's origin, m.
constexpr double kReach = 0.04;

class LayerShearTwinSeeds : public ::testing::TestWithParam<int> {
 protected:
  // Compares node by node: the twin shears under the device's own pressures, so only rounding remains.
  static void run(const PathKind& kind, int seed) {
    Random random(static_cast<std::uint64_t>(seed));
    Sensor sensor = shearingSensor(random, kind.skin, 1);
    sensor.patches[0].X_SP = {{0.003, -0.002, 0.001}, axisAngle({0, 0, 1}, 0.8)};
    if (kind.patch_tilt > 0) sensor.patches[0].X_SP.rotation = axisAngle({1, 0.5, 0.2}, kind.patch_tilt);
    const double mu = sensor.skin.friction.friction_coefficient;
    const std::size_t num_taxels = static_cast<std::size_t>(numTaxels(sensor));
    std::vector<Tracked> tracked(3);
    double shear_seen = 0, normal_seen = 0, error_seen = 0;
    runPath(random, kind, sensor, [&](std::size_t i, const std::vector<PlacedObject>& placed, const FrameView& frame) {
      const GroundTruthView& truth = frame.ground_truth;
      const auto normal = truth.tactile_normal_force.subspan(i * num_taxels, num_taxels);
      const PressedSkin skin = underItsPressures(sensor, placed, normal);
      const reference::ContactShear twin = advance(sensor, placed, skin, 0, tracked[i]);
      double all = 0, error = 0;
      for (std::size_t n = 0; n < skin.points.size(); ++n) {
        if (skin.points[n].taxel == reference::kNoTaxel) continue;
        const auto t = static_cast<std::size_t>(skin.points[n].taxel);
        const double slack = tracked[i].error[n] * skin.points[n].area + 1e-9;
        for (std::size_t axis = 0; axis < 2; ++axis) {
          EXPECT_NEAR(truth.tactile_shear_force[2 * (i * num_taxels + t) + axis], twin.taxel_force[t][axis], slack) << "taxel " << t;
        }
        all += normal[t];
        error += slack;
      }
      shear_seen += std::hypot(twin.wrench[0], twin.wrench[1], twin.wrench[2]);
      normal_seen += mu * all;
      error_seen += error;
      if (kind.skin.margin > 0) return;
      // Subtracts the pressures: the rest of the wrench is shear.
      const Vector3 z = rotate(sensor.patches[0].X_SP.rotation, {0, 0, 1});
      double normal_force = 0;
      for (std::size_t axis = 0; axis < 3; ++axis) normal_force -= truth.contact_wrench[6 * i + axis] * z[axis];
      EXPECT_NEAR(normal_force, all, support::kRelativeMoment * all + support::kAbsoluteForce);
      Vector3 torque{0, 0, 0};
      for (std::size_t n = 0; n < skin.points.size(); ++n) {
        torque = add(torque, cross(sensor.patches[0].X_SP * skin.points[n].position_P, scale(-skin.pressure[n] * skin.points[n].area, z)));
      }
      const double slack = error + support::kRelativeMoment * (1 + mu) * all + support::kAbsoluteForce;
      for (std::size_t axis = 0; axis < 3; ++axis) {
        EXPECT_NEAR(truth.contact_wrench[6 * i + axis] + all * z[axis], twin.wrench[axis], slack) << "force " << axis;
        // Shear acts at the surface, at most one thickness deep.
        EXPECT_NEAR(truth.contact_wrench[6 * i + 3 + axis] - torque[axis], twin.wrench[3 + axis], slack * kReach) << "torque " << axis;
      }
    });
    EXPECT_GT(shear_seen, 0.005 * normal_seen);
    EXPECT_LT(error_seen, kLoosest * normal_seen);
  }
};

TEST_P(LayerShearTwinSeeds, OneObject) {
  run({.skin = {.iterations = 10, .tolerance = 1e-3}}, GetParam());
}

TEST_P(LayerShearTwinSeeds, OnAHalfSpace) {
  run({.skin = {.poisson_ratio = 0.3, .base = ElasticLayer::Base::kHalfSpace, .iterations = 10, .tolerance = 1e-3}}, 100 + GetParam());
}

TEST_P(LayerShearTwinSeeds, SeveralObjects) {
  run({.skin = {.iterations = 10, .tolerance = 1e-3}, .num_slots = 2 + GetParam() % 2}, 200 + GetParam());
}

TEST_P(LayerShearTwinSeeds, UnderALoad) {
  run({.skin = {.iterations = 10, .tolerance = 1e-3}, .num_slots = 1 + GetParam() % 2, .with_loads = true}, 300 + GetParam());
}

TEST_P(LayerShearTwinSeeds, OnATiltedPatch) {
  run({.skin = {.iterations = 10, .tolerance = 1e-3}, .num_slots = 1 + GetParam() % 2, .patch_tilt = 0.4}, 400 + GetParam());
}

TEST_P(LayerShearTwinSeeds, WithAMargin) {
  run({.skin = {.margin = 7e-3, .iterations = 10, .tolerance = 1e-3}, .with_loads = GetParam() % 2 == 1}, 500 + GetParam());
}

INSTANTIATE_TEST_SUITE_P(OnEveryDriver, LayerShearTwinSeeds, support::seeds(2, 4));

// From poses, solved to convergence, with four nodes per taxel and a margin. The error of a sum of tractions grows per step by at most mu
// times the error of the sum of pressures (forceSlack()), and by as much again if a node at the rim touches in one of them only.
TEST(ElasticLayerShear, WrenchMatchesTheTwin) {
  for (const bool with_loads : {false, true}) {
    Random random(with_loads ? 32 : 31);
    const PathKind kind{.skin = {.margin = 4e-3}, .with_loads = with_loads};
    const Sensor sensor = shearingSensor(random, kind.skin, 2);
    const double mu = sensor.skin.friction.friction_coefficient;
    const std::size_t num_taxels = static_cast<std::size_t>(numTaxels(sensor));
    std::vector<reference::FrictionState> state(3);
    std::vector<double> slack(3, support::kAbsoluteForce);
    runPath(random, kind, sensor, [&](std::size_t i, const std::vector<PlacedObject>& placed, const FrameView& frame) {
      const reference::LayerContact contact = reference::layerContact(sensor, placed);
      const reference::ContactShear twin = contactShear(sensor, placed, pressedNodes(sensor, placed, contact), state[i], kDt);
      state[i] = twin.state;
      const double all = contact.total_force + contact.off_array_load;
      const double pressure_slack =
          support::forceSlack(all, std::max(support::kMarginZ, *std::max_element(contact.overlap.begin(), contact.overlap.end())));
      slack[i] += 2 * mu * pressure_slack;
      for (std::size_t k = 0; k < 2 * num_taxels; ++k) {
        const double found = frame.ground_truth.tactile_shear_force[2 * i * num_taxels + k];
        EXPECT_NEAR(found, twin.taxel_force[k / 2][k % 2], slack[i]) << k;
      }
      for (std::size_t axis = 0; axis < 6; ++axis) {
        const double wrench_slack = (slack[i] + pressure_slack) * (axis < 3 ? 1 : kReach);
        EXPECT_NEAR(frame.ground_truth.contact_wrench[6 * i + axis], contact.wrench[axis] + twin.wrench[axis], wrench_slack) << axis;
      }
    });
  }
}

}  // namespace
}  // namespace taxelsim
