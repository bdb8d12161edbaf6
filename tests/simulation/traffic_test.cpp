// What a simulator counts of its exchange with the device. Sizes are written out, not taken from the structs that the code sends.
#include "simulation/comparison.h"
#include "support/random_scene.h"
#include "support/test.h"

namespace taxelsim {
namespace {

constexpr double kDt = 0.01;  // s
constexpr std::uint64_t kInstances = 5, kTaxels = 24;

// Bytes to the device.
constexpr std::uint64_t kPose = 3 * 16 + 16;    // rows of (R | p), index of the object
constexpr std::uint64_t kMotion = 3 * 16 + 16;  // rows of (A | t), whether it is known
constexpr std::uint64_t kKeysAndClock = 2 * 16;
constexpr std::uint64_t kRecord = 5 * 16;  // load and variation, keys, clock, two of the skin
constexpr std::uint64_t kStep = 12 * 16;
constexpr std::uint64_t kLoadSearch = 2 * 16;

// Bytes from the device.
constexpr std::uint64_t kImage = 4 * kTaxels;
constexpr std::uint64_t kFeatures = 4 * 40;
constexpr std::uint64_t kOfBatch = 16 + 6 * 16;  // problems, work lists

class Traffic : public ::testing::Test {
 protected:
  static Sensor sensor() { return support::gridSensor({.num_rows = 4, .num_cols = 6, .samples_per_taxel = 2}); }
  static std::vector<Object> spheres() { return {Object(Sphere{0.005})}; }
  static SimulatorOptions options() { return {.num_instances = kInstances, .outputs = kNoOutputs}; }
  static void place(Simulator& simulator, std::size_t num_slots) {
    simulator.setObjects(std::vector<int>(kInstances * num_slots, 0),
                         std::vector<Pose>(kInstances * num_slots, {.position = {0, 0, 0.0045}}));
  }
  // Of one step.
  static DeviceTraffic step(Simulator& simulator) {
    const DeviceTraffic before = simulator.traffic();
    support::stepOnce(simulator, kDt);
    return since(simulator, before);
  }
  static DeviceTraffic since(const Simulator& simulator, const DeviceTraffic& before) {
    const DeviceTraffic now = simulator.traffic();
    return {now.num_submits - before.num_submits, now.bytes_to_device - before.bytes_to_device,
            now.bytes_from_device - before.bytes_from_device};
  }
};

TEST_F(Traffic, StartsAtZeroAndGrowsByTheSameInEveryStep) {
  Simulator simulator = support::makeSimulator(sensor(), spheres(), options());
  EXPECT_EQ(simulator.traffic(), DeviceTraffic{});
  place(simulator, 1);
  EXPECT_EQ(simulator.traffic(), DeviceTraffic{});  // sent by the step
  for (int k = 0; k < 3; ++k) {
    EXPECT_EQ(step(simulator),
              (DeviceTraffic{1, kInstances * (kPose + kKeysAndClock) + kStep, kInstances * (kImage + kFeatures) + kOfBatch}));
  }
  EXPECT_EQ(simulator.traffic().num_submits, 3u);
}

TEST_F(Traffic, CountsRecordsWhenTheyAreSetAndOutputsThatAreOn) {
  const Model model(support::sharedDevice(), {.sensor = sensor(), .objects = spheres()});
  SimulatorOptions all = options();
  all.outputs = {.tactile_normal_force = true, .tactile_shear_force = true, .penetration_depth = true, .vjp = true};
  Simulator simulator(model, all);
  place(simulator, 1);
  simulator.reset(2, 7);
  EXPECT_EQ(simulator.traffic(), (DeviceTraffic{0, kRecord, 0}));
  simulator.setLoad(1, 1.0f);
  EXPECT_EQ(simulator.traffic(), (DeviceTraffic{0, kRecord + 4, 0}));
  const DeviceTraffic loaded = step(simulator);
  const std::uint64_t plain = kInstances * (kPose + kKeysAndClock) + kStep;
  EXPECT_TRUE(loaded.bytes_to_device == plain || loaded.bytes_to_device == plain + kInstances * kLoadSearch) << loaded.bytes_to_device;
  EXPECT_EQ(loaded.bytes_from_device, kInstances * (kImage + 4 * 4 * kTaxels + kFeatures) + kOfBatch);

  const DeviceTraffic before = simulator.traffic();
  simulator.vjp(std::vector<float>(kInstances * kTaxels, 1.0f));
  EXPECT_EQ(since(simulator, before), (DeviceTraffic{1, kInstances * 4 * kTaxels, kInstances * (4 * 6 + 4 * kTaxels) + 16}));
}

TEST_F(Traffic, CountsNearSlotsAndTheirMotions) {
  Sensor rough = sensor();
  rough.skin.friction = {.tangential_stiffness = 5e7, .friction_coefficient = 0.8};
  const Model model(support::sharedDevice(), {.sensor = rough, .objects = spheres()});
  SimulatorOptions two = options();
  two.num_slots = 2;
  Simulator simulator(model, two);
  place(simulator, 2);
  EXPECT_EQ(step(simulator).bytes_to_device, kInstances * (2 * (kPose + kMotion) + kKeysAndClock) + kStep);
  // Far slots are not sent.
  for (int i = 0; i < static_cast<int>(kInstances); ++i) {
    simulator.setObjects(i, std::vector{0, 0}, std::vector<Pose>{{.position = {0, 0, 0.0045}}, {.position = {0, 0, 1}}});
  }
  EXPECT_EQ(step(simulator).bytes_to_device, kInstances * (kPose + kMotion + kKeysAndClock) + kStep);
}

TEST_F(Traffic, CountsContactPoints) {
  const Model model(support::sharedDevice(), {.sensor = sensor()});
  SimulatorOptions points = options();
  points.max_contacts = 8;
  Simulator simulator(model, points);
  simulator.setContacts(3,
                        std::vector<ContactPoint>{{.position = {0, 0, 0}, .normal_force = 1}, {.position = {0, 0, 0}, .normal_force = 2}});
  EXPECT_EQ(simulator.traffic(), (DeviceTraffic{0, 2 * 16 + 4, 0}));
  EXPECT_EQ(step(simulator).bytes_to_device, kInstances * kKeysAndClock + kStep);
}

}  // namespace
}  // namespace taxelsim
