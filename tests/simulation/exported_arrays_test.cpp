// Inputs and outputs that another interface of the device imports: steps without a wait of the host give the same bits as steps with one.
// Here the importer maps what Mesa's software driver exports, a memfd whose data begins at byte 4096.
#include <sys/mman.h>
#include <unistd.h>

#include "simulation/comparison.h"
#include "support/random_scene.h"
#include "support/test.h"
#include "taxelsim/error.h"

namespace taxelsim {
namespace {

constexpr double kDt = 0.01;                                   // s
constexpr int kInstances = 1000, kPlaces = 3, kStepsEach = 4;  // enough for a frame to outlast what the host does for the next one
constexpr off_t kFirstByte = 4096;

void* map(int descriptor, std::uint64_t bytes) {
  void* const data = ::mmap(nullptr, bytes, PROT_READ | PROT_WRITE, MAP_SHARED, descriptor, kFirstByte);
  ::close(descriptor);
  return data;
}

std::vector<Pose> posesAt(int place) {
  std::vector<Pose> poses(kInstances);
  for (int i = 0; i < kInstances; ++i) poses[static_cast<std::size_t>(i)].position = {2e-4 * place, 5e-6 * i, 0.0095 - 5e-5 * place};
  return poses;
}

class ExportedArrays : public ::testing::Test {
 protected:
  // The frames before count although objects rest: shear, relaxation, and an offset that drifts by the random numbers of each frame.
  static Simulator make(bool exported) {
    Sensor sensor = support::gridSensor({.num_rows = 6, .num_cols = 8, .samples_per_taxel = 2});
    sensor.skin.friction = {.tangential_stiffness = 1e8, .friction_coefficient = 0.6};
    sensor.skin.relaxation = {{.fraction = 0.4, .time = 0.05}};
    sensor.readout.noise = 5;
    sensor.readout.random_walk = 300;
    return support::makeSimulator(sensor, {Object(Sphere{0.01})},
                                  {.num_instances = kInstances, .outputs = {.vjp = true}, .export_memory = exported});
  }
  static void write(const ExportedInputs& inputs, int place) {
    std::ranges::fill(inputs.ids, 0);
    const std::vector<Pose> poses = posesAt(place);
    std::memcpy(inputs.poses.data(), poses.data(), inputs.poses.size_bytes());
  }
};

TEST_F(ExportedArrays, HaveTheBitsOfTheHostAfterStepsWithoutAWait) {
  Simulator on_host = make(false), on_device = make(true);
  const FrameView imported = on_device.exportOutputs(map);
  const ExportedInputs inputs = on_device.exportInputs(map);
  const std::vector<float> cotangent(imported.tactile_image.size(), 0.5f);
  for (int place = 0; place < kPlaces; ++place) {
    write(inputs, place);
    on_host.setObjects(std::vector<int>(kInstances, 0), posesAt(place));
    const int num_steps = kStepsEach + place;  // even and odd numbers
    for (int step = 0; step < num_steps; ++step) on_device.step(kDt);
    on_device.read();
    FrameView expected;
    for (int step = 0; step < num_steps; ++step) {
      on_host.step(kDt);
      expected = on_host.read();
    }
    EXPECT_THAT(expected.tactile_image, ::testing::Contains(::testing::Gt(0u)));
    EXPECT_TRUE(std::ranges::equal(imported.tactile_image, expected.tactile_image)) << place;
    EXPECT_TRUE(std::ranges::equal(imported.ground_truth.tactile_shear_force, expected.ground_truth.tactile_shear_force)) << place;
    EXPECT_TRUE(std::ranges::equal(imported.ground_truth.load_reached, expected.ground_truth.load_reached)) << place;
    EXPECT_TRUE(std::ranges::equal(on_device.vjp(cotangent).twist, on_host.vjp(cotangent).twist)) << place;
    on_device.reset(place, 5);
    on_host.reset(place, 5);
  }
}

TEST_F(ExportedArrays, NameWhatIsNotAllowedInAnEarlierStep) {
  Simulator simulator = make(true);
  const ExportedInputs inputs = simulator.exportInputs(map);
  write(inputs, 0);
  inputs.ids[5] = 1;
  simulator.step(kDt);
  simulator.step(kDt);  // the host has not waited for the first step
  try {
    simulator.step(kDt);
    FAIL() << "no error";
  } catch (const Error& error) {
    EXPECT_EQ(error.kind(), ErrorKind::kInput);
    EXPECT_THAT(error.what(), ::testing::HasSubstr("inputs of instance 5: an object or a pose is not allowed: objects 0 to 0"));
  }
}

TEST_F(ExportedArrays, NeedTheOption) {
  Simulator simulator = make(false);
  EXPECT_THROW(simulator.exportOutputs(map), std::logic_error);
  EXPECT_THROW(simulator.exportInputs(map), std::logic_error);
  EXPECT_EQ(simulator.exportTimeline(), -1);
}

}  // namespace
}  // namespace taxelsim
