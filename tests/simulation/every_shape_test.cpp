// Every shape and kind of mesh under every contact law on the device, with points and with areas, on a flat and on a curved skin, at a pose
// and under a load: against the double-precision reference and against closed forms.
//
// One table: the shapes are those of everyPressedShape(), the laws those of everyLaw(). An alternative of Shape or ContactLaw without a row
// does not compile.
#include "reference/frame.h"
#include "simulation/comparison.h"
#include "support/curved_sensor.h"
#include "support/pressed_shapes.h"
#include "support/test.h"
#include "taxelsim/error.h"

namespace taxelsim {
namespace {

using support::PressedShape;
using support::Touch;

constexpr double kPi = std::numbers::pi;
constexpr double kStiffness = 1.73e8;  // N/m^3
constexpr double kThickness = 2e-3;    // m
constexpr double kDepth = 0.5e-3;      // m
constexpr double kDt = 1e-3;           // s
constexpr double kLayerModulus = 2e5;  // Pa

constexpr double kCarried = 1e-5;          // of a load
constexpr double kCarriedTogether = 1e-4;  // of a load, by an elastic layer, whose search ends with its solver

enum class Surface { kFlat, kCurved };

// What a law promises.
struct Law {
  ContactLaw law;
  bool is_linear = true;  // the taxels of a flat skin sum to stiffness times volume
  bool takes_lists = true;
  bool takes_loads = true;
};

struct Laws {
  std::vector<Law> rows;

  void add(const std::type_identity<Winkler>&) {
    rows.push_back({.law = Winkler{kStiffness, 1, 0}});
    rows.push_back({.law = Winkler{kStiffness / kDepth, 2, 0}, .is_linear = false});
  }
  void add(const std::type_identity<MassSpringDamper>&) {
    rows.push_back({.law = MassSpringDamper{.normal_contact_stiffness = kStiffness}});
  }
  void add(const std::type_identity<DeformationMask>&) { rows.push_back({.law = DeformationMask{.normal_contact_stiffness = kStiffness}}); }
  void add(const std::type_identity<Proximity>&) { rows.push_back({.law = Proximity{.sensitivity = kStiffness}, .takes_loads = false}); }
  void add(const std::type_identity<ElasticLayer>&) {
    rows.push_back({.law = ElasticLayer{.elastic_modulus = kLayerModulus, .iterations = kMaxLayerIterations, .tolerance = 1e-5},
                    .is_linear = false,
                    .takes_lists = false});
  }
  void add(const std::type_identity<LuGre>&) { rows.push_back({.law = LuGre{.normal_contact_stiffness = kStiffness}}); }
};

std::vector<Law> everyLaw() {
  Laws all;
  [&]<std::size_t... I>(std::index_sequence<I...>) {
    (all.add(std::type_identity<std::variant_alternative_t<I, ContactLaw>>{}), ...);
  }
  (std::make_index_sequence<std::variant_size_v<ContactLaw>>{});
  return all.rows;
}

Sensor sensorOf(const Law& law, DepthSampling sampling, Surface surface) {
  Sensor sensor = surface == Surface::kFlat ? support::gridSensor({.num_rows = 4, .num_cols = 4, .pitch_x = 4e-3, .pitch_y = 4e-3})
                                            : support::sphereFingertip(10e-3, 2, 1.0);
  sensor.depth_sampling = sampling;
  // As few as the reference takes little time for: it integrates over the cells of areas, and solves for all nodes of a layer.
  sensor.samples_per_taxel = sampling == DepthSampling::kArea ? 2 : std::holds_alternative<ElasticLayer>(law.law) ? 3 : 6;
  sensor.skin.law = law.law;
  sensor.skin.thickness = kThickness;
  return sensor;
}

// Poses of each shape, in this order.
enum Pressed { kDeep, kTilted, kAbove, kNumPoses };

// kDeep: lowest point at kDepth. kAbove: far over the skin.
std::vector<Touch> touchesOf(const std::vector<PressedShape>& shapes) {
  constexpr double kApart = 30e-3, kTilt = 0.05;
  std::vector<Touch> touches;
  for (std::size_t n = 0; n < shapes.size(); ++n) {
    const int id = static_cast<int>(n);
    const Vector3 at{0.37e-3, -0.61e-3, shapes[n].lift - kDepth};
    const Quaternion tilted = axisAngle({0.8, 0.6, 0}, kTilt) * shapes[n].rotation;
    touches.push_back({{id}, {{at, shapes[n].rotation}}});
    touches.push_back({{id}, {{{at[0] + 1e-3, at[1] + 1.1e-3, at[2] - 0.2e-3}, tilted}}});
    touches.push_back({{id}, {{{at[0], at[1], at[2] + kApart}, shapes[n].rotation}}});
  }
  return touches;
}

// Errors relative to the largest force or depth. Points: the root of a torus; a law of exponent 2 doubles it. Areas: eight lines per cell
// (scanError() in area_sampling_test.cpp), twice.
double errorOf(DepthSampling sampling) {
  return sampling == DepthSampling::kPoint ? 2 * support::kTorusMarginZ / kDepth : 0.01;
}

// Of the sum over a contact, against the integral over the shape. Points miss or count a row of samples along an outline.
double closedFormErrorOf(const Sensor& sensor, const PressedShape& shape) {
  constexpr double kNarrowest = 3e-3;  // m, of the parts in contact at kDepth
  const bool is_exact = sensor.depth_sampling == DepthSampling::kArea && shape.is_closed;
  return is_exact ? errorOf(DepthSampling::kArea) : sensor.patches[0].pitch[0] / sensor.samples_per_taxel / kNarrowest;
}

class EveryShape : public ::testing::TestWithParam<std::tuple<std::size_t, DepthSampling, Surface>> {
 protected:
  const Law law = everyLaw()[std::get<0>(GetParam())];
  const DepthSampling sampling = std::get<1>(GetParam());
  const Surface surface = std::get<2>(GetParam());
  const Sensor sensor = sensorOf(law, sampling, surface);
  const double skin_area = numTaxels(sensor) * sensor.patches[0].pitch[0] * sensor.patches[0].pitch[1];
  const std::vector<PressedShape> shapes = support::everyPressedShape(skin_area);
  const std::vector<Object> objects = objectsOf(shapes);

