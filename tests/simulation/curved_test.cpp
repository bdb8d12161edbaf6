// Taxel lists on the device: fingertips and random lists against the twin, a flat list against its grid.
#include "reference/contact.h"
#include "reference/load.h"
#include "simulation/comparison.h"
#include "support/cases.h"
#include "support/curved_sensor.h"
#include "support/test.h"

namespace taxelsim {
namespace {

using support::curvedSensor;
using support::Random;
using support::Touch;

constexpr double kDt = 1e-3;          // s
constexpr double kObjectSize = 0.02;  // m
// The load search over several tiles stops at 1e-6 of the load; taxel forces are summed in float32.
constexpr double kCarried = 1e-4;

std::vector<Touch> randomTouches(Random& random, const Sensor& sensor, const std::vector<Object>& objects, int num_instances,
                                 int num_slots) {
  std::vector<Touch> touches;
  for (int i = 0; i < num_instances; ++i) {
    Touch touch;
    for (int slot = 0; slot < num_slots; ++slot) {
      touch.ids.push_back(random.integer(0, static_cast<int>(objects.size()) - 1));
      touch.X_SO.push_back(support::randomContactOnTaxel(random, sensor, objects[touch.ids.back()]));
    }
    touches.push_back(touch);
  }
  return touches;
}

class CurvedSeeds : public ::testing::TestWithParam<int> {};

void comparePoses(Random& random, const Sensor& sensor, const std::vector<Object>& objects, int num_slots) {
  constexpr int kNumInstances = 4;
  const std::vector<Touch> touches = randomTouches(random, sensor, objects, kNumInstances, num_slots);
  Simulator simulator = support::makeSimulator(sensor, objects, {.num_instances = kNumInstances, .num_slots = num_slots});
  const FrameView frame = support::stepOnce(simulator, touches, kDt);
  support::expectWellFormed(frame, sensor, kNumInstances);
  for (int i = 0; i < kNumInstances; ++i) {
    SCOPED_TRACE(objects[touches[i].ids[0]].name);
    const auto placed = touches[i].placed(objects);
    support::expectMatches(frame, i, sensor, support::frameEnvelope(sensor, placed, support::roundingFor(sensor, placed)));
  }
}

TEST_P(CurvedSeeds, MeshesMatchTheTwin) {
  Random random(GetParam());
  const Sensor sensor = curvedSensor(random, GetParam());
  comparePoses(random, sensor, {support::randomMeshObject(random, kObjectSize), support::randomPolyhedron(random, kObjectSize)}, 1);
}

TEST_P(CurvedSeeds, PolyhedraAndSolidsMatchTheTwin) {
  Random random(100 + GetParam());
  const Sensor sensor = curvedSensor(random, GetParam());
  comparePoses(random, sensor, {support::randomSolid(random, kObjectSize), support::randomPolyhedron(random, kObjectSize)}, 1);
}

TEST_P(CurvedSeeds, OneSolidMatchesTheTwin) {
  Random random(200 + GetParam());
  const Sensor sensor = curvedSensor(random, GetParam());
  comparePoses(random, sensor, {support::randomSolid(random, kObjectSize)}, 1);
}

TEST_P(CurvedSeeds, SeveralObjectsMatchTheTwin) {
  Random random(300 + GetParam());
  const Sensor sensor = curvedSensor(random, GetParam());
  comparePoses(random, sensor, {support::randomSolid(random, kObjectSize), support::randomMeshObject(random, kObjectSize)}, 3);
}

INSTANTIATE_TEST_SUITE_P(OnEveryDriver, CurvedSeeds, support::seeds(3, 9));

TEST(CurvedOnEveryDriver, HalfSpaceOnASphereInClosedForm) {
  constexpr double kRadius = 8e-3, kDepth = 1e-3;
  Sensor sensor = support::sphereFingertip(kRadius, 3, 1.2);
  sensor.samples_per_taxel = 1;
  Simulator simulator = support::makeSimulator(sensor, {Object(HalfSpace{})});
  const FrameView frame = support::stepOnce(simulator, {{{0}, {{.position = {0, 0, -kDepth}}}}}, kDt);
  const std::vector<Vector3> normals = taxelNormals(sensor);
  double upward = 0;
  for (std::size_t t = 0; t < normals.size(); ++t) {
    // The plane z = -depth lies at height h along a normal of slope c: R (c - 1) + h c = -depth.
    const double height = (kRadius * (1 - normals[t][2]) - kDepth) / normals[t][2];
    EXPECT_NEAR(frame.ground_truth.penetration_depth[t], std::clamp(-height, 0.0, sensor.skin.thickness), support::kMarginZ) << t;
    upward += frame.ground_truth.tactile_normal_force[t] * normals[t][2];
  }
  EXPECT_GT(upward, 0.5);
  EXPECT_NEAR(-frame.ground_truth.contact_wrench[2], upward, kCarried * upward) << "the wrench takes forces along their normals";
}

// Sample lines of the far side of a finger also meet the object, far below their skin.
TEST(CurvedOnEveryDriver, FarSideOfAFingerHasNoForce) {
  const Sensor sensor = support::cylinderFingertip(8e-3, 1.5, 11, 5, 2.5e-3);
  Random random(1);
  const std::vector<Object> objects{Object(Box{{4e-3, 30e-3, 10e-3}}), Object("box", support::boxMesh({4e-3, 30e-3, 10e-3})),
                                    Object("round", support::icosphere(5e-3, 3, 0, random)), Object(Capsule{3e-3, 20e-3}),
                                    Object(HalfSpace{})};
  const Quaternion towards_x = axisAngle({0, 1, 0}, -std::numbers::pi / 2);
  for (std::size_t o = 0; o < objects.size(); ++o) {
    SCOPED_TRACE(objects[o].name);
    Simulator simulator = support::makeSimulator(sensor, {objects[o]}, {.num_instances = 2, .num_slots = 2});
    // 1 mm deep in the flank at -x, then in both flanks.
    const double half = o < 2 ? 2e-3 : o == 2 ? 5e-3 : o == 3 ? 3e-3 : 0;
    const Pose left{{-8e-3 - half + 1e-3, 0, -8e-3}, o == 4 ? towards_x : Quaternion{1, 0, 0, 0}};
    const Pose right{{8e-3 + half - 1e-3, 0, -8e-3}, o == 4 ? axisAngle({0, 1, 0}, std::numbers::pi / 2) : Quaternion{1, 0, 0, 0}};
    const FrameView frame = support::stepOnce(simulator, {{{0, kNoObject}, {left, {}}}, {{0, 0}, {left, right}}}, kDt);
    const std::size_t n = sensor.patches.size();
    for (std::size_t t = 0; t < n; ++t) {
      const float near = frame.ground_truth.tactile_normal_force[t], both = frame.ground_truth.tactile_normal_force[n + t];
      const bool is_right = sensor.patches[t].X_SP.position[0] > 0;
      EXPECT_EQ(is_right ? 0 : both, near) << t;
    }
    EXPECT_GT(frame.ground_truth.total_force[0], 0.1);
    EXPECT_NEAR(frame.ground_truth.total_force[1], 2 * frame.ground_truth.total_force[0], 1e-2 * frame.ground_truth.total_force[1]);
  }
}

TEST(CurvedOnEveryDriver, FlatListEqualsItsGrid) {
  Random random(7);
  Sensor grid = support::gridSensor({.num_rows = 5, .num_cols = 7, .pitch_x = 2e-3, .pitch_y = 3e-3});
  grid.readout = support::paperReadout();
  grid.psf = {.sigma = 1.5e-3};
  Sensor list = grid;
  list.patches.clear();
  for (const Vector3& p : taxelPositions(grid)) list.patches.push_back(taxelPatch("t", p, {0, 0, 1}, grid.patches[0].pitch));
  const std::vector<Object> objects{support::randomMeshObject(random, kObjectSize), Object(Sphere{6e-3}),
                                    support::randomPolyhedron(random, kObjectSize)};
  std::vector<Touch> touches;
  for (int i = 0; i < 12; ++i) touches.push_back({{i % 3}, {support::randomContact(random, grid, objects[i % 3])}});
  const Model grid_model(support::sharedDevice(), {.sensor = grid, .objects = objects});
  const Model list_model(support::sharedDevice(), {.sensor = list, .objects = objects});
  Simulator on_grid(grid_model, {.num_instances = 12}), on_list(list_model, {.num_instances = 12});
  const FrameView one = support::stepOnce(on_grid, touches, kDt), other = support::stepOnce(on_list, touches, kDt);
  for (int i = 0; i < 12; ++i) {
    SCOPED_TRACE(i);
    const auto placed = touches[i].placed(objects);
    // Both have the same samples, hence the same bounds.
    const support::FrameEnvelope envelope = support::frameEnvelope(grid, placed, support::roundingFor(grid, placed));
    support::expectMatches(one, i, grid, envelope);
    support::expectMatches(other, i, list, envelope);
    EXPECT_NEAR(one.ground_truth.total_force[i], other.ground_truth.total_force[i], envelope.total_high - envelope.total_low);
  }
}

// The wrench carries the load along -z of S for every object, law and friction; the spread keeps the sum of the forces along the normals.
TEST(Curved, TheSkinCarriesTheLoad) {
  constexpr double kKept = 1e-3;              // of the force, by the spread: the weights of a source sum to 1 in float32
  constexpr double kCarriedOverTiles = 2e-6;  // of the load, load_test.cpp
  Random random(5);
  const std::vector<Object> objects{Object(Sphere{6e-3}), Object(Box{{30e-3, 30e-3, 5e-3}}), Object(Cylinder{5e-3, 30e-3}),
                                    Object("bumpy", support::icosphere(8e-3, 3, 0.05, random))};
  const std::vector<Skin> skins{{.law = Winkler{1.73e8, 1, 0}},
                                {.law = Winkler{1.73e8, 1, 0}, .friction = {3e8, 0.7}},
                                {.law = MassSpringDamper{.normal_contact_stiffness = 1.73e8}}};
  int num_carried = 0;
  for (int kind = 0; kind < 3; ++kind) {
    for (std::size_t s = 0; s < skins.size(); ++s) {
      Sensor sensor = kind == 0   ? support::cylinderFingertip(8e-3, 1.4, 9, 5, 2.4e-3)
                      : kind == 1 ? support::sphereFingertip(8e-3, 2, 1.3)
                                  : support::randomTaxels(random, 60);
      sensor.psf.sigma = 1e-3;
      sensor.skin = skins[s];
      sensor.skin.thickness = 2e-3;
      const std::size_t n = sensor.patches.size();
      Simulator simulator = support::makeSimulator(sensor, objects, {.num_instances = 8});
      std::vector<Touch> touches;
      std::vector<float> loads;
      for (int i = 0; i < 8; ++i) {
        touches.push_back({{i % 4}, {{{random.uniform(-2e-3, 2e-3), random.uniform(-2e-3, 2e-3), 0.03}, axisAngle({1, 0, 0}, i * 0.2)}}});
        loads.push_back(static_cast<float>(random.uniform(0.1, 2)));
      }
      simulator.setLoads(loads);
      const std::vector<Vector3> normals = taxelNormals(sensor);
      for (int step_number = 0; step_number < 3; ++step_number) {
        const FrameView frame = support::stepOnce(simulator, touches, kDt);
        for (int i = 0; i < 8; ++i) {
          SCOPED_TRACE(::testing::Message() << sensor.name << ", skin " << s << ", " << objects[i % 4].name << ", step " << step_number);
          if (frame.ground_truth.load_reached[i] ==
              0) {  // the load lies in a jump of the force, where a sample of a tilted taxel meets an edge
            EXPECT_FALSE(reference::findLoad(sensor, touches[i].placed(objects), loads[i]).reached);
            continue;
          }
          ++num_carried;
          double carried = 0, shear = 0;
          for (std::size_t t = i * n; t < (i + 1) * n; ++t) {
            const double normal = frame.ground_truth.tactile_normal_force[t];
            const double across =
                std::hypot(frame.ground_truth.tactile_shear_force[2 * t], frame.ground_truth.tactile_shear_force[2 * t + 1]);
            carried += normal, shear += across;
            // A force per taxel sums at most 36 samples and 128 sources in float32.
            EXPECT_LE(across, sensor.skin.friction.friction_coefficient * normal * (1 + 200 * support::kUlp) + 1e-9);
          }
          EXPECT_NEAR(carried, frame.ground_truth.total_force[i], kKept * carried);
          EXPECT_GE(carried, loads[i] * (1 - kKept));
          const double by_friction = s == 1 ? sensor.skin.friction.friction_coefficient * carried : 0;
          EXPECT_NEAR(-frame.ground_truth.contact_wrench[6 * i + 2], loads[i], kCarriedOverTiles * loads[i] + by_friction);
          if (s == 1 && step_number > 0) {
            EXPECT_GT(shear, 1e-3 * loads[i]) << "the object has moved";
          }
        }
        for (Touch& touch : touches) touch.X_SO[0].position[1] += 0.2e-3;
      }
    }
  }
  EXPECT_GE(num_carried, 9 * 3 * 8 * 9 / 10);
}

// Separation clears the state, also of taxels that no object was near in the meantime.
TEST(CurvedOnEveryDriver, LiftingClearsTheState) {
  Sensor sensor = support::cylinderFingertip(8e-3, 1.4, 9, 5, 2.4e-3);
  sensor.skin.friction = {3e8, 0.7};
  Simulator simulator = support::makeSimulator(sensor, {Object(Sphere{6e-3})});
  const auto shearAt = [&](double y, double z) {
    const FrameView frame = support::stepOnce(simulator, {{{0}, {{.position = {0, y, z}}}}}, kDt);
    double sum = 0;
    for (const float part : frame.ground_truth.tactile_shear_force) sum += std::abs(part);
    return sum;
  };
  EXPECT_EQ(shearAt(0, 5e-3), 0);
  EXPECT_GT(shearAt(0.1e-3, 5e-3), 0.1);
  EXPECT_EQ(shearAt(0.1e-3, 0.1), 0);
  const double again = shearAt(0.1e-3, 5e-3);  // flanks are dragged along as it comes down
  simulator.reset(0, 1);
  EXPECT_EQ(shearAt(0.1e-3, 0.1), 0);
  EXPECT_EQ(shearAt(0.1e-3, 5e-3), again);
}

// Bits of instance 3 of a batch of 8, for a workgroup.
std::vector<std::uint32_t> bitsWith(const Sensor& sensor, const std::vector<Object>& objects, const std::vector<Touch>& touches,
                                    int workgroup, const std::vector<int>& instances, int wanted) {
  const Model model(support::sharedDevice(),
                    {.sensor = sensor, .objects = objects, .contact_workgroup = workgroup, .image_workgroup = workgroup});
  const int n = static_cast<int>(instances.size());
  Simulator simulator(model, {.num_instances = n, .num_slots = 2});
  std::vector<Touch> chosen;
  for (const int i : instances) chosen.push_back(touches[i]);
  return support::bitsOf(support::stepOnce(simulator, chosen, kDt), wanted, n);
}

TEST(CurvedOnEveryDriver, IndependentOfBatchAndWorkgroup) {
  Random random(11);
  Sensor sensor = curvedSensor(random, 1);
  const std::vector<Object> objects{support::randomMeshObject(random, kObjectSize), support::randomSolid(random, kObjectSize)};
  const std::vector<Touch> touches = randomTouches(random, sensor, objects, 8, 2);
  const auto expected = bitsWith(sensor, objects, touches, 0, {3}, 0);
  EXPECT_EQ(bitsWith(sensor, objects, touches, 0, {3}, 0), expected) << "run again";
  EXPECT_EQ(bitsWith(sensor, objects, touches, 0, {0, 1, 2, 3, 4, 5, 6, 7}, 3), expected);
  for (const int workgroup : {4, 8, 32, 128}) EXPECT_EQ(bitsWith(sensor, objects, touches, workgroup, {7, 3}, 1), expected) << workgroup;
}

TEST(Curved, OneTo4096TaxelsMatchTheTwin) {
  Random random(13);
  const std::vector<Object> objects{Object("knob", support::icosphere(6e-3, 2, 0.05, random))};
  for (const int count : {1, 2, 17, 300, 4096}) {
    SCOPED_TRACE(count);
    Sensor sensor = support::randomTaxels(random, count);
    sensor.samples_per_taxel = 2;
    sensor.psf.sigma = count > 300 ? 0.2e-3 : 0.5e-3;
    const std::vector<Touch> touches = randomTouches(random, sensor, objects, 2, 1);
    Simulator simulator = support::makeSimulator(sensor, objects, {.num_instances = 2});
    const FrameView frame = support::stepOnce(simulator, touches, kDt);
    support::expectWellFormed(frame, sensor, 2);
    for (int i = 0; i < 2; ++i) {
      const auto placed = touches[i].placed(objects);
      support::expectMatches(frame, i, sensor, support::frameEnvelope(sensor, placed, support::roundingFor(sensor, placed)));
    }
  }
}

}  // namespace
}  // namespace taxelsim
