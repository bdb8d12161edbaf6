// Area sampling where the mean depth of a cell is not enough (shaders/skin/law.glsl): exponents other than 1 and friction, against
// closed forms and the double-precision twin, next to point sampling.
#include "reference/frame.h"
#include "simulation/comparison.h"
#include "support/curved_sensor.h"
#include "support/random_scene.h"
#include "support/test.h"

namespace taxelsim {
namespace {

using support::Random;
using support::Touch;

constexpr double kPi = std::numbers::pi;
constexpr double kStiffness = 1.73e8, kTangentialStiffness = 1e8;  // N/m^3
constexpr double kFriction = 0.5;
constexpr double kDt = 1e-3;  // s
constexpr int kPlaces = 20;
// Eight scan lines per cell on the edge of a solid: area_sampling_test.cpp.
constexpr double kScan = 0.004;

Sensor sensorWith(DepthSampling sampling) {
  Sensor sensor = support::gridSensor({.thickness = 2e-3});
  sensor.depth_sampling = sampling;
  return sensor;
}

// An upright pin or a sphere, pressed in by `depth`.
struct Round {
  Object object;
  double lift;                          // m, height of the origin over the lowest point
  double radius;                        // m, of the contact
  std::function<double(double)> depth;  // m, by the distance from the middle (m)
};

Round pin(double radius, double depth) {
  return {Object("pin", Cylinder{radius, 12e-3}), 6e-3, radius, [=](double) { return depth; }};
}

Round ball(double radius, double depth) {
  return {Object("ball", Sphere{radius}), radius, std::sqrt(2 * radius * depth - depth * depth),
          [=](double r) { return depth - radius + std::sqrt(radius * radius - r * r); }};
}

// Integral over the contact of value(distance from the middle), by rings.
double overContact(const Round& round, const std::function<double(double)>& value) {
  constexpr int kRings = 20000;
  double sum = 0;
  for (int k = 0; k < kRings; ++k) {
    const double r = (k + 0.5) / kRings * round.radius;
    sum += value(r) * 2 * kPi * r * round.radius / kRings;
  }
  return sum;
}

std::vector<Pose> places(const Round& round, double depth) {
  Random random(7);
  std::vector<Pose> poses;
  for (int i = 0; i < kPlaces; ++i) {
    poses.push_back({{random.uniform(-1.7e-3, 1.7e-3), random.uniform(-1.7e-3, 1.7e-3), round.lift - depth}, {1, 0, 0, 0}});
  }
  return poses;
}

// A simulator of kPlaces instances of one of these.
Simulator simulatorOf(const Sensor& sensor, const std::vector<Round>& rounds) {
  std::vector<Object> objects;
  for (const Round& round : rounds) objects.push_back(round.object);
  return {Model(support::sharedDevice(), {.sensor = sensor, .objects = objects}), {.num_instances = kPlaces}};
}

// Worst relative error of the force.
double forceError(Simulator& simulator, int id, const Round& round, double depth, const Winkler& law) {
  simulator.setObjects(std::vector<int>(kPlaces, id), places(round, depth));
  const FrameView frame = support::stepOnce(simulator, kDt);
  const auto pressure = [&](double r) { return law.normal_contact_stiffness * std::pow(round.depth(r), law.normal_exponent); };
  const double expected = overContact(round, pressure);
  double worst = 0;
  for (std::size_t i = 0; i < kPlaces; ++i) worst = std::max(worst, std::abs(-frame.ground_truth.contact_wrench[6 * i + 2] / expected - 1));
  return worst;
}

// Two points with the mean and the variance of the depths in a cell have the mean of their squares, and that of their cubes where depths
// are distributed symmetrically. In the corner of a contact, where small depths prevail (density proportional to 1 - d / deepest), the mean
// of cubes is 7.4 % low and that of d^1.5 0.6 % high; of the contact such corners are a part, which is largest for a ball of 1 mm.
TEST(CellPoints, ForcesOfExponents) {
  constexpr double kDepth = 0.3e-3;
  struct Row {
    double exponent, error;
  };
  const std::vector<Round> rounds{pin(0.5e-3, kDepth), ball(1e-3, kDepth), ball(4e-3, kDepth)};
  for (const auto& [exponent, error] : {Row{1.5, 0.006 + kScan}, Row{2, kScan}, Row{3, 0.037}}) {
    const Winkler law{kStiffness * std::pow(1e-3, 1 - exponent), exponent, 0};
    Sensor cells = sensorWith(DepthSampling::kArea), points = sensorWith(DepthSampling::kPoint);
    cells.skin.law = points.skin.law = law;
    Simulator with_cells = simulatorOf(cells, rounds), with_points = simulatorOf(points, rounds);
    for (int id = 0; id < 3; ++id) {
      const Round& round = rounds[static_cast<std::size_t>(id)];
      SCOPED_TRACE(round.object.name + " " + std::to_string(round.radius) + ", exponent " + std::to_string(exponent));
      const double found = forceError(with_cells, id, round, kDepth, law);
      EXPECT_LT(found, error);
      EXPECT_LT(2 * found, forceError(with_points, id, round, kDepth, law));
    }
  }
}

// Worst relative errors of the force of slides and of the torque of turns, by the integral of the smaller of tangential stiffness times way
// and the limit of Coulomb.
double shearError(Simulator& simulator, int id, const Round& round, double depth, double slide, double turn) {
  constexpr int kSteps = 4;
  Random random(11);
  std::vector<Pose> start = places(round, depth), poses = start;
  std::vector<double> directions;
  for (int i = 0; i < kPlaces; ++i) directions.push_back(random.uniform(0, kPi));
  for (int i = 0; i < kPlaces; ++i) simulator.reset(i, 0);
  FrameView frame;
  for (int step = 0; step <= kSteps; ++step) {
    const double part = static_cast<double>(step) / kSteps;
    for (std::size_t i = 0; i < kPlaces; ++i) {
      poses[i].position[0] = start[i].position[0] + slide * part * std::cos(directions[i]);
      poses[i].position[1] = start[i].position[1] + slide * part * std::sin(directions[i]);
      poses[i].rotation = axisAngle({0, 0, 1}, turn * part);
    }
    simulator.setObjects(std::vector<int>(kPlaces, id), poses);
    frame = support::stepOnce(simulator, kDt);
  }
  const auto traction = [&](double r) {
    return std::min(kTangentialStiffness * (slide + turn * r), kFriction * kStiffness * round.depth(r)) * (turn > 0 ? r : 1);
  };
  const double expected = overContact(round, traction);
  double worst = 0;
  for (std::size_t i = 0; i < kPlaces; ++i) {
    const float* wrench = &frame.ground_truth.contact_wrench[6 * i];
    const Vector3& at = poses[i].position;
    const double found = turn > 0 ? std::abs(wrench[5] - (at[0] * wrench[1] - at[1] * wrench[0])) : std::hypot(wrench[0], wrench[1]);
    worst = std::max(worst, std::abs(found / expected - 1));
  }
  return worst;
}

// A wedge whose vertical wall stands on a border between cells at x = 0 and whose face leaves the skin one cell further, so that depths in
// that column of cells are distributed evenly between 0 and kDeepest. It is longer than the sensor.
constexpr double kCell = 0.85e-3, kDeepest = 0.2e-3;  // m

// Wrench after each of the slides (m, rising) along y.
std::vector<std::array<double, 6>> slidWedge(const std::vector<double>& slides) {
  constexpr double kHigh = 5;  // times the depth
  Sensor sensor = sensorWith(DepthSampling::kArea);
  sensor.skin.friction = {.tangential_stiffness = 1e9, .friction_coefficient = kFriction};
  const Object wedge("wedge", support::prism({{0, 0}, {kHigh * kCell, kHigh * kDeepest}, {0, kHigh * kDeepest}}, 80e-3));
  Simulator simulator(Model(support::sharedDevice(), {.sensor = sensor, .objects = {wedge}}), {.num_instances = 1});
  std::vector<std::array<double, 6>> wrenches;
  for (std::size_t k = 0; k <= slides.size(); ++k) {
    const FrameView frame = support::stepOnce(simulator, {{{0}, {{{0, k > 0 ? slides[k - 1] : 0, -kDeepest}, {1, 0, 0, 0}}}}}, kDt);
    if (k == 0) continue;
    std::ranges::copy_n(frame.ground_truth.contact_wrench.begin(), 6, wrenches.emplace_back().begin());
  }
  return wrenches;
}

// Friction is the mean of the smaller of two tractions: t - t^2 / 2 of mu k kDeepest, where depths up to t kDeepest slip. Two points with
// the weights 0.4 and 0.6 and the mean and the variance of these depths are 0.5 - sqrt(1.5 / 12) and 0.5 + sqrt(1 / 18) deep, of kDeepest.
// Their largest errors are where they begin to slip, 7.9 % at t = 0.146 and 7.5 % at t = 0.736, and in between, -6.7 % at t = 0.4.
TEST(CellPoints, EdgeThatBeginsToSlip) {
  constexpr double kTwoPoints = 0.0795, kTangential = 1e9;  // N/m^3, slidWedge()
  const std::vector<double> ways{0.05, 0.1, 0.146, 0.2, 0.25, 0.4, 0.6, 0.736, 0.8, 0.9, 1.1};
  const double deepest = kFriction * kStiffness * kDeepest;  // Pa
  std::vector<double> slides;
  for (const double t : ways) slides.push_back(t * deepest / kTangential);
  const std::vector<std::array<double, 6>> wrenches = slidWedge(slides);
  double worst = 0;
  for (std::size_t k = 0; k < ways.size(); ++k) {
    const double t = std::min(ways[k], 1.0), expected = (t - t * t / 2) * deepest * kCell * 14 * 3.4e-3;
    const double error = wrenches[k][1] / expected - 1;
    EXPECT_LT(std::abs(error), kTwoPoints) << "t = " << ways[k];
    worst = std::max(worst, std::abs(error));
  }
  EXPECT_GT(worst, 0.075) << "two points are not better";
}

// Where everything slips, friction acts where pressure does: a third of the cell from the wall. Half floats hold the direction and the
// ratio of the depth's deviation to its mean, 2^-11 each.
TEST(CellPoints, SlipActsWherePressureDoes) {
  constexpr double kHalfFloat = 0x1p-11;
  const std::array<double, 6> wrench = slidWedge({1.2 * kFriction * kStiffness * kDeepest / 1e9}).front();
  EXPECT_NEAR(wrench[5] / wrench[1], kCell / 3, kHalfFloat * kCell);
}

// Errors that are allowed at 4 x 4 samples.
TEST(CellPoints, ShearOfDiscsAndBalls) {
  constexpr double kDepth = 0.5e-3, kAim = 0.05;
  const std::vector<Round> rounds{pin(2e-3, kDepth), ball(8e-3, kDepth), ball(4e-3, kDepth)};
  Sensor sensor = sensorWith(DepthSampling::kArea);
  sensor.skin.friction = {.tangential_stiffness = kTangentialStiffness, .friction_coefficient = kFriction};
  Simulator cells = simulatorOf(sensor, rounds);
  sensor.depth_sampling = DepthSampling::kPoint;
  Simulator points = simulatorOf(sensor, rounds);
  for (int id = 0; id < 3; ++id) {
    const Round& round = rounds[static_cast<std::size_t>(id)];
    double worst_point = 0;
    for (const auto& [slide, turn] : {std::pair{5e-5, 0.0}, {1e-4, 0.0}, {2e-4, 0.0}, {0.0, 0.02}, {0.0, 0.1}}) {
      SCOPED_TRACE(round.object.name + " " + std::to_string(round.radius) + ": " + std::to_string(slide) + " m, " + std::to_string(turn));
      EXPECT_LT(shearError(cells, id, round, kDepth, slide, turn), kAim);
      worst_point = std::max(worst_point, shearError(points, id, round, kDepth, slide, turn));
    }
    EXPECT_GT(worst_point, 1.5 * kAim) << "with points";
  }
}

// Forces, shear and wrench of two frames with motion in between against the twin, which integrates in double precision.
class CellPointsOnEveryDriver : public ::testing::TestWithParam<int> {};

TEST_P(CellPointsOnEveryDriver, ShearOfAllTaxels) {
  Random random(static_cast<std::uint64_t>(900 + GetParam()));
  Sensor sensor = GetParam() == 1 ? support::curvedSensor(random, 1) : support::gridSensor({.thickness = 2e-3});
  sensor.depth_sampling = DepthSampling::kArea;
  sensor.psf = {};
  const double exponent = GetParam() == 3 ? 1 : 1.5;
  sensor.skin.law = GetParam() == 2 ? ContactLaw{LuGre{.normal_contact_stiffness = kStiffness}}
                                    : ContactLaw{Winkler{kStiffness * std::pow(1e-3, 1 - exponent), exponent, 0}};
  if (GetParam() != 2) sensor.skin.friction = {.tangential_stiffness = kTangentialStiffness, .friction_coefficient = kFriction};
  const std::vector<Object> objects{Object(Box{{6e-3, 9e-3, 5e-3}}), Object(Sphere{5e-3}), Object(Capsule{3e-3, 8e-3}),
                                    Object("stone", support::icosphere(6e-3, 2, 0, random))};
  constexpr int kInstances = 4;
  std::vector<Touch> touches;
  for (int i = 0; i < kInstances; ++i) {
    const Object& object = objects[static_cast<std::size_t>(i)];
    Pose pose = GetParam() == 1 ? support::randomContactOnTaxel(random, sensor, object) : support::randomContact(random, sensor, object);
    pose.position[2] -= 0.2e-3;
    touches.push_back({.ids = {i}, .X_SO = {pose}});
  }
  Simulator simulator = support::makeSimulator(sensor, objects, {.num_instances = kInstances, .outputs = {.tactile_shear_force = true}});
  std::vector<reference::Frame> twins(kInstances);
  FrameView frame;
  for (int step = 0; step < 3; ++step) {
    frame = support::stepOnce(simulator, touches, kDt);
    for (std::size_t i = 0; i < kInstances; ++i) {
      const std::vector<reference::PlacedObject> placed = touches[i].placed(objects);
      const reference::FrictionState before = twins[i].shear.state;
      twins[i] = reference::simulateFrame(sensor, {.objects = placed, .previous_friction = before, .dt = kDt});
      Pose& pose = touches[i].X_SO[0];
      pose.position[0] += 60e-6;
      pose.rotation = axisAngle({0, 0, 1}, 0.01) * pose.rotation;
    }
  }
  const auto num_taxels = static_cast<std::size_t>(numTaxels(sensor));
  for (std::size_t i = 0; i < kInstances; ++i) {
    SCOPED_TRACE(objects[i].name + ", instance " + std::to_string(i));
    double largest = 0;
    for (const auto& [x, y] : twins[i].spread_shear) largest = std::max({largest, std::abs(x), std::abs(y)});
    ASSERT_GT(largest, 0.01 * *std::ranges::max_element(twins[i].contact.taxel_force));
    for (std::size_t t = 0; t < num_taxels; ++t) {
      for (std::size_t axis = 0; axis < 2; ++axis) {
        // Both points of a cell are off with its mean depth.
        EXPECT_NEAR(frame.ground_truth.tactile_shear_force[2 * (i * num_taxels + t) + axis], twins[i].spread_shear[t][axis],
                    2 * kScan * largest)
            << "taxel " << t;
      }
    }
  }
}
INSTANTIATE_TEST_SUITE_P(Sensors, CellPointsOnEveryDriver, ::testing::Values(0, 1, 2, 3));

}  // namespace
}  // namespace taxelsim
