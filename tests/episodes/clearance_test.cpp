// Distances between taxels and objects.
#include "episodes/clearance.h"

#include "episodes/example_scene.h"
#include "support/test.h"

namespace taxelsim {
namespace {

constexpr double kPi = std::numbers::pi, kRounding = 1e-12;  // m

// The array of the example is 20.4 x 47.6 mm.
TEST(Clearance, IsTheGapBetweenTheBoxes) {
  struct Case {
    const char* what;
    Object object;
    Pose X_SO;
    double distance;
  };
  const Object ball("ball", Sphere{.radius = 0.01}), box("box", Box{.size = {0.02, 0.04, 0.06}}), plane("plane", HalfSpace{});
  const Quaternion turned = axisAngle({0, 0, 1}, kPi / 4), tilted = axisAngle({0, 1, 0}, kPi / 6);
  const std::vector<Case> cases{
      {"touches", ball, {{0, 0, 9e-3}, {1, 0, 0, 0}}, 0},
      {"above", ball, {{0, 0, 0.44}, {1, 0, 0, 0}}, 0.43},
      {"behind", ball, {{0, 0, -0.44}, {1, 0, 0, 0}}, 0.43},
      {"beside", ball, {{0.0102 + 0.01 + 0.3, 0.0238 + 0.01 + 0.4, 0}, {1, 0, 0, 0}}, 0.5},
      {"a corner of a turned box", box, {{0.0102 + 0.03 / std::numbers::sqrt2 + 0.2, 0, 0}, turned}, 0.2},
      {"a plane above", plane, {{5, 5, 0.2}, {1, 0, 0, 0}}, 0.2},
      {"a plane that contains the skin", plane, {{5, 5, -0.2}, {1, 0, 0, 0}}, 0},
      {"a tilted plane", plane, {{0, 0, 0.1}, tilted}, 0.1 * std::cos(kPi / 6) - 0.0102 * std::sin(kPi / 6)},
  };
  const Sensor sensor = exampleScene().sensor;
  for (const auto& [what, object, X_SO, distance] : cases) {
    const std::vector<SceneObject> objects{{.object = object}};
    EXPECT_NEAR(Clearance(sensor, objects).of(0, X_SO), distance, kRounding) << what;
  }
  EXPECT_NEAR(Clearance(sensor, {}).of({0, 0.0238 + 7.5, 0}), 7.5, kRounding);
}

}  // namespace
}  // namespace taxelsim
