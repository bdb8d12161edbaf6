// Closed forms of friction under rolling bodies and on an elastic layer.
#include "base/vector3.h"
#include "support/friction_case_tools.h"
#include "support/friction_cases.h"
#include "support/test.h"

namespace taxelsim::support {
namespace {

// A body of radius R and depth `depth` that rolls along +x with creepage xi: its lowest point moves forward by xi of the way.
struct Rolling {
  double R, depth, creepage;
  Quaternion R_SO;  // at the start

  // At least as far as the contact is long, so that every spring has been touched on the way; then over three samples.
  Path path(double from, double to, double step) const {
    Path poses;
    for (double x = from; x < to; x += step) {
      poses.push_back({{x, 0.03e-3, R - depth}, axisAngle({0, 1, 0}, (x - from) * (1 - creepage) / R) * R_SO});
    }
    return poses;
  }
};

constexpr double kRollingTangential = 0.3;  // k_t / k
constexpr double kRollingMu = 1;
constexpr double kRollingRadius = 0.06, kRollingDepth = 0.15e-3;  // m: a = 4.24 mm

// lambda = k_t xi a / (2 mu k depth).
double creepageFor(double lambda, double a) {
  return lambda * 2 * kRollingMu * kRollingDepth / (kRollingTangential * a);
}

// Mean of Q / (mu P) over the last steps.
double steadyShear(const FrictionCases& cases, const Object& object, const Quaternion& R_SO, double lambda) {
  const double a = std::sqrt(2 * kRollingRadius * kRollingDepth), step = 0.25e-3;
  const Sensor sensor = sensorWithStep(step, 22e-3, kRollingTangential * kStiffness, kRollingMu);
  const Rolling rolling{kRollingRadius, kRollingDepth, creepageFor(lambda, a), R_SO};
  // Steps that are no multiple of the samples' spacing meet it at all phases.
  const std::vector<Push> pushes = simulateOne(cases, sensor, object, rolling.path(-5.6e-3, -5.6e-3 + 2.3 * a, 0.11 * step));
  constexpr std::size_t kMean = 27;  // three samples
  double sum = 0;
  for (std::size_t n = pushes.size() - kMean; n < pushes.size(); ++n) sum += pushes[n].wrench[0] / (kRollingMu * pushes[n].normal) / kMean;
  return sum;
}

// The surface of a round body runs away from its lowest point, by x^2 / 2R^2 of the way: a^2 / 6R^2 on average, 0.0008, against creepages
// of 0.07 and more; 17 samples per half-width.
constexpr double kRollingError = 0.02;

}  // namespace

// Springs are touched at the leading edge and have moved by xi (a - x) at x; they stick while k_t xi (a - x) <= mu p, down to a + x = 2 a
// lambda. Q / (mu P) = 1 - (1 - lambda)^3 (F. W. Carter's problem, Proc. R. Soc. A 112, 1926, on springs).
void FrictionCases::rollingCylinder() const {
  for (const double lambda : {0.3, 0.7}) {
    const double expected = 1 - std::pow(1 - lambda, 3);
    EXPECT_NEAR(steadyShear(*this, Object(Cylinder{kRollingRadius, 5e-3}), axisAngle({1, 0, 0}, kPi / 2), lambda) / expected, 1,
                kRollingError + rounding)
        << lambda;
  }
}

// The same strip by strip: half-width a y, pressure at its middle y^2 of the greatest, so that lambda / y of it slips; all where y <
// lambda. Q / (mu P) = int y^3 (1 - (1 - min(lambda / y, 1))^3) dt / int y^3 dt over the strips t = sqrt(1 - y^2).
void FrictionCases::rollingSphere() const {
  for (const double lambda : {0.3, 0.7}) {
    double slipping = 0, all = 0;
    constexpr int kStrips = 20000;
    for (int n = 0; n < kStrips; ++n) {
      const double t = (n + 0.5) / kStrips, y = std::sqrt(1 - t * t);
      slipping += y * y * y * (1 - std::pow(1 - std::min(lambda / y, 1.0), 3));
      all += y * y * y;
    }
    EXPECT_NEAR(steadyShear(*this, Object(Sphere{kRollingRadius}), {1, 0, 0, 0}, lambda) / (slipping / all), 1, kRollingError + rounding)
        << lambda;
  }
}

// A flat punch on an elastic layer, whose pressures are far from even: every node under it sticks until it slips, whatever the others do.
// Sticking, a slide s carries k_t s A and a turn th carries k_t th int r^2 dA over the nodes, at the depth of the punch; slipping all over,
// mu times the normal force.
void FrictionCases::elasticLayerSticksAndSlips() const {
  constexpr double kRadius = 3e-3, kDepth = 0.2e-3, kSpacing = 0.5e-3;
  const Vector3 place{0.11e-3, -0.07e-3, 5e-3 - kDepth};
  Sensor sensor = sensorWithStep(kSpacing, 8e-3, 0, 0);
  sensor.skin.law = ElasticLayer{.elastic_modulus = 1e6, .poisson_ratio = 0.49, .iterations = 100, .tolerance = 1e-4};
  double num_nodes = 0, inertia = 0;  // about the punch's axis, m^4
  const int side = 4 * sensor.patches[0].num_rows;
  for (int u = 0; u < side; ++u) {
    for (int v = 0; v < side; ++v) {
      const double r = std::hypot((u - (side - 1) / 2.0) * kSpacing - place[0], (v - (side - 1) / 2.0) * kSpacing - place[1]);
      if (r > kRadius) continue;
      num_nodes += 1;
      inertia += r * r * kSpacing * kSpacing;
    }
  }
  const double area = num_nodes * kSpacing * kSpacing;
  const auto slidBy = [&](double s) { return Pose{add(place, {s, 0, 0}), {1, 0, 0, 0}}; };
  const Object punch(Cylinder{kRadius, 10e-3});
  for (const double stiffness : {1e6, 1e12}) {
    constexpr double kSlide = 1e-6, kTurn = 1e-4;
    sensor.skin.friction = {stiffness, 1000};
    const auto pushes = simulate(sensor, punch, {{slidBy(0), slidBy(kSlide)}, {slidBy(0), turned(place, kTurn)}});
    const auto& wrench = pushes[0][1].wrench;
    EXPECT_EQ(pushes[0][0].wrench[0], 0);
    EXPECT_NEAR(wrench[0] / (stiffness * kSlide * area), 1, 1e-5);
    EXPECT_NEAR(torqueAbout(pushes[1][1], place[0], place[1]) / (stiffness * kTurn * inertia), 1, 1e-4);
    // At the depth of the punch. With soft springs this torque would be far below that of the pressures.
    if (stiffness > 1e9) {
      EXPECT_NEAR((wrench[4] - pushes[0][0].wrench[4]) / (-kDepth * wrench[0]), 1, 1e-3 + rounding);
    }
  }
  sensor.skin.friction = {1e13, kMu};
  const std::vector<Push> slips = simulateOne(*this, sensor, punch, {slidBy(0), slidBy(1e-9), slidBy(1e-8), slidBy(1e-6), slidBy(1e-5)});
  for (std::size_t n = 1; n < slips.size(); ++n) {
    const double full = kMu * slips[n].normal;
    EXPECT_LE(slips[n].wrench[0], full * (1 + 1e-5));
    EXPECT_GE(slips[n].wrench[0], slips[n - 1].wrench[0] * (1 - 1e-5));
    if (n > 2) {
      EXPECT_NEAR(slips[n].wrench[0] / full, 1, 1e-5);
    }
  }
  EXPECT_LT(slips[1].wrench[0], 0.2 * kMu * slips[1].normal);
}

}  // namespace taxelsim::support
