// A step allocates no memory once every kind of step has run, neither in this library nor in the C++ code of the driver.
#include "simulation/comparison.h"
#include "support/allocations.h"
#include "support/random_scene.h"
#include "support/test.h"

namespace taxelsim {
namespace {

constexpr int kNumInstances = 8;
constexpr int kWarmUps = 3, kSteps = 10;
constexpr double kDt = 0.01;  // s

struct Kind {
  const char* name;
  Sensor (*sensor)();
  bool loads;
  bool everything;  // all outputs there are
};

Sensor plain() {
  return support::gridSensor({.num_rows = 5, .num_cols = 7, .samples_per_taxel = 2, .law = {1.73e8, 1, 1e5}});
}

Sensor noisy() {
  Sensor sensor = plain();
  sensor.readout = support::paperReadout();
  sensor.readout.noise = 5;
  sensor.readout.jitter = 1e-3;
  sensor.frame_rate = 60;
  return sensor;
}

Sensor withFriction() {
  Sensor sensor = plain();
  sensor.skin.friction = {.tangential_stiffness = 5e7, .friction_coefficient = 0.8};
  return sensor;
}

class SteadyStep : public ::testing::TestWithParam<Kind> {};

// A simulator with slow objects, half of them meshes with enough triangles for candidates.
class Stepper {
 public:
  explicit Stepper(const Kind& kind)
      : random_(5), sensor_(kind.sensor()), model_(support::openUnvalidated(), optionsOf()), simulator_(model_, of(kind)) {
    for (int i = 0; i < kNumInstances; ++i) {
      ids_.push_back(i % 2);
      X_SO_.push_back(support::randomContact(random_, sensor_, model_.objects()[static_cast<std::size_t>(i % 2)]));
    }
    forces_.assign(kNumInstances, kind.loads ? 1.0f : kPoseDriven);
    cotangent_.assign(static_cast<std::size_t>(kNumInstances * numTaxels(sensor_)), 1.0f);
    simulates_gradients_ = kind.everything;
  }

  Simulator& simulator() { return simulator_; }

  void step() {
    for (Pose& pose : X_SO_) pose.position[0] += 1e-5;
    simulator_.setObjects(ids_, X_SO_);
    simulator_.setLoads(forces_);
    simulator_.step(kDt);
    simulator_.read();
    if (simulates_gradients_) simulator_.vjp(cotangent_);
  }

 private:
  ModelOptions optionsOf() {
    return {.sensor = sensor_,
            .objects = {Object("ball", Sphere{.radius = 8e-3}), Object("bumps", support::icosphere(0.01, 3, 0.02, random_))}};
  }
  static SimulatorOptions of(const Kind& kind) {
    return {.num_instances = kNumInstances,
            .seed = 3,
            .outputs = {.contact_features = kind.everything,
                        .clean_contact_features = kind.everything,
                        .tactile_jacobian = kind.everything,
                        .clean_tactile_jacobian = kind.everything,
                        .vjp = kind.everything}};
  }

  support::Random random_;
  Sensor sensor_;
  Model model_;
  Simulator simulator_;
  std::vector<int> ids_;
  std::vector<Pose> X_SO_;
  std::vector<float> forces_, cotangent_;
  bool simulates_gradients_ = false;
};

TEST_P(SteadyStep, AllocatesNothing) {
  Stepper stepper(GetParam());
  for (int i = 0; i < kWarmUps; ++i) stepper.step();
  const support::NoAllocations watch;
  for (int i = 0; i < kSteps; ++i) stepper.step();
  EXPECT_EQ(watch.count(), 0u) << "in " << kSteps << " steps";
}

// After prepare() nothing is recorded or compiled, so even the first step allocates nothing.
TEST_P(SteadyStep, AllocatesNothingAfterPrepare) {
  Stepper stepper(GetParam());
  stepper.simulator().prepare(GetParam().loads);
  const support::NoAllocations watch;
  for (int i = 0; i < kSteps; ++i) stepper.step();
  EXPECT_EQ(watch.count(), 0u) << "in " << kSteps << " steps";
}

INSTANTIATE_TEST_SUITE_P(Kinds, SteadyStep,
                         ::testing::Values(Kind{"poses", plain, false, false}, Kind{"loads", plain, true, false},
                                           Kind{"noise", noisy, true, false}, Kind{"friction", withFriction, false, false},
                                           Kind{"everything", plain, false, true}),
                         [](const auto& param) { return std::string(param.param.name); });

TEST(SteadyStep, AllocationsAreCounted) {
  const support::NoAllocations watch;
  const auto mine = std::make_unique<std::vector<double>>(1000);
  const Sensor copied = noisy();
  EXPECT_GT(watch.count(), 2u);
}

}  // namespace
}  // namespace taxelsim