  static std::vector<Object> objectsOf(const std::vector<PressedShape>& shapes) {
    std::vector<Object> objects;
    for (const PressedShape& shape : shapes) objects.push_back(shape.object);
    return objects;
  }

  // What the contact exerts along -z of S, N; the sum of the readings where a law has no forces.
  double forceOf(const GroundTruthView& truth, std::size_t i) const {
    if (law.takes_loads) return -truth.contact_wrench[6 * i + 2];
    const auto n = static_cast<std::size_t>(numTaxels(sensor));
    double sum = 0;
    for (std::size_t t = i * n; t < (i + 1) * n; ++t) sum += truth.tactile_normal_force[t];
    return sum;
  }

  void expectReference(const GroundTruthView& truth, std::size_t i, const Touch& touch) const {
    reference::FrameInput input{.objects = touch.placed(objects, truth.load_offset[i])};
    input.dt = kDt;
    const reference::Frame expected = simulateFrame(sensor, input);
    const std::vector<double>&force = expected.taxel_force, &depth = expected.contact.mean_penetration;
    const double most_force = std::max(*std::max_element(force.begin(), force.end()), kFaint);
    const double most_depth = std::max(*std::max_element(depth.begin(), depth.end()), support::kMarginZ);
    double force_error = 0, depth_error = 0;
    for (std::size_t t = 0; t < force.size(); ++t) {
      force_error = std::max(force_error, std::abs(truth.tactile_normal_force[i * force.size() + t] - force[t]));
      depth_error = std::max(depth_error, std::abs(truth.penetration_depth[i * force.size() + t] - depth[t]));
    }
    EXPECT_LE(force_error, errorOf(sampling) * most_force) << most_force;
    EXPECT_LE(depth_error, errorOf(sampling) * most_depth + support::kMarginZ);
    for (std::size_t axis = 0; axis < 3; ++axis) {  // the load of a curved skin is along z of S
      EXPECT_NEAR(truth.contact_wrench[6 * i + axis], expected.wrench[axis], errorOf(sampling) * std::abs(expected.wrench[2]) + kFaint)
          << axis;
    }
  }

