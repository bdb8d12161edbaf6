// The bristles of LuGre against closed forms, a plain integration of their equations, and the curve that their authors published.
#include "reference/lugre.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "reference/frame.h"
#include "support/random_scene.h"

namespace taxelsim {
namespace {

using reference::Bristles;
using reference::moveBristles;
using reference::Shear;
using support::Random;

// Of a dozen operations in double.
constexpr double kExact = 1e-12;
constexpr LuGre kLuGre{.normal_contact_stiffness = 1.73e8};

double sizeOf(const Shear& v) {
  return std::hypot(v[0], v[1]);
}

// Shear over pressure after `way` m along x at `speed` m/s, in so many steps.
double shareAfter(const LuGre& law, double speed, double way, int num_steps) {
  Bristles bristles;
  for (int n = 0; n < num_steps; ++n) bristles = moveBristles(law, bristles.bend, {way / num_steps, 0}, 1, way / num_steps / speed);
  return bristles.share[0];
}

// The values of the paper's parameters to the digits that its figures were drawn with elsewhere: 1.495 N slow, 1.004 N fast, per newton.
TEST(LuGreTwin, SteadySlidingFollowsTheStribeckCurve) {
  const double way = 50 * kLuGre.static_friction / kLuGre.bristle_stiffness;
  constexpr double kDigits = 5e-6;
  EXPECT_NEAR(shareAfter(kLuGre, 1e-4, way, 7), 1.49506, kDigits);
  EXPECT_NEAR(shareAfter(kLuGre, 1e-3, way, 7), 1.18434, kDigits);
  EXPECT_NEAR(shareAfter(kLuGre, 1e-2, way, 7), 1.00400, kDigits);
  EXPECT_NEAR(shareAfter(kLuGre, 0.1, way, 7), 1.04000, kDigits);
  for (double speed = 1e-7; speed < 10; speed *= 1.3) {
    const double curve = 1 + 0.5 * std::exp(-speed * speed / 1e-6) + 0.4 * speed;
    EXPECT_NEAR(shareAfter(kLuGre, speed, way, 3), std::min(curve, 1.5), kExact) << speed;
  }
}

TEST(LuGreTwin, APathShearsMoreTheSlowerItIs) {
  const auto share = [](double speed) { return shareAfter(kLuGre, speed, 1e-3, 10); };
  for (double speed = 1e-5; speed < 1e-3; speed *= 2) EXPECT_GT(share(speed), share(2 * speed)) << speed;
  EXPECT_GT(share(1e-4) - share(1e-2), 0.49);
}

// Before they slip, bristles are springs: the way is the same whatever the direction, and back.
TEST(LuGreTwin, PreslidingIsASpring) {
  LuGre law = kLuGre;
  law.bristle_damping = law.viscous_friction = 0;
  for (const double angle : {0.0, 0.7, 2.0, -3.0}) {
    const double way = 1e-9;  // sigma_0 way / g: less than 1e-4 of the way to slip
    const Shear u{way * std::cos(angle), way * std::sin(angle)};
    const Bristles there = moveBristles(law, {0, 0}, u, 1, 1e-3);
    EXPECT_NEAR(there.share[0], law.bristle_stiffness * u[0], 1e-4 * law.bristle_stiffness * way);
    EXPECT_NEAR(there.share[1], law.bristle_stiffness * u[1], 1e-4 * law.bristle_stiffness * way);
    const Bristles back = moveBristles(law, there.bend, {-u[0], -u[1]}, 1, 1e-3);
    EXPECT_NEAR(sizeOf(back.share), 0, 3e-4 * law.bristle_stiffness * way);
  }
}

// From rest at one velocity: z = g / sigma_0 (1 - e^(-sigma_0 v t / g)), however the time is cut.
TEST(LuGreTwin, ConstantVelocityIsAnExponential) {
  for (const double speed : {1e-6, 1e-4, 1e-3, 0.02}) {
    const double g = 1 + 0.5 * std::exp(-speed * speed / 1e-6), tau = g / (kLuGre.bristle_stiffness * speed);
    for (const int num_steps : {1, 3, 40}) {
      for (const double time : {1e-3 * tau, 0.3 * tau, tau, 5 * tau}) {
        Bristles bristles;
        for (int n = 0; n < num_steps; ++n) {
          bristles = moveBristles(kLuGre, bristles.bend, {0, -speed * time / num_steps}, 1, time / num_steps);
        }
        const double fade = std::exp(-time / tau);
        EXPECT_NEAR(bristles.bend[1], g / kLuGre.bristle_stiffness * std::expm1(-time / tau), kExact * g / kLuGre.bristle_stiffness);
        const double share = g * (1 - fade) + kLuGre.bristle_damping * speed * fade + kLuGre.viscous_friction * speed;
        EXPECT_NEAR(bristles.share[1], -std::min(share, kLuGre.static_friction), kExact) << speed << " " << num_steps;
      }
    }
  }
}

// Random velocities, each held for a step, beside a Runge-Kutta integration of z' = v - sigma_0 |v| z / g.
TEST(LuGreTwin, FollowsItsDifferentialEquation) {
  Random random(3);
  for (int path = 0; path < 20; ++path) {
    Shear z{0, 0};
    Bristles bristles;
    for (int step = 0; step < 10; ++step) {
      const double speed = 1e-3 * std::pow(10, random.uniform(-1, 1)), angle = random.uniform(0, 6.3), dt = 2e-5 / speed;
      const Shear v{speed * std::cos(angle), speed * std::sin(angle)};
      const double g = reference::stribeckFriction(kLuGre, speed);
      const auto rate = [&](const Shear& at) {
        Shear result;
        for (int axis = 0; axis < 2; ++axis) result[axis] = v[axis] - kLuGre.bristle_stiffness * speed / g * at[axis];
        return result;
      };
      constexpr int kPieces = 100;
      const double h = dt / kPieces;
      const auto ahead = [&](const Shear& slope, double time) { return Shear{z[0] + time * slope[0], z[1] + time * slope[1]}; };
      for (int piece = 0; piece < kPieces; ++piece) {
        const Shear a = rate(z), b = rate(ahead(a, h / 2)), c = rate(ahead(b, h / 2)), d = rate(ahead(c, h));
        z = ahead({(a[0] + 2 * b[0] + 2 * c[0] + d[0]) / 6, (a[1] + 2 * b[1] + 2 * c[1] + d[1]) / 6}, h);
      }
      bristles = moveBristles(kLuGre, bristles.bend, {v[0] * dt, v[1] * dt}, 1, dt);
      // Fourth order: (sigma_0 v h / g)^4 of a length of 1.5e-5 m.
      for (int axis = 0; axis < 2; ++axis) EXPECT_NEAR(bristles.bend[axis], z[axis], 1e-7 * 1.5e-5);
    }
  }
}

// A jump to 0.1 m/s would give (sigma_1 + sigma_2) v = 31.7 per newton; no path gives more than static friction.
TEST(LuGreTwin, NothingOverstepsCoulombsBound) {
  const Bristles jump = moveBristles(kLuGre, {0, 0}, {1e-7, 0}, 1, 1e-6);
  EXPECT_NEAR(jump.share[0], kLuGre.static_friction, kExact);
  Random random(4);
  const auto around = [&](double value) { return value * std::pow(10, random.uniform(-6, 6)); };
  for (int path = 0; path < 500; ++path) {
    LuGre law{1, around(1e5), around(316), around(0.4), 0, around(1e-3), around(1e-3)};
    law.static_friction = law.coulomb_friction * random.uniform(1, 3);
    Bristles bristles;
    for (int step = 0; step < 8; ++step) {
      const double way = std::pow(10, random.uniform(-12, 0)), angle = random.uniform(0, 6.3);
      const Shear u{way * std::cos(angle), way * std::sin(angle)};
      bristles = moveBristles(law, bristles.bend, u, random.uniform(), std::pow(10, random.uniform(-9, 3)));
      EXPECT_LE(sizeOf(bristles.share), law.static_friction * (1 + kExact));
      EXPECT_LE(law.bristle_stiffness * sizeOf(bristles.bend), law.static_friction * (1 + kExact));
    }
  }
}

TEST(LuGreTwin, RestHoldsTheBristlesAndNoTimeIsSlow) {
  const Bristles rest = moveBristles(kLuGre, {3e-6, -4e-6}, {0, 0}, 1, 1e-3);
  EXPECT_EQ(rest.bend, (Shear{3e-6, -4e-6}));
  EXPECT_NEAR(sizeOf(rest.share), 0.5, kExact);
  const Bristles timeless = moveBristles(kLuGre, {0, 0}, {1e-5, 0}, 1, 0), slow = moveBristles(kLuGre, {0, 0}, {1e-5, 0}, 1, 1e6);
  EXPECT_NEAR(timeless.share[0], slow.share[0], 1e-6);
}

// A whole frame: a flat on whole samples that slides, and lands while it slides, so that its bristles bend by the part of the way after
// touch.
TEST(LuGreTwin, AFlatShearsWithItsWholeLoad) {
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
  // Half of the way, at a speed that is the surface's alone.
  const double g = 1 + 0.5 * std::exp(-1.0), bend = g / 1e5 * -std::expm1(-1e5 * 0.5e-6 / g);
  double largest = 0;
  for (const Shear& held : state.held) largest = std::max(largest, held[0]);
  EXPECT_NEAR(largest, bend, 1e-9 * bend);
}

}  // namespace
}  // namespace taxelsim
