// Objects that are far from a sensor are not sent to the device, and change no bit.
#include "simulation/near_slots.h"

#include "simulation/comparison.h"
#include "simulation/friction_paths.h"
#include "support/curved_sensor.h"
#include "support/random_scene.h"
#include "support/test.h"

namespace taxelsim {
namespace {

using support::Random;
using support::Touch;

constexpr double kDt = 1e-3;  // s

// How many poses an instance with these objects (0 in all slots) sends, of which `num_near` are in contact.
std::size_t numSent(const ModelData& model, int num_slots, int num_near, float load) {
  NearSlots slots(model, 1, static_cast<std::size_t>(num_slots));
  for (int slot = 0; slot < num_slots; ++slot) {
    const double away = slot < num_near ? 0.0045 : 0.05;
    slots.place(0, static_cast<std::size_t>(slot), 0, {.position = {slot % 2 == 0 ? 0 : away, 0, away}});
  }
  std::vector<layout::PoseRecord> poses(static_cast<std::size_t>(num_slots));
  ThreadTeam alone(1);
  const std::size_t sent = slots.pack(std::span(&load, 1), poses, alone);
  EXPECT_EQ(poses[0].object.x, sent == 1 && num_near == 0 ? kNoObject : 0);
  EXPECT_LE(std::popcount(slots.of(0)), static_cast<int>(sent));
  return sent;
}

TEST(NearSlots, SendOnlyWhatIsNear) {
  for (const bool is_curved : {false, true}) {
    const Sensor sensor = is_curved ? support::frictionSensor() : support::gridSensor();
    const ModelData model(support::sharedDevice(), {.sensor = sensor, .objects = {Object(Sphere{0.005})}});
    EXPECT_EQ(numSent(model, 8, 0, kPoseDriven), 1u);
    EXPECT_EQ(numSent(model, 8, 1, kPoseDriven), 1u);
    EXPECT_EQ(numSent(model, 8, 3, kPoseDriven), 3u);
    EXPECT_EQ(numSent(model, 8, 1, 1.0f), 8u) << "a load search moves all objects";
  }
}

// A ball that is wholly behind the skin, as one at the back of a hand's palm, presses on nothing, with one slot and with several; one that
// crosses the skin's base is at full depth.
TEST(NearSlotsOnEveryDriver, ObjectsBehindTheSkinPressOnNothing) {
  constexpr double kRadius = 5e-3;
  Random random(7);
  Sensor plain = support::gridSensor(), tilted = plain;
  tilted.patches[0].X_SP = {{0.01, -0.02, 0.005}, random.tilt(0.6)};
  for (const Sensor& sensor : {plain, tilted}) {
    const Model model(support::sharedDevice(), {.sensor = sensor, .objects = {Object(Sphere{kRadius}), Object(HalfSpace{})}});
    for (const int num_slots : {1, 2}) {
      Simulator simulator(model, {.num_instances = 3, .num_slots = num_slots});
      const auto at = [&](double height) { return sensor.patches[0].X_SP * Pose{{0, 0, height}}; };
      std::vector<Touch> touches{{{0}, {at(-0.05)}}, {{0}, {at(-kRadius - 0.5 * sensor.skin.thickness)}}, {{1}, {at(-0.05)}}};
      if (num_slots == 2) {
        for (Touch& touch : touches) touch = {{kNoObject, touch.ids[0]}, {Pose{}, touch.X_SO[0]}};
      }
      const FrameView frame = support::stepOnce(simulator, touches, kDt);
      EXPECT_EQ(frame.ground_truth.total_force[0], 0);
      EXPECT_EQ(frame.ground_truth.over_penetration[0], 0);
      EXPECT_GT(frame.ground_truth.over_penetration[1], 0);
      EXPECT_EQ(frame.ground_truth.over_penetration[2], 1) << "a half-space has no back";
    }
  }
}

// Objects: a solid and a mesh, which keeps candidates while it is the only one that is near.
std::vector<Object> objects() {
  Random random(3);
  return {Object("sphere", Sphere{0.01}), Object("mesh", support::icosphere(0.01, 4, 0.0, random))};
}

// Bits of instance 1 over a slide. Its object `id` is in the last of three slots, near; far ones are in the others if `with_far`. Instance
// 0 has two near objects in the steps whose bits of `busy_steps` are set, else one.
std::vector<std::vector<std::uint32_t>> slide(const Model& model, int id, bool with_far, unsigned busy_steps) {
  const Pose near{.position = {0, 0, 0.0095}}, far{.position = {0.1, 0, 0.3}};
  Simulator simulator(model, {.num_instances = 2, .num_slots = 3, .outputs = {.penetration_depth = true}});
  std::vector<std::vector<std::uint32_t>> bits;
  for (unsigned step = 0; step < 6; ++step) {
    Pose moved = near;
    moved.position[0] += 2e-5 * step;
    const bool is_busy = (busy_steps >> step & 1u) != 0;
    const int other = with_far ? 1 - id : kNoObject;
    bits.push_back(support::bitsOf(
        support::stepOnce(simulator, {{{0, 1, 1}, {near, is_busy ? moved : far, far}}, {{other, other, id}, {far, far, moved}}}, kDt), 1,
        2));
  }
  return bits;
}

TEST(NearSlotsOnEveryDriver, OtherObjectsAndInstancesChangeNoBit) {
  Sensor plain = support::gridSensor({.num_rows = 5, .num_cols = 7, .samples_per_taxel = 2});
  Sensor sticky = plain, bristles = plain, layer = plain, area = plain;
  sticky.skin.friction = {.tangential_stiffness = 5e7, .friction_coefficient = 0.8};
  bristles.skin.law = LuGre{.normal_contact_stiffness = 1.73e8};
  layer.skin.law = ElasticLayer{.elastic_modulus = 1e6, .poisson_ratio = 0.49};
  layer.skin.friction = sticky.skin.friction;
  area.depth_sampling = DepthSampling::kArea;
  area.skin.friction = sticky.skin.friction;
  for (const Sensor& sensor : {plain, sticky, bristles, layer, area}) {
    const Model model(support::sharedDevice(), {.sensor = sensor, .objects = objects()});
    for (const int id : {0, 1}) {
      const auto alone = slide(model, id, false, 0);
      EXPECT_EQ(slide(model, id, true, 0), alone) << "far objects, object " << id << ", law " << sensor.skin.law.index();
      EXPECT_EQ(slide(model, id, true, 0b111111), alone) << "another instance, object " << id << ", law " << sensor.skin.law.index();
      EXPECT_EQ(slide(model, id, true, 0b001010), alone) << "from step to step, object " << id << ", law " << sensor.skin.law.index();
    }
  }
}

// With one slot the device itself decides what is near. Objects around the border of the sensor, some of them in contact.
void expectEqualWithOneSlot(const Sensor& sensor, const std::vector<Object>& all, double reach, std::uint64_t seed) {
  constexpr int kNumInstances = 64;
  Random random(seed);
  std::vector<Touch> one, two;
  for (int i = 0; i < kNumInstances; ++i) {
    const int id = random.integer(0, static_cast<int>(all.size()) - 1);
    Pose pose = support::randomContact(random, sensor, all[static_cast<std::size_t>(id)]);
    pose.position[0] += random.uniform(-0.02, 0.02);
    pose.position[1] += random.uniform(-0.03, 0.03);
    pose.position[2] += random.chance(0.5) ? 0 : random.uniform(-reach, 2 * reach);
    one.push_back({{id}, {pose}});
    two.push_back({{kNoObject, id}, {Pose{}, pose}});
  }
  const Model model(support::sharedDevice(), {.sensor = sensor, .objects = all});
  std::vector<std::vector<std::uint32_t>> bits;
  int num_touched = 0;
  for (const std::vector<Touch>& touches : {one, two}) {
    const auto num_slots = static_cast<int>(touches[0].ids.size());
    Simulator simulator(model, {.num_instances = kNumInstances, .num_slots = num_slots, .outputs = {.penetration_depth = true}});
    const FrameView frame = support::stepOnce(simulator, touches, kDt);
    for (int i = 0; i < kNumInstances; ++i) {
      bits.push_back(support::bitsOf(frame, i, kNumInstances));
      num_touched += std::abs(frame.ground_truth.total_force[static_cast<std::size_t>(i)]) > 0 ? 1 : 0;
    }
  }
  EXPECT_GT(num_touched, kNumInstances / 4);
  EXPECT_LT(num_touched, 2 * kNumInstances - kNumInstances / 4);
  for (std::size_t i = 0; i < kNumInstances; ++i) EXPECT_EQ(bits[i], bits[i + kNumInstances]) << "seed " << seed << ", instance " << i;
}

TEST(NearSlotsOnEveryDriver, LeaveOutNothingThatTouches) {
  Random random(11);
  Sensor grid = support::gridSensor(), area = grid, tilted = grid;
  area.depth_sampling = DepthSampling::kArea;
  tilted.patches[0].X_SP = {{0.01, -0.02, 0.005}, random.tilt(0.6)};
  std::vector<Object> all = support::randomObjects(random, 6, 0.02, 0.5, false);
  all.emplace_back("half_space", HalfSpace{});
  std::uint64_t seed = 0;
  for (const Sensor& sensor : {grid, area, tilted, support::cylinderFingertip(0.008, 1.2, 6, 5, 3e-3)})
    expectEqualWithOneSlot(sensor, all, 2e-3, ++seed);
}

}  // namespace
}  // namespace taxelsim