  // A force without meaning, N.
  static constexpr double kFaint = 2e-3;
};

TEST_P(EveryShape, PressesAsTheReferenceAndTheClosedForm) {
  if (surface == Surface::kCurved && !law.takes_lists) {
    EXPECT_THROW(Model(support::sharedDevice(), {.sensor = sensor, .objects = objects}), Error);
    return;
  }
  const std::vector<Touch> touches = touchesOf(shapes);
  Simulator simulator = support::makeSimulator(sensor, objects, {.num_instances = static_cast<int>(touches.size())});
  const FrameView posed = support::stepOnce(simulator, touches, kDt);
  support::expectWellFormed(posed, sensor, static_cast<int>(touches.size()));
  const auto& all = posed.ground_truth.tactile_normal_force;
  const std::vector<float> forces(all.begin(), all.end());
  std::vector<float> loads;
  for (std::size_t i = 0; i < touches.size(); ++i) {
    SCOPED_TRACE(objects[i / kNumPoses].name + ", pose " + std::to_string(i % kNumPoses));
    const double force = forceOf(posed.ground_truth, i);
    loads.push_back(static_cast<float>(std::max(force, 0.0)));
    if (i % kNumPoses == kAbove) {
      EXPECT_EQ(force, 0);
      continue;
    }
    EXPECT_GT(force, kFaint);
    // For laws that need moments of cells the reference takes minutes for solids that it integrates over rays; meshes have their contacts,
    // too.
    const Shape& shape = objects[i / kNumPoses].shape;
    const bool has_faces =
        std::holds_alternative<Mesh>(shape) || std::holds_alternative<Box>(shape) || std::holds_alternative<HalfSpace>(shape);
    const bool is_slow = reference::varies(sensor) && !has_faces;
    if (!is_slow) expectReference(posed.ground_truth, i, touches[i]);
    if (i % kNumPoses == kDeep && law.is_linear && surface == Surface::kFlat) {
      EXPECT_NEAR(force / (kStiffness * shapes[i / kNumPoses].volume(kDepth)), 1, closedFormErrorOf(sensor, shapes[i / kNumPoses]));
    }
  }
  if (!law.takes_loads) return;

  // The force of each pose as a load, from elsewhere, finds the pose; on a layer, whose cells are then those at full depth (decision 19),
  // nearly.
  const bool is_layer = std::holds_alternative<ElasticLayer>(sensor.skin.law);
  const bool is_layer_of_cells = is_layer && sampling == DepthSampling::kArea;
  constexpr double kLift = 5e-3, kFound = 2 * support::kTorusMarginZ;
  std::vector<Touch> lifted = touches;
  for (Touch& touch : lifted) touch.X_SO[0].position[2] += kLift;
  for (int i = 0; i < static_cast<int>(touches.size()); ++i) simulator.reset(i, 1);
  const FrameView found = support::stepOnce(simulator, lifted, kDt, loads);
  support::expectWellFormed(found, sensor, static_cast<int>(touches.size()));
  for (std::size_t i = 0; i < touches.size(); ++i) {
    SCOPED_TRACE(objects[i / kNumPoses].name + ", pose " + std::to_string(i % kNumPoses) + " under " + std::to_string(loads[i]) + " N");
    EXPECT_TRUE(found.ground_truth.load_reached[i]);
    EXPECT_NEAR(forceOf(found.ground_truth, i), loads[i], (is_layer ? kCarriedTogether : kCarried) * loads[i]);
    if (i % kNumPoses == kAbove || is_layer_of_cells) continue;
    EXPECT_NEAR(found.ground_truth.load_offset[i], -kLift, kFound);
    const auto n = static_cast<std::size_t>(numTaxels(sensor));
    for (std::size_t t = i * n; t < (i + 1) * n; ++t) {
      EXPECT_NEAR(found.ground_truth.tactile_normal_force[t], forces[t], errorOf(sampling) * loads[i]) << "taxel " << t - i * n;
    }
  }
}
INSTANTIATE_TEST_SUITE_P(Laws, EveryShape,
                         ::testing::Combine(::testing::Range<std::size_t>(0, everyLaw().size()),
                                            ::testing::Values(DepthSampling::kPoint, DepthSampling::kArea),
                                            ::testing::Values(Surface::kFlat, Surface::kCurved)));

// A half-space that does not look down on the skin presses where it holds the skin, at full depth, and nowhere else: a wall over half of a
// grid, however its pose is rounded; no wall beside the sensor; no floor behind it.
TEST(HalfSpace, PressesOnlyWhereItIs) {
  constexpr double kHigh = 0.1, kTilt = 2e-7;     // m, rad
  constexpr double kMoved = 2e-6 * kHigh / 8e-3;  // of the half: kTilt and its rounding move the wall
  const auto wall = [](double x, double angle) { return Touch{{0}, {{{x, 0, kHigh}, axisAngle({0, 1, 0}, angle)}}}; };
  const auto floor = [](double angle) { return Touch{{0}, {{{0, 0, -0.05}, axisAngle({0.6, 0.8, 0}, angle)}}}; };
  const std::vector<Touch> touches{wall(0, kPi / 2),
                                   wall(0, kPi / 2 + kTilt),
                                   wall(0, kPi / 2 - kTilt),
                                   wall(0.02, kPi / 2),
                                   wall(0.02, kPi / 2 + kTilt),
                                   wall(0.02, kPi / 2 - kTilt),
                                   floor(kPi),
                                   floor(0.7 * kPi)};
  constexpr std::size_t kNumHalf = 3;
  for (const DepthSampling sampling : {DepthSampling::kPoint, DepthSampling::kArea}) {
    for (const Surface surface : {Surface::kFlat, Surface::kCurved}) {
      const Sensor sensor = sensorOf({.law = Winkler{kStiffness, 1, 0}}, sampling, surface);
      Simulator simulator = support::makeSimulator(sensor, {Object(HalfSpace{})}, {.num_instances = static_cast<int>(touches.size())});
      const FrameView frame = support::stepOnce(simulator, touches, kDt);
      const double full = kStiffness * kThickness * numTaxels(sensor) * sensor.patches[0].pitch[0] * sensor.patches[0].pitch[1];
      const double half = surface == Surface::kFlat ? full / 2 : -frame.ground_truth.contact_wrench[2];
      EXPECT_GT(half, full / 10);
      for (std::size_t i = 0; i < touches.size(); ++i) {
        const double force = -frame.ground_truth.contact_wrench[6 * i + 2];
        EXPECT_NEAR(force, i < kNumHalf ? half : 0, i < kNumHalf ? kMoved * half : 0)
            << "pose " << i << (sampling == DepthSampling::kArea ? ", areas" : ", points")
            << (surface == Surface::kFlat ? ", flat" : ", curved");
      }
    }
  }
}

}  // namespace
}  // namespace taxelsim
