// Shear starts at zero for new objects, slots and episodes.
#include "simulation/comparison.h"
#include "support/random_scene.h"
#include "support/test.h"

namespace taxelsim {
namespace {

using support::Touch;

constexpr double kDt = 1e-3;  // s

// Shear along x after a slide of 0.1 mm, N. `meddle` may change simulator or objects before the slide.
template <typename Meddle>
double shearAfterSlide(const Model& model, int num_slots, Meddle&& meddle) {
  Simulator simulator(model, {.num_slots = num_slots});
  Touch touch{{0}, {{.position = {0, 0, 0.0095}}}};
  touch.ids.resize(static_cast<std::size_t>(num_slots), kNoObject);
  touch.X_SO.resize(static_cast<std::size_t>(num_slots));
  support::setTouches(simulator, {touch});
  simulator.step(kDt);
  simulator.read();
  touch.X_SO[0].position[0] += 0.1e-3;
  meddle(simulator, touch);
  support::setTouches(simulator, {touch});
  simulator.step(kDt);
  return simulator.read().ground_truth.contact_wrench[0];
}

void expectNewObjectsBeginWithoutShear(const Sensor& sensor) {
  const Model model(support::sharedDevice(), {.sensor = sensor, .objects = {Object(Sphere{0.01}), Object(Sphere{0.01})}});
  for (const int num_slots : {1, 2}) {
    EXPECT_GT(shearAfterSlide(model, num_slots, [](Simulator&, Touch&) {}), 0.1);
    EXPECT_EQ(shearAfterSlide(model, num_slots, [](Simulator& simulator, Touch&) { simulator.reset(0, 1); }), 0);
    EXPECT_EQ(shearAfterSlide(model, num_slots, [](Simulator&, Touch& touch) { touch.ids[0] = 1; }), 0);
  }
  // An object that changes its slot starts without shear.
  EXPECT_EQ(shearAfterSlide(
                model, 2, [](Simulator&, Touch& touch) { std::swap(touch.ids[0], touch.ids[1]), std::swap(touch.X_SO[0], touch.X_SO[1]); }),
            0);
}

TEST(FrictionOnDevice, NewObjectsAndEpisodesBeginWithoutShear) {
  Sensor sensor = support::gridSensor();
  sensor.skin.friction = {1e8, 0.6};
  expectNewObjectsBeginWithoutShear(sensor);
  sensor.skin = {sensor.skin.thickness, LuGre{.normal_contact_stiffness = 1.73e8}, {}};
  expectNewObjectsBeginWithoutShear(sensor);
}

// One object slides and lifts off while another takes its place: its springs are new, although the samples were always in contact.
TEST(FrictionOnDevice, ObjectDoesNotInheritShear) {
  Sensor sensor = support::gridSensor();
  sensor.skin.friction = {1e8, 0.6};
  const Model model(support::sharedDevice(), {.sensor = sensor, .objects = {Object(Box{{8e-3, 8e-3, 0.01}})}});
  Simulator simulator(model, {.num_slots = 2});
  const auto shearAt = [&](const Vector3& first, const Vector3& second) {
    support::setTouches(simulator, {{{0, 0}, {{.position = first}, {.position = second}}}});
    simulator.step(kDt);
    return simulator.read().ground_truth.contact_wrench[0];
  };
  EXPECT_EQ(shearAt({0, 0, 4.5e-3}, {0, 0, 0.03}), 0);
  EXPECT_GT(shearAt({0.1e-3, 0, 4.5e-3}, {0, 0, 0.03}), 0.1);
  EXPECT_EQ(shearAt({0.1e-3, 0, 0.03}, {0, 0, 4.5e-3}), 0);
  EXPECT_GT(shearAt({0.1e-3, 0, 0.03}, {0.1e-3, 0, 4.5e-3}), 0.1);
}

}  // namespace
}  // namespace taxelsim
