#include "support/friction_cases.h"

#include "support/friction_case_tools.h"
#include "support/random_scene.h"
#include "support/test.h"

namespace taxelsim::support {
namespace {

// An indenter that slides along x, and the share P(delta) / P(depth) as a function of delta / depth, which follows from its shape.
struct Indenter {
  Object object;
  Quaternion R_SO;
  double height;  // of its origin over its lowest point, m
  double depth;   // m
  double normal;  // N, at that depth
  std::function<double(double)> share;

  double firstSlip() const { return kMu * depth / kStiff; }  // s1: everything slips, m
  double shear(double s) const { return kMu * normal * (1 - share(std::max(0.0, 1 - s / firstSlip()))); }
  Vector3 at(double s) const { return {0.11e-3 + s, -0.1e-3, height - depth}; }
};

Indenter flat() {
  const double side_x = 24 * 0.125e-3, side_y = 40 * 0.125e-3, depth = 0.4e-3;
  return {Object(Box{{side_x, side_y, 0.01}}),   {1, 0, 0, 0}, 0.005, depth, kStiffness * side_x * side_y * depth,
          [](double m) { return m > 0 ? m : 0; }};
}

// Exact sphere and cylinder, not their parabolas.
Indenter sphere() {
  const double R = 0.03, depth = 0.3e-3;
  const auto force = [=](double d) { return kPi * kStiffness * d * d * (R - d / 3); };
  return {Object(Sphere{R}), {1, 0, 0, 0}, R, depth, force(depth), [=](double m) { return force(m * depth) / force(depth); }};
}

Indenter cylinder() {
  const double R = 0.03, depth = 0.3e-3, length = 40 * 0.125e-3;
  const auto force = [=](double d) {
    return kStiffness * length * (R * R * std::acos((R - d) / R) - (R - d) * std::sqrt(2 * R * d - d * d));
  };
  return {Object(Cylinder{R, length}), axisAngle({1, 0, 0}, kPi / 2), R, depth, force(depth), [=](double m) {
            return force(m * depth) / force(depth);
          }};
}

Sensor slidingSensor() {
  return sensorWithStep(0.125e-3, 12e-3, kStiff * kStiffness, kMu);
}

// Q(s) on first loading, along the motion only.
void expectPartialSlip(const FrictionCases& cases, const Indenter& indenter, double grid_error) {
  std::vector<Vector3> positions;
  std::vector<double> slid;
  for (int n = 0; n <= 15; ++n) {
    slid.push_back(indenter.firstSlip() * n / 10);
    positions.push_back(indenter.at(slid.back()));
  }
  const std::vector<Push> pushes = simulateOne(cases, slidingSensor(), indenter.object, pathOf(positions, indenter.R_SO));
  const double full = kMu * indenter.normal, slack = (grid_error + cases.rounding) * full;
  for (std::size_t n = 0; n < pushes.size(); ++n) {
    EXPECT_NEAR(pushes[n].wrench[0], indenter.shear(slid[n]), slack) << "after " << slid[n] << " m";
    EXPECT_NEAR(pushes[n].wrench[1], 0, slack);
  }
}

// Energy (J) dissipated in the second of two cycles of amplitude S, by the trapezoid rule.
double lossPerCycle(const FrictionCases& cases, const Indenter& indenter, double amplitude) {
  constexpr int kSteps = 64;  // from one end to the other
  std::vector<Vector3> positions;
  std::vector<double> slid;
  for (int n = 0; n <= 4 * kSteps; ++n) {
    const int within = n % (2 * kSteps);
    slid.push_back(amplitude * (within <= kSteps ? 1 - 2.0 * within / kSteps : 2.0 * within / kSteps - 3));
    positions.push_back(indenter.at(slid.back()));
  }
  const std::vector<Push> pushes = simulateOne(cases, slidingSensor(), indenter.object, pathOf(positions, indenter.R_SO));
  double loss = 0;
  for (std::size_t n = 2 * kSteps + 1; n < pushes.size(); ++n) {
    loss += 0.5 * (pushes[n].wrench[0] + pushes[n - 1].wrench[0]) * (slid[n] - slid[n - 1]);
  }
  return loss;
}

// Grid errors of a force on at least 24 samples per radius: 0.15 % of a sphere's at 8, falling with the square; and the contact moves by
// mu / k_t k depth = 0.02 depth while it slips: of a profile of slope up to a / R = 0.14, pressures change by 0.3 %, with opposite signs
// on both sides; what stays is the square of the lag over the contact's radius.
constexpr double kSlidingGrid = 0.005;

}  // namespace

namespace {

// Errors of a disc's torque on a square grid of samples at any place, by counting the samples of 3,000 discs: rms against the true radius
// in stick (a^4; in slip less), largest against the radius of as large an area as the samples have.
struct DiscGrid {
  int samples_per_radius;
  double rms_of_radius;
  double worst_of_area;
};
constexpr DiscGrid kDiscGrids[] = {{4, 0.050, 0.0101}, {8, 0.0202, 0.0020}};
// For forty positions the standard deviation of the rms is a tenth; twice that is allowed.
constexpr double kScatter = 1.2;

}  // namespace

// A disc under uniform pressure, turned by th: springs stick to the radius at which k_t th r = mu p; th1 = mu p / (k_t a).
// T = 2 pi int min(k_t th r, mu p) r^2 dr = pi/2 k_t th a^4 up to th1, then 2/3 mu N a [1 - (th1/th)^3 / 4].
void FrictionCases::discTwist() const {
  const double a = 4e-3, depth = 0.3e-3, pressure = kStiffness * depth, k_t = 100 * kStiffness;
  const double first_slip = kMu * pressure / (k_t * a);
  const auto torque = [&](double radius, double angle) {
    const double slips_at = kMu * pressure / (k_t * radius);
    return angle <= slips_at ? kPi / 2 * k_t * angle * std::pow(radius, 4)
                             : 2.0 / 3 * kMu * pressure * kPi * std::pow(radius, 3) * (1 - std::pow(slips_at / angle, 3) / 4);
  };
  for (const DiscGrid& grid : kDiscGrids) {
    const Sensor sensor = sensorWithStep(a / grid.samples_per_radius, 12e-3, k_t, kMu);
    const std::vector<double> angles{0, 0.5, 0.9, 1.5, 2, 3, 4};  // of th1
    std::vector<double> squares(angles.size(), 0);
    constexpr int kPlaces = 40;
    Random random(3);
    std::vector<Path> paths;
    for (int place = 0; place < kPlaces; ++place) {
      const double x = random.uniform(-0.5, 0.5) * sensor.patches[0].pitch[0], y = random.uniform(-0.5, 0.5) * sensor.patches[0].pitch[1];
      Path path;
      for (const double angle : angles) path.push_back(turned({x, y, 5e-3 - depth}, angle * first_slip));
      paths.push_back(path);
    }
    const std::vector<std::vector<Push>> places = simulate(sensor, Object(Cylinder{a, 10e-3}), paths);
    for (int place = 0; place < kPlaces; ++place) {
      const std::vector<Push>& pushes = places[static_cast<std::size_t>(place)];
      const auto [x, y, z] = paths[static_cast<std::size_t>(place)][0].position;
      EXPECT_EQ(pushes[0].wrench[5], 0);
      for (std::size_t n = 1; n < angles.size(); ++n) {
        const double found = torqueAbout(pushes[n], x, y), as_sampled = std::sqrt(pushes[n].normal / (kPi * pressure));
        squares[n] += std::pow(found / torque(a, angles[n] * first_slip) - 1, 2) / kPlaces;
        EXPECT_NEAR(found / torque(as_sampled, angles[n] * first_slip), 1, grid.worst_of_area + 4 * rounding) << angles[n] << " th1";
      }
    }
    for (std::size_t n = 1; n < angles.size(); ++n) {
      EXPECT_LE(std::sqrt(squares[n]), kScatter * grid.rms_of_radius + 4 * rounding) << angles[n] << " th1";
    }
  }
}

// On a sphere pressure is k (a^2 - r^2) / 2R: springs stick where k_t th r <= mu p, to the radius c = -B + sqrt(B^2 + a^2), B = R k_t th /
// (mu k). T = pi/2 k_t th c^4 + pi mu k / R [a^2 (a^3 - c^3) / 3 - (a^5 - c^5) / 5], in the end 8/15 mu N a.
void FrictionCases::sphereTwist() const {
  const double R = 0.03, depth = 0.2e-3, a = std::sqrt(2 * R * depth), k_t = 100 * kStiffness;
  const Sensor sensor = sensorWithStep(a / 16, 10e-3, k_t, kMu);
  // The sphere is deeper than its parabola by r^4 / 8R^3, a^2 / 4R^2 of the depth at the rim; 16 samples per radius.
  const double tolerance = a * a / (4 * R * R) + 0.005 + rounding;
  const std::vector<double> angles{0, 1e-4, 3e-4, 1e-3, 3e-3, 1e-2, 3e-2};
  Path path;
  for (const double angle : angles) path.push_back(turned({0.1e-3, 0.05e-3, R - depth}, angle));
  const std::vector<Push> pushes = simulateOne(*this, sensor, Object(Sphere{R}), path);
  for (std::size_t n = 1; n < angles.size(); ++n) {
    const double B = R * k_t * angles[n] / (kMu * kStiffness), c = -B + std::sqrt(B * B + a * a);
    const double expected =
        kPi / 2 * k_t * angles[n] * std::pow(c, 4) +
        kPi * kMu * kStiffness / R * (a * a * (std::pow(a, 3) - std::pow(c, 3)) / 3 - (std::pow(a, 5) - std::pow(c, 5)) / 5);
    EXPECT_NEAR(torqueAbout(pushes[n], 0.1e-3, 0.05e-3) / expected, 1, tolerance) << angles[n] << " rad";
  }
  EXPECT_NEAR(torqueAbout(pushes.back(), 0.1e-3, 0.05e-3) / (8.0 / 15 * kMu * pushes.back().normal * a), 1, 2 * tolerance);
}

void FrictionCases::partialSlipOfAFlat() const {
  expectPartialSlip(*this, flat(), 0);  // on whole samples, at every displacement
}
void FrictionCases::partialSlipOfASphere() const {
  expectPartialSlip(*this, sphere(), kSlidingGrid);
}
void FrictionCases::partialSlipOfACylinder() const {
  expectPartialSlip(*this, cylinder(), kSlidingGrid);
}

// From Q = Q(S) - 2 Q((S - s) / 2) on the way back: 4/3 m^3 mu P s1 for a paraboloid up to m = S / s1 = 1, 4 mu P (S - s1) for a flat.
void FrictionCases::loopAreas() const {
  for (const double m : {0.5, 1.0}) {
    const Indenter indenter = sphere();
    const double expected = 4.0 / 3 * m * m * m * kMu * indenter.normal * indenter.firstSlip();
    // The trapezoid rule misses 1 / 64^2 of a smooth loop's ends; the area is a difference of curves that each have the grid's error.
    EXPECT_NEAR(lossPerCycle(*this, indenter, m * indenter.firstSlip()) / expected, 1, (3 * kSlidingGrid + 2 * rounding) / m) << m;
  }
  for (const double m : {1.5, 4.0}) {
    const Indenter indenter = flat();
    const double expected = 4 * kMu * indenter.normal * (m - 1) * indenter.firstSlip();
    // The corner where everything slips lies within a step of 2 m s1 / 64: at most half of it by half a step of force.
    const double corner = std::pow(2 * m / 64, 2) / (4 * (m - 1));
    EXPECT_NEAR(lossPerCycle(*this, indenter, m * indenter.firstSlip()) / expected, 1, corner + 2 * rounding * m / (m - 1)) << m;
  }
  const Indenter indenter = flat();
  EXPECT_NEAR(lossPerCycle(*this, indenter, 0.9 * indenter.firstSlip()) / (kMu * indenter.normal * indenter.firstSlip()), 0, 2 * rounding);
}

// Pressed along a slanted line from before touch every spring has moved by d tan(psi) since it was touched: Q = min(mu, k_t / k tan(psi))
// P. That holds within every step only if the part of the step before touch does not count.
void FrictionCases::slantedPress() const {
  for (const Indenter& indenter : {flat(), sphere(), cylinder()}) {
    for (const double slope : {0.004, 0.012, 0.05, -0.012}) {
      std::vector<Vector3> positions;
      for (const double depth : {-0.05e-3, 0.07e-3, 0.15e-3, 0.3e-3}) {
        positions.push_back({0.11e-3 + depth * slope, -0.1e-3, indenter.height - depth});
      }
      const std::vector<Push> pushes = simulateOne(*this, slidingSensor(), indenter.object, pathOf(positions, indenter.R_SO));
      const double ratio = std::clamp(kStiff * slope, -kMu, kMu);
      for (std::size_t n = 1; n < pushes.size(); ++n) {
        EXPECT_NEAR(pushes[n].wrench[0] / pushes[n].normal, ratio, (kSlidingGrid + rounding) * std::abs(ratio));
      }
      EXPECT_EQ(pushes[0].wrench[0], 0);
    }
  }
}

// A flat punch that slides, rests, slides on and returns: Q = clamp(Q + k_t A ds, -mu P, mu P) at every step of any size.
void FrictionCases::slideStopSlideBack() const {
  const Indenter indenter = flat();
  const double s1 = indenter.firstSlip();
  double q = 0, s = 0;
  std::vector<double> expected{0};
  std::vector<Vector3> positions{indenter.at(0)};
  for (const double step : {0.4, 0.4, 0.0, 0.0, 0.7, 0.1, -0.3, 0.0, -1.2, -5.0, 0.0, 1.1}) {
    s += step * s1;
    q = std::clamp(q + step, -1.0, 1.0);
    positions.push_back(indenter.at(s));
    expected.push_back(q);
  }
  const std::vector<Push> pushes = simulateOne(*this, slidingSensor(), indenter.object, pathOf(positions));
  for (std::size_t n = 0; n < pushes.size(); ++n) {
    EXPECT_NEAR(pushes[n].wrench[0] / (kMu * indenter.normal), expected[n], 4 * rounding) << "step " << n;
  }
}

// A slipping spring whose motion changes direction rotates towards the motion: tan(th/2) = tan(th0/2) e^{-s/L}, L = mu p / k_t, th the
// angle between traction and motion (flow rule q' = k_t (ds - n (n . ds)) on |q| = mu p).
void FrictionCases::slipTurnsTowardsTheMotion() const {
  const Indenter indenter = flat();
  const double L = indenter.firstSlip();  // mu k depth / k_t
  constexpr int kStepsPerLength = 50;
  std::vector<Vector3> positions{indenter.at(0), indenter.at(2 * L)};
  for (int n = 1; n <= 3 * kStepsPerLength; ++n) {
    const Vector3 start = indenter.at(2 * L);
    positions.push_back({start[0], start[1] + n * L / kStepsPerLength, start[2]});
  }
  const std::vector<Push> pushes = simulateOne(*this, slidingSensor(), indenter.object, pathOf(positions));
  for (int n = kStepsPerLength; n <= 3 * kStepsPerLength; n += kStepsPerLength) {
    const Push& push = pushes[static_cast<std::size_t>(1 + n)];
    const double angle = std::atan2(push.wrench[0], push.wrench[1]);
    const double expected = 2 * std::atan(std::tan(kPi / 4) * std::exp(-static_cast<double>(n) / kStepsPerLength));
    // Radial return is backward Euler of first order: an error of 4 % of the angle at ten steps per length L.
    EXPECT_NEAR(angle / expected, 1, 0.04 * 10 / kStepsPerLength * n / kStepsPerLength + 4 * rounding);
    EXPECT_NEAR(std::hypot(push.wrench[0], push.wrench[1]) / (kMu * indenter.normal), 1, 4 * rounding);
  }
}

}  // namespace taxelsim::support
