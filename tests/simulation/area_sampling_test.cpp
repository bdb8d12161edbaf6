// Area sampling on the device, DepthSampling::kArea: contacts of any size against closed forms and the double-precision twin, next to point
// sampling.
#include "reference/area_depth.h"
#include "simulation/comparison.h"
#include "support/curved_sensor.h"
#include "support/pressed_shapes.h"
#include "support/random_scene.h"
#include "support/test.h"

namespace taxelsim {
namespace {

using support::lying;
using support::pressed;
using support::pressedPin;
using support::PressedShape;
using support::Random;
using support::Touch;

constexpr double kPi = std::numbers::pi;
constexpr double kStiffness = 1.73e8;  // N/m^3
constexpr double kDt = 1e-3;           // s
// Of the force, where cells are exact integrals over facets: heights are rounded by at most kMarginZ, and an outline by 2 kShift on both
// sides of a width.
constexpr double facetError(double depth, double width) {
  return support::kMarginZ / depth + 4 * support::kShift / width;
}
// Eight scan lines per cell (depth/area/solid_cells.glsl) are the midpoint rule for the section of a contact that is W lines wide. Where
// it ends like (W^2 - x^2)^(3/2) (a sphere), or like a parabola (a wire along the lines), the rule errs by less than 1 / W^2.
constexpr double scanError(double width) {
  constexpr double kLine = 0.85e-3 / 8;  // m
  return kLine * kLine / (width * width);
}
// The load search over tiles stops at 1e-6; the float32 sum of the forces of 84 taxels adds some ten roundings.
constexpr double kCarried = 2.5e-6;

Sensor areaSensor(DepthSampling sampling = DepthSampling::kArea) {
  Sensor sensor = support::gridSensor({.thickness = 2e-3});
  sensor.depth_sampling = sampling;
  return sensor;
}

struct Case : PressedShape {
  double error;             // of the force, relative
  double centre = 0.06e-3;  // m: each cell acts in its middle
};

std::vector<Case> cases(double depth) {
  const double wire = 0.5e-3, length = 12e-3, half_width = std::sqrt(2 * wire * depth - depth * depth);
  std::vector<Case> all;
  for (const double radius : {0.5e-3, 0.75e-3, 2e-3}) {
    const double error = facetError(depth, radius);
    all.push_back({pressed(Cylinder{radius, length}), error});
    all.push_back({pressedPin(radius, length), error});
  }
  all.push_back({pressed(Box{{10.5e-3, 10.5e-3, 10e-3}}), facetError(depth, 10.5e-3)});
  all.push_back({pressed(Box{{1e-3, 8e-3, 10e-3}}), facetError(depth, 1e-3)});
  // The square of a pyramid's outline is rounded as well.
  all.push_back({pressed(Cone{.radius = 4e-3, .height = 4e-3}), 4 * facetError(depth, 2 * depth) + 4e-4, 0.43e-3});
  all.push_back({lying(Cylinder{wire, length}), facetError(depth, half_width) + scanError(half_width)});
  for (const double radius : {1e-3, 2e-3, 8e-3}) {
    const double contact = std::sqrt(2 * radius * depth - depth * depth);
    all.push_back({pressed(Sphere{radius}), facetError(depth, contact) + scanError(contact)});
  }
  const double minor = 1e-3, major = 4e-3;  // the mesh of its section has 64 sides
  all.push_back({pressed(Torus{major, minor}), facetError(depth, minor) + 1.3e-3 * minor / depth});
  all.push_back({pressed(Capsule{1e-3, 1e-9}), facetError(depth, 0.7e-3) + scanError(0.7e-3)});
  return all;
}

std::vector<Pose> places(const Case& contact, double depth, int count) {
  Random random(5);
  std::vector<Pose> poses;
  for (int i = 0; i < count; ++i) {
    poses.push_back({{random.uniform(-1.7e-3, 1.7e-3), random.uniform(-1.7e-3, 1.7e-3), contact.lift - depth}, contact.rotation});
  }
  return poses;
}

struct Errors {
  double force = 0, centre = 0;  // worst; m
};

Errors errorsOf(const FrameView& frame, const std::vector<Pose>& poses, double expected) {
  Errors errors;
  for (std::size_t i = 0; i < poses.size(); ++i) {
    const float* wrench = &frame.ground_truth.contact_wrench[6 * i];
    const double force = -wrench[2], x = wrench[4] / force, y = -wrench[3] / force;
    errors.force = std::max(errors.force, std::abs(force / expected - 1));
    errors.centre = std::max(errors.centre, std::hypot(x - poses[i].position[0], y - poses[i].position[1]));
  }
  return errors;
}

Model modelOf(const std::vector<Case>& all, DepthSampling sampling) {
  std::vector<Object> objects;
  for (const Case& contact : all) objects.push_back(contact.object);
  return Model(support::sharedDevice(), {.sensor = areaSensor(sampling), .objects = objects});
}

constexpr int kPlaces = 50;

TEST(AreaSamplingOnEveryDriver, ForceAndCentreAtAnyPlace) {
  const double depth = 0.3e-3;
  const std::vector<Case> all = cases(depth);
  const Model area = modelOf(all, DepthSampling::kArea), point = modelOf(all, DepthSampling::kPoint);
  Simulator area_simulator(area, {.num_instances = kPlaces}), point_simulator(point, {.num_instances = kPlaces});
  for (std::size_t c = 0; c < all.size(); ++c) {
    SCOPED_TRACE("case " + std::to_string(c) + ", " + all[c].object.name);
    const std::vector<Pose> poses = places(all[c], depth, kPlaces);
    const std::vector<int> ids(kPlaces, static_cast<int>(c));
    const auto run = [&](Simulator& simulator) {
      simulator.setObjects(ids, poses);
      return errorsOf(support::stepOnce(simulator, kDt), poses, kStiffness * all[c].volume(depth));
    };
    const Errors errors = run(area_simulator);
    EXPECT_LE(errors.force, all[c].error);
    EXPECT_LE(errors.centre, all[c].centre);
    EXPECT_GT(run(point_simulator).force, 2 * errors.force);  // the baseline
  }
}

// Loads that press each object by 2 um, below which a float does not resolve the poses of large objects well, to a quarter of the
// thickness; of a pointed object at least 1 mN.
TEST(AreaSamplingOnEveryDriver, LoadsAreCarried) {
  const std::vector<Case> all = cases(0.3e-3);
  const Model model = modelOf(all, DepthSampling::kArea);
  Simulator simulator(model, {.num_instances = kPlaces});
  for (std::size_t c = 0; c < all.size(); ++c) {
    SCOPED_TRACE("case " + std::to_string(c) + ", " + all[c].object.name);
    std::vector<float> loads;
    const auto depthOf = [](int i) { return 2e-6 * std::pow(225, i / (kPlaces - 1.0)); };
    for (int i = 0; i < kPlaces; ++i) {
      const double depth = depthOf(i);
      loads.push_back(static_cast<float>(std::max(kStiffness * all[c].volume(depth), 1e-3)));
    }
    simulator.setObjects(std::vector<int>(kPlaces, static_cast<int>(c)), places(all[c], 0, kPlaces));
    simulator.setLoads(loads);
    const FrameView frame = support::stepOnce(simulator, kDt);
    for (int i = 0; i < kPlaces; ++i) {
      EXPECT_TRUE(frame.ground_truth.load_reached[i]) << loads[i] << " N";
      EXPECT_NEAR(-frame.ground_truth.contact_wrench[6 * i + 2], loads[i], kCarried * loads[i]);
    }
  }
}

// A stamp that slides in steps of 0.1 mm moves no more force between taxels than its edge sweeps over.
TEST(AreaSampling, SlidesWithoutJumps) {
  constexpr int kSteps = 64;
  constexpr double kStep = 0.1e-3, kDepth = 0.3e-3, kSide = 10.5e-3;  // m
  const Model model(support::sharedDevice(), {.sensor = areaSensor(), .objects = {Object(Box{{kSide, kSide, 10e-3}})}});
  Simulator simulator(model, {.num_instances = kSteps});
  std::vector<Pose> poses;
  for (int i = 0; i < kSteps; ++i) poses.push_back({{i * kStep - 3e-3, 0, 5e-3 - kDepth}, {1, 0, 0, 0}});
  simulator.setObjects(std::vector<int>(kSteps, 0), poses);
  const FrameView frame = support::stepOnce(simulator, kDt);
  const int n = numTaxels(model.sensor());
  const double swept = kStiffness * kDepth * kStep * 3.4e-3;
  double largest = 0;
  for (int i = 1; i < kSteps; ++i) {
    for (int t = 0; t < n; ++t) {
      const double change = frame.ground_truth.tactile_normal_force[i * n + t] - frame.ground_truth.tactile_normal_force[(i - 1) * n + t];
      largest = std::max(largest, std::abs(change));
    }
  }
  EXPECT_LE(largest, swept * (1 + facetError(kDepth, kStep)));
  EXPECT_GE(largest, swept * (1 - facetError(kDepth, kStep)));
}

// Deeper than the skin is thick, a pin presses with the thickness, and every cell that it covers by a quarter or more counts as
// over-penetrated.
TEST(AreaSampling, PressesNoDeeperThanTheSkin) {
  const double radius = 2e-3;
  const Model model(support::sharedDevice(),
                    {.sensor = areaSensor(), .objects = {Object(Cylinder{radius, 12e-3}), pressedPin(radius, 12e-3).object}});
  Simulator simulator(model, {.num_instances = 2});
  simulator.setObjects(std::vector<int>{0, 1}, std::vector<Pose>(2, Pose{{0.2e-3, 0.1e-3, 6e-3 - 3e-3}, {1, 0, 0, 0}}));
  const FrameView frame = support::stepOnce(simulator, kDt);
  const double thickness = 2e-3, cells = kPi * radius * radius / (0.85e-3 * 0.85e-3), all_cells = 16.0 * numTaxels(model.sensor());
  for (int i = 0; i < 2; ++i) {
    EXPECT_NEAR(-frame.ground_truth.contact_wrench[6 * i + 2] / (kStiffness * kPi * radius * radius * thickness), 1,
                facetError(thickness, radius));
    EXPECT_GE(frame.ground_truth.over_penetration[i] * all_cells, cells);  // the rim covers parts of more cells
    EXPECT_LE(frame.ground_truth.over_penetration[i] * all_cells, 1.5 * cells);
  }
}

// Depths of all taxels against the twin, which clips polygons and subdivides solids in double precision.
void expectDepths(const FrameView& frame, int instance, const Sensor& sensor, const Touch& touch, const std::vector<Object>& objects) {
  // A cell on the edge of a solid of 2 mm or more: eight scan lines, sixteen cells a taxel, of which four on an edge.
  constexpr double kScan = 0.004;
  const std::vector<reference::PlacedObject> placed = touch.placed(objects);
  const std::vector<double> mean = reference::meanPenetrations(sensor, placed);
  const auto per_taxel = static_cast<std::size_t>(sensor.samples_per_taxel * sensor.samples_per_taxel);
  const auto num_taxels = static_cast<std::size_t>(numTaxels(sensor));
  for (std::size_t t = 0; t < num_taxels; ++t) {
    double expected = 0, largest = 0;
    for (std::size_t k = 0; k < per_taxel; ++k) {
      expected += mean[t * per_taxel + k] / static_cast<double>(per_taxel);
      largest = std::max(largest, mean[t * per_taxel + k]);
    }
    EXPECT_NEAR(frame.ground_truth.penetration_depth[static_cast<std::size_t>(instance) * num_taxels + t], expected,
                kScan * largest + 2 * support::kMarginZ)
        << "taxel " << t;
  }
}

class AreaSamplingTwin : public ::testing::TestWithParam<int> {};

TEST_P(AreaSamplingTwin, DepthsOfAllTaxels) {
  Random random(static_cast<std::uint64_t>(500 + GetParam()));
  Sensor sensor = GetParam() % 3 == 2 ? support::curvedSensor(random, GetParam()) : support::gridSensor({.thickness = 2e-3});
  sensor.depth_sampling = DepthSampling::kArea;
  const std::vector<Object> objects{Object(Box{{6e-3, 9e-3, 5e-3}}),
                                    Object(Cylinder{4e-3, 15e-3}),
                                    Object(Sphere{5e-3}),
                                    Object(Cone{.radius = 5e-3, .height = 6e-3}),
                                    Object(Capsule{3e-3, 8e-3}),
                                    pressedPin(2e-3, 9e-3).object,
                                    Object("stone", support::icosphere(6e-3, 2, 0, random))};
  constexpr int kInstances = 5;
  std::vector<Touch> touches;
  for (int i = 0; i < kInstances; ++i) {
    Touch touch;
    for (int slot = 0; slot < 2; ++slot) {
      const int id = slot > 0 && i % 3 != 0 ? kNoObject : random.integer(0, static_cast<int>(objects.size()) - 1);
      touch.ids.push_back(id);
      Pose pose;
      if (id != kNoObject) {
        const Object& object = objects[static_cast<std::size_t>(id)];
        pose = GetParam() % 3 == 2 ? support::randomContactOnTaxel(random, sensor, object) : support::randomContact(random, sensor, object);
      }
      touch.X_SO.push_back(pose);
    }
    touches.push_back(touch);
  }
  Simulator simulator =
      support::makeSimulator(sensor, objects, {.num_instances = kInstances, .num_slots = 2, .outputs = {.penetration_depth = true}});
  const FrameView frame = support::stepOnce(simulator, touches, kDt);
  support::expectWellFormed(frame, sensor, kInstances);
  for (int i = 0; i < kInstances; ++i) {
    SCOPED_TRACE("instance " + std::to_string(i) + ": objects " + std::to_string(touches[static_cast<std::size_t>(i)].ids[0]) + ", " +
                 std::to_string(touches[static_cast<std::size_t>(i)].ids[1]));
    expectDepths(frame, i, sensor, touches[static_cast<std::size_t>(i)], objects);
  }
}
INSTANTIATE_TEST_SUITE_P(Seeds, AreaSamplingTwin, ::testing::Range(0, 3));

// A pin under friction sticks with tangential_stiffness times its area, wherever it stands, and slips at Coulomb's limit.
TEST(AreaSampling, ShearOfAPin) {
  const double radius = 0.75e-3, depth = 0.3e-3, area = kPi * radius * radius, stick = 10e-6, slip = 1e-3;
  Sensor sensor = areaSensor();
  sensor.skin.friction = {.tangential_stiffness = 1e8, .friction_coefficient = 0.5};
  Simulator simulator = support::makeSimulator(sensor, {Object(Cylinder{radius, 12e-3})}, {.num_instances = kPlaces});
  std::vector<Pose> poses = places(cases(depth)[0], depth, kPlaces);
  const std::vector<int> ids(kPlaces, 0);
  const auto shearAfter = [&](double motion) {
    for (Pose& pose : poses) pose.position[0] += motion;
    simulator.setObjects(ids, poses);
    return support::stepOnce(simulator, kDt);
  };
  shearAfter(0);
  const FrameView stuck = shearAfter(stick);
  // Where the motion of 0.01 mm covers new parts of cells, they have the traction of all of the step.
  const double swept = stick / radius;
  for (int i = 0; i < kPlaces; ++i) {
    EXPECT_NEAR(stuck.ground_truth.contact_wrench[6 * static_cast<std::size_t>(i)] / (1e8 * stick * area), 1,
                facetError(depth, radius) + swept);
  }
  const FrameView slipping = shearAfter(slip);
  for (std::size_t i = 0; i < kPlaces; ++i) {
    EXPECT_NEAR(slipping.ground_truth.contact_wrench[6 * i] / (0.5 * kStiffness * area * depth), 1, facetError(depth, radius));
  }
}

// A skin that relaxes carries all of a pin's force at first, and what its terms leave after 50 of their times.
TEST(AreaSampling, RelaxesUnderAPin) {
  const double radius = 0.75e-3, depth = 0.3e-3, fraction = 0.4, time = 0.01, force = kStiffness * kPi * radius * radius * depth;
  Sensor sensor = areaSensor();
  sensor.skin.relaxation = {{.fraction = fraction, .time = time}};
  Simulator simulator = support::makeSimulator(sensor, {Object(Cylinder{radius, 12e-3})}, {.num_instances = kPlaces});
  const std::vector<Pose> poses = places(cases(depth)[0], depth, kPlaces);
  simulator.setObjects(std::vector<int>(kPlaces, 0), poses);
  const FrameView pressed = support::stepOnce(simulator, time);
  for (std::size_t i = 0; i < kPlaces; ++i) {
    EXPECT_NEAR(-pressed.ground_truth.contact_wrench[6 * i + 2] / force, 1, facetError(depth, radius));
  }
  const FrameView relaxed = support::stepOnce(simulator, 50 * time);
  for (std::size_t i = 0; i < kPlaces; ++i) {
    EXPECT_NEAR(-relaxed.ground_truth.contact_wrench[6 * i + 2] / force, 1 - fraction, facetError(depth, radius));
  }
}

// Closed form: under a symmetric contact at (x, y) the force changes by k dV/dd with the depth, and by y and -x times that with the
// sensor's turn.
TEST(AreaSampling, JacobianOfTheForce) {
  const double depth = 0.3e-3;
  const std::vector<Case> all = cases(depth);
  const Model area = modelOf(all, DepthSampling::kArea), point = modelOf(all, DepthSampling::kPoint);
  const SimulatorOptions options{.num_instances = kPlaces, .outputs = {.clean_tactile_jacobian = true}};
  Simulator area_simulator(area, options), point_simulator(point, options);
  for (std::size_t c = 0; c < all.size(); ++c) {
    SCOPED_TRACE("case " + std::to_string(c) + ", " + all[c].object.name);
    const std::vector<Pose> poses = places(all[c], depth, kPlaces);
    const double step = 1e-6, rate = kStiffness * (all[c].volume(depth + step) - all[c].volume(depth - step)) / (2 * step);
    const auto run = [&](Simulator& simulator) {
      simulator.setObjects(std::vector<int>(kPlaces, static_cast<int>(c)), poses);
      const FrameView frame = support::stepOnce(simulator, kDt);
      struct {
        double depth, slide, centre;
      } worst{};
      for (std::size_t i = 0; i < kPlaces; ++i) {
        const float* row = &frame.ground_truth.jacobian.contact_wrench[36 * i + 12];
        worst.depth = std::max(worst.depth, std::abs(row[2] / -rate - 1));
        worst.slide = std::max({worst.slide, std::abs(row[0] / rate), std::abs(row[1] / rate)});
        worst.centre =
            std::max({worst.centre, std::abs(row[3] / -rate - poses[i].position[1]), std::abs(row[4] / -rate + poses[i].position[0])});
      }
      return worst;
    };
    const auto errors = run(area_simulator);
    // The covered area ends like a square root where a volume ends like its third power.
    const double bound = std::pow(all[c].error, 0.75), farthest = 1.7e-3;
    EXPECT_LE(errors.depth, bound);
    EXPECT_LE(errors.slide, kCarried);
    EXPECT_LE(errors.centre, all[c].centre + bound * farthest);
    EXPECT_GT(run(point_simulator).depth, 2 * errors.depth);  // the baseline
  }
}

}  // namespace
}  // namespace taxelsim
