// LuGre bristles against closed forms, Runge-Kutta integration, and the published Stribeck curve.
#include "reference/lugre.h"

#include "reference/frame.h"
#include "support/random_scene.h"
#include "support/test.h"

namespace taxelsim {
namespace {

using reference::Bristles;
using reference::Shear;
using reference::updateBristles;
using support::Random;

// Relative: a dozen operations in double.
constexpr double kExact = 1e-12;
constexpr LuGre kLuGre{.normal_contact_stiffness = 1.73e8};

double sizeOf(const Shear& v) {
  return std::hypot(v[0], v[1]);
}

// Traction ratio after sliding by `distance` (m) along x at `speed` (m/s), in num_steps steps.
double tractionRatioAfter(const LuGre& law, double speed, double distance, int num_steps) {
  Bristles bristles;
  for (int n = 0; n < num_steps; ++n)
    bristles = updateBristles(law, bristles.deflection, {distance / num_steps, 0}, 1, distance / num_steps / speed);
  return bristles.traction_ratio[0];
}

// Steady-state values for the parameters of the LuGre paper, per newton of normal force.
TEST(LuGreTwin, SteadySlidingFollowsTheStribeckCurve) {
  const double distance = 50 * kLuGre.static_friction / kLuGre.bristle_stiffness;
  constexpr double kDigits = 5e-6;
  EXPECT_NEAR(tractionRatioAfter(kLuGre, 1e-4, distance, 7), 1.49506, kDigits);
  EXPECT_NEAR(tractionRatioAfter(kLuGre, 1e-3, distance, 7), 1.18434, kDigits);
  EXPECT_NEAR(tractionRatioAfter(kLuGre, 1e-2, distance, 7), 1.00400, kDigits);
  EXPECT_NEAR(tractionRatioAfter(kLuGre, 0.1, distance, 7), 1.04000, kDigits);
  for (double speed = 1e-7; speed < 10; speed *= 1.3) {
    const double curve = 1 + 0.5 * std::exp(-speed * speed / 1e-6) + 0.4 * speed;
    EXPECT_NEAR(tractionRatioAfter(kLuGre, speed, distance, 3), std::min(curve, 1.5), kExact) << speed;
  }
}

TEST(LuGreTwin, FrictionDecreasesWithSpeed) {
  const auto ratio = [](double speed) { return tractionRatioAfter(kLuGre, speed, 1e-3, 10); };
  for (double speed = 1e-5; speed < 1e-3; speed *= 2) EXPECT_GT(ratio(speed), ratio(2 * speed)) << speed;
  EXPECT_GT(ratio(1e-4) - ratio(1e-2), 0.49);
}

// Isotropic and reversible for displacements well below slip.
TEST(LuGreTwin, PreslidingIsElastic) {
  LuGre law = kLuGre;
  law.bristle_damping = law.viscous_friction = 0;
  for (const double angle : {0.0, 0.7, 2.0, -3.0}) {
    const double distance = 1e-9;  // sigma_0 distance / g < 1e-4
    const Shear u{distance * std::cos(angle), distance * std::sin(angle)};
    const Bristles there = updateBristles(law, {0, 0}, u, 1, 1e-3);
    EXPECT_NEAR(there.traction_ratio[0], law.bristle_stiffness * u[0], 1e-4 * law.bristle_stiffness * distance);
    EXPECT_NEAR(there.traction_ratio[1], law.bristle_stiffness * u[1], 1e-4 * law.bristle_stiffness * distance);
    const Bristles back = updateBristles(law, there.deflection, {-u[0], -u[1]}, 1, 1e-3);
    EXPECT_NEAR(sizeOf(back.traction_ratio), 0, 3e-4 * law.bristle_stiffness * distance);
  }
}

// From rest: z = g / sigma_0 (1 - e^(-sigma_0 v t / g)), for any number of steps.
TEST(LuGreTwin, DeflectionAtConstantVelocityIsExponential) {
  for (const double speed : {1e-6, 1e-4, 1e-3, 0.02}) {
    const double g = 1 + 0.5 * std::exp(-speed * speed / 1e-6), tau = g / (kLuGre.bristle_stiffness * speed);
    for (const int num_steps : {1, 3, 40}) {
      for (const double time : {1e-3 * tau, 0.3 * tau, tau, 5 * tau}) {
        Bristles bristles;
        for (int n = 0; n < num_steps; ++n) {
          bristles = updateBristles(kLuGre, bristles.deflection, {0, -speed * time / num_steps}, 1, time / num_steps);
        }
        const double fade = std::exp(-time / tau);
        EXPECT_NEAR(bristles.deflection[1], g / kLuGre.bristle_stiffness * std::expm1(-time / tau), kExact * g / kLuGre.bristle_stiffness);
        const double ratio = g * (1 - fade) + kLuGre.bristle_damping * speed * fade + kLuGre.viscous_friction * speed;
        EXPECT_NEAR(bristles.traction_ratio[1], -std::min(ratio, kLuGre.static_friction), kExact) << speed << " " << num_steps;
      }
    }
  }
}

// Piecewise constant random velocities, against classical Runge-Kutta integration of z' = v - sigma_0 |v| z / g.
TEST(LuGreTwin, MatchesRungeKuttaIntegration) {
  Random random(3);
  for (int path = 0; path < 20; ++path) {
    Shear z{0, 0};
    Bristles bristles;
    for (int step = 0; step < 10; ++step) {
      const double speed = 1e-3 * std::pow(10, random.uniform(-1, 1)), angle = random.uniform(0, 6.3), dt = 2e-5 / speed;
      const Shear v{speed * std::cos(angle), speed * std::sin(angle)};
      const double g = reference::stribeckFriction(kLuGre, speed);
      const auto rate = [&](const Shear& deflection) {
        Shear result;
        for (int axis = 0; axis < 2; ++axis) result[axis] = v[axis] - kLuGre.bristle_stiffness * speed / g * deflection[axis];
        return result;
      };
      constexpr int kPieces = 100;
      const double h = dt / kPieces;
      const auto ahead = [&](const Shear& slope, double time) { return Shear{z[0] + time * slope[0], z[1] + time * slope[1]}; };
      for (int piece = 0; piece < kPieces; ++piece) {
        const Shear a = rate(z), b = rate(ahead(a, h / 2)), c = rate(ahead(b, h / 2)), d = rate(ahead(c, h));
        z = ahead({(a[0] + 2 * b[0] + 2 * c[0] + d[0]) / 6, (a[1] + 2 * b[1] + 2 * c[1] + d[1]) / 6}, h);
      }
      bristles = updateBristles(kLuGre, bristles.deflection, {v[0] * dt, v[1] * dt}, 1, dt);
      // Fourth order: (sigma_0 v h / g)^4 times the deflection scale 1.5e-5 m.
      for (int axis = 0; axis < 2; ++axis) EXPECT_NEAR(bristles.deflection[axis], z[axis], 1e-7 * 1.5e-5);
    }
  }
}

// Without the bound, a velocity jump to 0.1 m/s would give a ratio of (sigma_1 + sigma_2) v = 31.7.
TEST(LuGreTwin, TractionNeverExceedsStaticFriction) {
  const Bristles jump = updateBristles(kLuGre, {0, 0}, {1e-7, 0}, 1, 1e-6);
  EXPECT_NEAR(jump.traction_ratio[0], kLuGre.static_friction, kExact);
  Random random(4);
  const auto around = [&](double value) { return value * std::pow(10, random.uniform(-6, 6)); };
  for (int path = 0; path < 500; ++path) {
    LuGre law{1, around(1e5), around(316), around(0.4), 0, around(1e-3), around(1e-3)};
    law.static_friction = law.coulomb_friction * random.uniform(1, 3);
    Bristles bristles;
    for (int step = 0; step < 8; ++step) {
      const double distance = std::pow(10, random.uniform(-12, 0)), angle = random.uniform(0, 6.3);
      const Shear u{distance * std::cos(angle), distance * std::sin(angle)};
      bristles = updateBristles(law, bristles.deflection, u, random.uniform(), std::pow(10, random.uniform(-9, 3)));
      EXPECT_LE(sizeOf(bristles.traction_ratio), law.static_friction * (1 + kExact));
      EXPECT_LE(law.bristle_stiffness * sizeOf(bristles.deflection), law.static_friction * (1 + kExact));
    }
  }
}

TEST(LuGreTwin, RestKeepsTheDeflectionAndZeroTimeIsInfinitelySlow) {
  const Bristles rest = updateBristles(kLuGre, {3e-6, -4e-6}, {0, 0}, 1, 1e-3);
  EXPECT_EQ(rest.deflection, (Shear{3e-6, -4e-6}));
  EXPECT_NEAR(sizeOf(rest.traction_ratio), 0.5, kExact);
  const Bristles timeless = updateBristles(kLuGre, {0, 0}, {1e-5, 0}, 1, 0), slow = updateBristles(kLuGre, {0, 0}, {1e-5, 0}, 1, 1e6);
  EXPECT_NEAR(timeless.traction_ratio[0], slow.traction_ratio[0], 1e-6);
}

// Whole frames: a flat punch slides steadily; then it lands while it slides, so that the bristles deflect by the part of the path after
// touch.
TEST(LuGreTwin, FlatPunchShearsWithItsFullLoad) {
  Sensor sensor = support::gridSensor();
  sensor.skin.law = kLuGre;
  const Object flat(Box{{3.4e-3, 6.8e-3, 0.01}});
  const double depth = 0.5e-3, normal = 1.73e8 * depth * 3.4e-3 * 6.8e-3, speed = 1e-3, dt = 1e-3;
  reference::FrictionState state;
  reference::Frame frame;
  const auto stepTo = [&](const Vector3& position) {
    frame = reference::simulateFrame(sensor, {.objects = {{&flat, {.position = position}}}, .previous_friction = state, .dt = dt});
    state = frame.shear.state;
  };
  for (int n = 0; n < 200; ++n) stepTo({1.7e-3 + 1e-9 - 0.1e-3 + n * speed * dt, 0, 5e-3 - depth});
  EXPECT_NEAR(frame.wrench[2], -normal, 1e-9 * normal);
  EXPECT_NEAR(frame.wrench[0] / normal, 1.18434, 5e-6);
  state = {};
  stepTo({1.7e-3, 0, 5e-3 + depth});
  stepTo({1.7e-3 + 1e-6, 0, 5e-3 - depth});
  // Half of the path is after touch.
  const double g = 1 + 0.5 * std::exp(-1.0), deflection = g / 1e5 * -std::expm1(-1e5 * 0.5e-6 / g);
  double largest = 0;
  for (const Shear& history : state.history) largest = std::max(largest, history[0]);
  EXPECT_NEAR(largest, deflection, 1e-9 * deflection);
}

}  // namespace
}  // namespace taxelsim
