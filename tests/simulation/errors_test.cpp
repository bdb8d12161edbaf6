// Invalid input to a model or a simulator is rejected with a one-line message.
#include "simulation/comparison.h"
#include "simulation/model_access.h"
#include "simulation/passes/layer_memory.h"
#include "support/input_error.h"
#include "support/random_scene.h"
#include "support/test.h"
#include "taxelsim/error.h"

namespace taxelsim {
namespace {

using support::inputError;

constexpr double kNan = std::numeric_limits<double>::quiet_NaN();

class Errors : public ::testing::Test {
 protected:
  Model model_{support::sharedDevice(), {.sensor = support::gridSensor(), .objects = {Object(Sphere{0.005}), Object(HalfSpace{})}}};
  Simulator simulator_{model_, {.num_instances = 2, .num_slots = 2}};
  std::vector<int> ids_{0, 1, kNoObject, 0};
  std::vector<Pose> X_SO_{4};
};

TEST_F(Errors, AcceptsValidInput) {
  EXPECT_NO_THROW(simulator_.setObjects(ids_, X_SO_));
  X_SO_[2] = {{kNan, 0, 0}, {0, 0, 0, 0}};  // of an empty slot: ignored
  EXPECT_NO_THROW(simulator_.setObjects(ids_, X_SO_));
  EXPECT_NO_THROW(simulator_.setLoads(std::vector<float>{kPoseDriven, 0}));
  EXPECT_NO_THROW(simulator_.step(1e-3));
  EXPECT_NO_THROW(simulator_.read());
}

TEST_F(Errors, RejectsWrongLengths) {
  inputError([&] { simulator_.setObjects(std::vector<int>{0, 1}, X_SO_); });
  inputError([&] { simulator_.setObjects(ids_, std::vector<Pose>(3)); });
  inputError([&] { simulator_.setObjects(std::vector<int>(8, 0), std::vector<Pose>(8)); });
  inputError([&] { simulator_.setObjects(0, ids_, X_SO_); });
  inputError([&] { simulator_.setLoads(std::vector<float>{1}); });
  inputError([&] { simulator_.setLoads(std::vector<float>{1, 1, 1}); });
}

TEST_F(Errors, RejectsUnknownIds) {
  for (const int id : {2, 1000000, -2, std::numeric_limits<int>::min()}) {
    ids_[1] = id;
    EXPECT_NE(inputError([&] { simulator_.setObjects(ids_, X_SO_); }).find(std::to_string(id)), std::string::npos);
  }
}

TEST_F(Errors, RejectsInvalidPoses) {
  const auto refuse = [&](const Pose& bad) {
    std::vector<Pose> poses = X_SO_;
    poses[3] = bad;
    inputError([&] { simulator_.setObjects(ids_, poses); });
    inputError([&] { simulator_.setObjects(1, std::vector<int>{0, 0}, std::vector<Pose>{Pose{}, bad}); });
  };
  for (const double value : {kNan, std::numeric_limits<double>::infinity(), -std::numeric_limits<double>::infinity()}) {
    refuse({.position = {0, value, 0}});
    refuse({{0, 0, 0}, {1, value, 0, 0}});
  }
  refuse({{0, 0, 0}, {0, 0, 0, 0}});
  refuse({{0, 0, 0}, {1.01, 0, 0, 0}});
  refuse({{0, 0, 0}, {0.5, 0.5, 0.5, 0.4}});
  std::vector<Pose> poses = X_SO_;
  poses[3].rotation = {1.0005, 0, 0, 0};  // within 1e-3: taken, and made of unit length
  EXPECT_NO_THROW(simulator_.setObjects(ids_, poses));
}

TEST_F(Errors, RejectedInputChangesNothing) {
  X_SO_[0].position = {0, 0, 0.0045};
  ids_ = {0, kNoObject, 0, kNoObject};
  simulator_.setObjects(ids_, X_SO_);
  const auto before = support::bitsOf(support::stepOnce(simulator_, 1e-3), 0, 2);
  X_SO_[0].position = {0, 0, 0.004};
  X_SO_[2].position = {0, kNan, 0};
  inputError([&] { simulator_.setObjects(ids_, X_SO_); });
  EXPECT_EQ(support::bitsOf(support::stepOnce(simulator_, 1e-3), 0, 2), before);
}

TEST_F(Errors, RejectsInvalidLoads) {
  for (const float load : {-1.0f, std::numeric_limits<float>::infinity(), -std::numeric_limits<float>::infinity()}) {
    inputError([&] { simulator_.setLoads(std::vector<float>{0, load}); });
    inputError([&] { simulator_.setLoad(1, load); });
  }
}

TEST_F(Errors, RejectsInstancesOutOfRange) {
  for (const int instance : {-1, 2, 1000}) {
    inputError([&] { simulator_.setLoad(instance, 1); });
    inputError([&] { simulator_.reset(instance, 0); });
    inputError([&] { simulator_.setObjects(instance, std::vector<int>{0, 0}, std::vector<Pose>(2)); });
  }
}

TEST_F(Errors, RejectsInvalidSteps) {
  for (const double dt : {0.0, -1e-3, kNan, std::numeric_limits<double>::infinity()}) {
    inputError([&] { simulator_.step(dt); });
  }
}

TEST_F(Errors, RejectsInvalidVariations) {
  const float nan = std::numeric_limits<float>::quiet_NaN();
  inputError([&] { simulator_.reset(0, 0, {.gain = nan}); });
  inputError([&] { simulator_.reset(0, 0, {.gain_spread = -0.1f}); });
  inputError([&] { simulator_.reset(0, 0, {.noise = -1}); });
}

TEST_F(Errors, RejectsBatchesOutOfRange) {
  inputError([&] { Simulator(model_, {.num_instances = 0}); });
  inputError([&] { Simulator(model_, {.num_instances = -5}); });
  inputError([&] { Simulator(model_, {.num_slots = 0}); });
  inputError([&] { Simulator(model_, {.num_slots = kMaxSlots + 1}); });
}

TEST_F(Errors, TooLargeBatchNamesTheSizeThatFits) {
  SimulatorOptions options{.num_instances = std::numeric_limits<int>::max()};
  const MemoryPlan plan = Simulator::plan(model_, options);
  EXPECT_GT(plan.bytes_per_instance, 0u);
  ASSERT_GT(plan.max_instances, 0u);
  ASSERT_LT(plan.max_instances, static_cast<std::uint64_t>(options.num_instances)) << "the device holds any batch";
  const std::string message = inputError([&] { Simulator(model_, options); });
  EXPECT_NE(message.find(std::to_string(plan.max_instances)), std::string::npos) << message;
}

TEST(ModelErrors, RejectsInvalidModels) {
  const Sensor sensor = support::gridSensor();
  const Object sphere(Sphere{0.005});
  inputError([&] { Simulator(Model(support::sharedDevice(), {.sensor = sensor}), {}); });
  inputError([&] { Model(support::sharedDevice(), {.sensor = sensor, .objects = {Object(Sphere{-1})}}); });
  inputError([&] { Model(support::sharedDevice(), {.sensor = sensor, .objects = {sphere, Object("empty", Mesh{})}}); });
  Sensor bad = sensor;
  bad.skin.thickness = 0;
  inputError([&] { Model(support::sharedDevice(), {.sensor = bad, .objects = {sphere}}); });
  for (const int workgroup : {3, 2, 512, -8}) {
    inputError([&] { Model(support::sharedDevice(), {.sensor = sensor, .objects = {sphere}, .contact_workgroup = workgroup}); });
    inputError([&] { Model(support::sharedDevice(), {.sensor = sensor, .objects = {sphere}, .image_workgroup = workgroup}); });
  }
}

// Each value of a tuning is checked, and the message names it.
TEST(ModelErrors, RejectsInvalidTunings) {
  const Sensor sensor = support::gridSensor();
  const auto refused = [&](const Tuning& tuning, int image_workgroup = 0) {
    return inputError([&] {
      ModelAccess::make(support::sharedDevice(), {.sensor = sensor, .objects = {Object(Sphere{0.005})}, .image_workgroup = image_workgroup},
                        tuning);
    });
  };
  for (const int number : {-1, 65, 1 << 30}) {
    EXPECT_THAT(refused({.contact_repeat = number}), ::testing::StartsWith("tuning.contact_repeat: " + std::to_string(number) + " "));
    EXPECT_THAT(refused({.image_repeat = number}), ::testing::StartsWith("tuning.image_repeat: " + std::to_string(number) + " "));
  }
  for (const int number : {-16, 8, 24, 256}) {
    EXPECT_THAT(refused({.groups_per_batch = number}), ::testing::StartsWith("tuning.groups_per_batch: " + std::to_string(number) + " "));
  }
  // A team must not exceed its workgroup.
  for (const int number : {-2, 3, 32}) {
    EXPECT_THAT(refused({.image_team = number}, 16), ::testing::HasSubstr("a power of two, 1 to 16")) << number;
  }
}

// 1024 rows of samples take 8 KiB; 64 partial sums 1 KiB, with friction half as much again and 512 bytes.
TEST(ModelErrors, RejectsALayerWithMoreRowsThanSharedMemoryHolds) {
  Sensor sensor = support::gridSensor({.samples_per_taxel = 16});
  const LayerNodes nodes{.num_rows = 1024, .num_cols = 8};
  DeviceInfo small;
  small.name = "small";
  small.shared_memory = 9228;
  checkLayerFits(small, sensor, nodes, 64);
  small.shared_memory = 9227;
  EXPECT_THAT(
      inputError([&] { checkLayerFits(small, sensor, nodes, 64); }),
      ::testing::HasSubstr("samples_per_taxel: 16 is not allowed: an elastic layer with 1024 rows of samples takes 9228 bytes of shared "
                           "memory, device \"small\" has 9227"));
  sensor.skin.friction = {.tangential_stiffness = 1e8, .friction_coefficient = 0.5};
  EXPECT_THAT(inputError([&] { checkLayerFits(small, sensor, nodes, 64); }), ::testing::HasSubstr("takes 10252 bytes"));
}

// 128 teams of two with the partial sums of 64 lanes need half a megabyte of shared memory, more than any device has.
TEST(ModelErrors, RejectsATuningThatNeedsTooMuchSharedMemory) {
  Sensor sensor = support::gridSensor();
  sensor.patches[0].num_rows = 64;
  const std::string message = inputError([&] {
    ModelAccess::make(support::sharedDevice(), {.sensor = sensor, .objects = {Object(Sphere{0.005})}, .image_workgroup = 256},
                      {.image_team = 2});
  });
  EXPECT_THAT(message, ::testing::HasSubstr(std::to_string(4 * 128 * 19 * 64) + " bytes"));
  EXPECT_THAT(message, ::testing::HasSubstr(std::to_string(support::sharedDevice().info().shared_memory)));
}

}  // namespace
}  // namespace taxelsim
