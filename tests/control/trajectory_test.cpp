#include "taxelsim/trajectory.h"

#include "base/vector3.h"
#include "control/twist.h"
#include "random_robots.h"
#include "support/test.h"
#include "taxelsim/error.h"

namespace taxelsim {
namespace {

constexpr double kPi = std::numbers::pi;
constexpr double kRounding = 1e-13;  // tens of rounding errors of numbers of order 1
const Pose kStart{{0.1, -0.2, 0.3}, axisAngle({1, 2, -1}, 0.7)};

// Central difference of the pose, in the axes of O at t. The truncation error is h^2 / 6 times the third derivative.
Twist differenceTwist(const Trajectory& trajectory, double t, double h) {
  const Pose before = trajectory.at(t - h), after = trajectory.at(t + h);
  Twist twist;
  twist.v = rotate(inverse(trajectory.at(t)).rotation, scale(1 / (2 * h), subtract(after.position, before.position)));
  const Quaternion rotation = inverse(before).rotation * after.rotation;
  twist.w = scale(std::copysign(1, rotation[0]) / h, {rotation[1], rotation[2], rotation[3]});
  return twist;
}

void expectDerivative(const Trajectory& trajectory, double t, double h, double tolerance) {
  const Twist expected = differenceTwist(trajectory, t, h), twist = trajectory.twistAt(t);
  RC_ASSERT(distance(twist.v, expected.v) <= tolerance);
  RC_ASSERT(distance(twist.w, expected.w) <= tolerance);
}

TEST(Trajectory, ConstantTwistIsAScrewMotionInTheAxesOfW) {
  const Motion motion = ConstantTwist{{{0.1, 0, 0.02}, {0, 0, kPi / 2}}};
  const Trajectory trajectory(motion, kStart);
  EXPECT_LE(distance(trajectory.at(0), kStart), kRounding);
  // After 1 s: a quarter of a circle of radius 0.2 / pi to the left, rotated by 90 degrees about z of W, and 0.02 m up.
  const double radius = 0.2 / kPi;
  const Pose expected{add(kStart.position, {radius, radius, 0.02}), axisAngle({0, 0, 1}, kPi / 2) * kStart.rotation};
  EXPECT_LE(distance(trajectory.at(1), expected), kRounding);
}

TEST(Trajectory, SinusoidStartsAtTheObjectForAnyPhase) {
  const Motion motion = Sinusoid{.axis = {0, 3, 4}, .amplitude = 0.01, .angle = 0.2, .frequency = 2, .phase = kPi / 2};
  const Trajectory trajectory(motion, kStart);
  EXPECT_LE(distance(trajectory.at(0), kStart), kRounding);
  // After half a period, the sine has changed from 1 to -1.
  const Vector3 axis{0, 0.6, 0.8};
  const Pose expected{add(kStart.position, scale(-0.02, axis)), axisAngle(axis, -0.4) * kStart.rotation};
  EXPECT_LE(distance(trajectory.at(0.25), expected), kRounding);
  EXPECT_LE(distance(trajectory.at(0.5), kStart), kRounding);
  EXPECT_LE(length(trajectory.twistAt(0).v), kRounding);  // at the crest
}

RC_GTEST_PROP(TrajectoryProperty, TwistOfAConstantTwistMatchesFiniteDifferences, ()) {
  const Motion motion = ConstantTwist{{drawVector(1), drawVector(2)}};
  const Trajectory trajectory(motion, {drawVector(1), drawRotation()});
  constexpr double kH = 1e-4;
  // Third derivatives are at most w^2 (v + w), w <= 2 sqrt(3): 12 * 5.2 * h^2 / 6 = 1e-7; rounding 1e-15 / h = 1e-11.
  expectDerivative(trajectory, drawBetween(0.1, 3), kH, 2e-7);
}

RC_GTEST_PROP(TrajectoryProperty, TwistOfASinusoidMatchesFiniteDifferences, ()) {
  const Motion motion = Sinusoid{.axis = add(drawVector(1), {0, 0, 2}),
                                 .amplitude = drawBetween(-0.1, 0.1),
                                 .angle = drawBetween(-1, 1),
                                 .frequency = drawBetween(0.1, 2),
                                 .phase = drawBetween(-4, 4)};
  const Trajectory trajectory(motion, {drawVector(1), drawRotation()});
  constexpr double kH = 1e-5;
  // (2 pi f)^3 = 1984, times h^2 / 6 = 3.3e-8; rounding 1e-15 / h = 1e-10.
  expectDerivative(trajectory, drawBetween(0.1, 3), kH, 1e-7);
}

Waypoints drawWaypoints(Waypoints::Interpolation interpolation) {
  Waypoints waypoints{.points = {}, .interpolation = interpolation};
  double time = drawBetween(-5, 5);
  const int count = *rc::gen::inRange(2, 6);
  for (int k = 0; k < count; ++k) {
    waypoints.points.push_back({time, {drawVector(0.5), drawRotation()}});
    time += drawBetween(0.2, 1);
  }
  return waypoints;
}

Pose expectedAtWaypoint(const Waypoints& waypoints, std::size_t k, const Pose& X_WO) {
  const Pose &first = waypoints.points.front().pose, &pose = waypoints.points[k].pose;
  return {add(X_WO.position, subtract(pose.position, first.position)), (pose.rotation * inverse(first).rotation) * X_WO.rotation};
}

RC_GTEST_PROP(TrajectoryProperty, PassesThroughWaypointsContinuously, ()) {
  for (const auto interpolation : {Waypoints::Interpolation::kLinear, Waypoints::Interpolation::kCubic}) {
    const Motion motion = drawWaypoints(interpolation);
    const auto& waypoints = std::get<Waypoints>(motion);
    const Trajectory trajectory(motion, kStart);
    constexpr double kStep = 1e-9;  // s
    // m/s or rad/s: waypoints are at most 1 m and pi rad apart in at least 0.2 s; 3/2 of that for cubics, and overshoot.
    constexpr double kMaxSpeed = 40;
    for (std::size_t k = 0; k < waypoints.points.size(); ++k) {
      const double t = waypoints.points[k].time - waypoints.points.front().time;
      const Pose expected = expectedAtWaypoint(waypoints, k, kStart);
      RC_ASSERT(distance(trajectory.at(t), expected) <= kRounding);
      RC_ASSERT(distance(trajectory.at(t - kStep), expected) <= kMaxSpeed * kStep + kRounding);
      RC_ASSERT(distance(trajectory.at(t + kStep), expected) <= kMaxSpeed * kStep + kRounding);
      if (interpolation == Waypoints::Interpolation::kLinear) continue;
      const auto speed = [&](double when) { return rotate(trajectory.at(when).rotation, trajectory.twistAt(when).v); };
      // Second derivatives are at most 6 p / h^2 + 6 m / h = 6 * 1.8 / 0.04 + 6 * 30 / 0.2 = 1200 m/s^2.
      RC_ASSERT(distance(speed(t - kStep), speed(t + kStep)) <= 2 * 1200 * kStep + 1e-10);
    }
    RC_ASSERT(trajectory.twistAt(waypoints.points.back().time - waypoints.points.front().time + 1) == Twist{});
    RC_ASSERT(distance(trajectory.at(100), expectedAtWaypoint(waypoints, waypoints.points.size() - 1, kStart)) <= kRounding);
  }
}

RC_GTEST_PROP(TrajectoryProperty, TwistBetweenWaypointsMatchesFiniteDifferences, ()) {
  for (const auto interpolation : {Waypoints::Interpolation::kLinear, Waypoints::Interpolation::kCubic}) {
    const Motion motion = drawWaypoints(interpolation);
    const auto& waypoints = std::get<Waypoints>(motion);
    const Trajectory trajectory(motion, {drawVector(1), drawRotation()});
    const std::size_t k = *rc::gen::inRange<std::size_t>(1, waypoints.points.size());
    const double before = waypoints.points[k - 1].time, after = waypoints.points[k].time;
    const double t = before + drawBetween(0.01, 0.99) * (after - before) - waypoints.points.front().time;
    constexpr double kH = 1e-5;
    // Third derivatives: 12 p / h^3 + 6 (m0 + m1) / h^2 = 12 * 1.8 / 0.008 + 12 * 30 / 0.04 = 11700 m/s^3, w^3 = 3900; times h^2 /
    // 6 = 2e-7.
    expectDerivative(trajectory, t, kH, 3e-7);
  }
}

TEST(Trajectory, TwoCubicWaypointsGiveASmoothStep) {
  const Motion motion = Waypoints{.points = {{2, {{1, 1, 1}, {1, 0, 0, 0}}}, {4, {{1, 1, 1.5}, {1, 0, 0, 0}}}}};
  const Trajectory trajectory(motion, Pose{});
  for (const double u : {0.1, 0.25, 0.5, 0.9}) EXPECT_NEAR(trajectory.at(2 * u).position[2], 0.5 * u * u * (3 - 2 * u), kRounding);
  EXPECT_EQ(trajectory.twistAt(0), Twist{});
  EXPECT_NEAR(trajectory.twistAt(1).v[2], 0.5 * 1.5 / 2, kRounding);
}

TEST(Trajectory, CubicReproducesAParabola) {
  Waypoints waypoints;
  for (const double t : {0.0, 0.5, 1.25, 1.5, 2.5, 3.0}) waypoints.points.push_back({t, {{t * t, 0, 0}, {1, 0, 0, 0}}});
  const Motion motion = waypoints;
  const Trajectory trajectory(motion, Pose{});
  // In intervals whose two waypoints both have two neighbors.
  for (const double t : {0.6, 1.0, 1.3, 2.0, 2.4}) EXPECT_NEAR(trajectory.at(t).position[0], t * t, 20 * kRounding) << t;
}

TEST(Trajectory, RotatesByTheSmallerAngleBetweenWaypoints) {
  const Quaternion rotated = axisAngle({0, 0, 1}, 0.5);
  const Motion motion =
      Waypoints{.points = {{0, {{0, 0, 0}, {1, 0, 0, 0}}}, {1, {{0, 0, 0}, {-rotated[0], -rotated[1], -rotated[2], -rotated[3]}}}}};
  const Trajectory trajectory(motion, Pose{});
  EXPECT_LE(distance(trajectory.at(0.5), Pose{{0, 0, 0}, axisAngle({0, 0, 1}, 0.25)}), kRounding);
  EXPECT_NEAR(trajectory.twistAt(0.5).w[2], 0.5, kRounding);
}

TEST(Trajectory, SingleWaypointIsAtRest) {
  const Motion motion = Waypoints{.points = {{3, kStart}}};
  EXPECT_LE(distance(Trajectory(motion, kStart).at(7), kStart), kRounding);
  EXPECT_EQ(Trajectory(motion, kStart).twistAt(7), Twist{});
}

// Root mean square of the displacement about its mean, and the power of its Fourier transform inside and outside of [from, to] Hz.
struct Spectrum {
  double rms = 0, inside = 0, outside = 0;
};
Spectrum spectrumOf(const Trajectory& trajectory, int axis, double from, double to) {
  // Bins of 0.05 Hz up to 20 Hz, Hann window: less than 1e-5 of the power of a line leaks farther than 8 bins = 0.4 Hz.
  constexpr int kSamples = 4000;
  constexpr double kPeriod = 0.005, kLeak = 0.4;
  std::vector<double> x(kSamples);
  double mean = 0;
  for (int i = 0; i < kSamples; ++i) {
    x[i] = trajectory.at(i * kPeriod).position[axis];
    mean += x[i] / kSamples;
  }
  Spectrum spectrum;
  for (double& value : x) value -= mean;
  for (const double value : x) spectrum.rms += value * value / kSamples;
  spectrum.rms = std::sqrt(spectrum.rms);
  for (int bin = 1; bin < 400; ++bin) {
    double re = 0, im = 0;
    for (int i = 0; i < kSamples; ++i) {
      const double window = 0.5 - 0.5 * std::cos(2 * kPi * i / kSamples);
      re += window * x[i] * std::cos(2 * kPi * bin * i / kSamples), im += window * x[i] * std::sin(2 * kPi * bin * i / kSamples);
    }
    const double frequency = bin / (kSamples * kPeriod);
    (frequency > from - kLeak && frequency < to + kLeak ? spectrum.inside : spectrum.outside) += re * re + im * im;
  }
  return spectrum;
}

TEST(Trajectory, TremorHasItsBandAndAmplitude) {
  const Motion motion = HandHeld{.drift = 0, .drift_angle = 0, .tremor = 2e-4, .tremor_angle = 0};
  for (std::uint64_t episode = 0; episode < 5; ++episode) {
    const Spectrum spectrum = spectrumOf(Trajectory(motion, Pose{}, {.seed = 3, .episode = episode}), 1, 8, 12);
    // Two waves in adjacent thirds of the band may have almost equal frequencies. Over 20 s they then add up or cancel: the mean square is
    // between 1/3 and 5/3.
    EXPECT_GT(spectrum.rms, 2e-4 * std::sqrt(1.0 / 3)) << episode;
    EXPECT_LT(spectrum.rms, 2e-4 * std::sqrt(5.0 / 3)) << episode;
    EXPECT_GT(spectrum.inside, 0);
    EXPECT_LT(spectrum.outside, 1e-4 * spectrum.inside) << episode;
  }
}

// The mean square over many episodes, with independent draws and uniform phases, is that of the parameters.
TEST(Trajectory, HandHeldMotionHasItsAmplitudes) {
  const HandHeld hand{.drift = 2e-3, .drift_angle = 0.02, .tremor = 1e-4, .tremor_angle = 1e-3};
  const Motion motion = hand;
  constexpr int kEpisodes = 2000;
  double position = 0, angle = 0;
  for (std::uint64_t episode = 0; episode < kEpisodes; ++episode) {
    const Trajectory trajectory(motion, Pose{}, {.seed = 1, .episode = episode});
    // Positions 1000 s apart are uncorrelated; their difference has twice the mean square.
    const Pose late = trajectory.at(1000);
    for (int i = 0; i < 3; ++i) {
      position += late.position[i] * late.position[i] / (2 * 3 * kEpisodes);
      const double half = late.rotation[i + 1];
      angle += 4 * half * half / (2 * 3 * kEpisodes);
    }
  }
  // Mean of 6000 squares, each with a standard deviation of at most sqrt(2) times the mean: 1.8 % at one sigma.
  constexpr double kSampling = 4 * 0.018;
  EXPECT_NEAR(position, hand.drift * hand.drift + hand.tremor * hand.tremor, kSampling * position);
  EXPECT_NEAR(angle, hand.drift_angle * hand.drift_angle + hand.tremor_angle * hand.tremor_angle, kSampling * angle);
}

RC_GTEST_PROP(TrajectoryProperty, TwistOfHandHeldMotionMatchesFiniteDifferences, ()) {
  const Motion motion = HandHeld{};
  const Trajectory trajectory(motion, {drawVector(1), drawRotation()},
                              {.seed = *rc::gen::inRange<std::uint64_t>(0, 1000), .episode = *rc::gen::inRange<std::uint64_t>(0, 1000)});
  constexpr double kH = 1e-5;
  // Sums of three waves: tremor 3 * 1e-3 * sqrt(2 / 3) (2 pi 12)^3 = 1.1e3 rad/s^3, times h^2 / 6 = 2e-8; rounding 1e-15 / h = 1e-10.
  expectDerivative(trajectory, drawBetween(0.1, 30), kH, 5e-8);
}

TEST(Trajectory, HandHeldMotionIsAFunctionOfSeedEpisodeAndSlot) {
  const Motion motion = HandHeld{};
  const MotionKey key{.seed = 5, .episode = 6, .slot = 1};
  const Trajectory once(motion, kStart, key), again(motion, kStart, key);
  (void)once.at(9);
  EXPECT_LE(distance(once.at(0), kStart), kRounding);
  for (const double t : {3.0, 0.1, 2.0}) {
    EXPECT_EQ(once.at(t), again.at(t));
    EXPECT_EQ(once.twistAt(t), again.twistAt(t));
  }
  for (const MotionKey& other : {MotionKey{6, 6, 1}, MotionKey{5, 7, 1}, MotionKey{5, 6, 2}}) {
    EXPECT_NE(Trajectory(motion, kStart, other).at(1), once.at(1));
  }
}

TEST(Trajectory, RejectsInvalidMotions) {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  const double inf = std::numeric_limits<double>::infinity();
  const std::vector<Motion> bad = {
      ConstantTwist{{{nan, 0, 0}, {0, 0, 0}}},
      ConstantTwist{{{0, 0, 0}, {0, inf, 0}}},
      Sinusoid{.axis = {0, 0, 0}},
      Sinusoid{.axis = {0, nan, 0}},
      Sinusoid{.amplitude = nan},
      Sinusoid{.angle = inf},
      Sinusoid{.frequency = 0},
      Sinusoid{.phase = nan},
      Waypoints{},
      Waypoints{.points = {{1, {}}, {1, {}}}},
      Waypoints{.points = {{nan, {}}}},
      Waypoints{.points = {{0, {{inf, 0, 0}, {1, 0, 0, 0}}}}},
      HandHeld{.drift = -1},
      HandHeld{.tremor_angle = nan},
      HandHeld{.drift_band = {0, 1}},
      HandHeld{.tremor_band = {12, 8}},
  };
  for (std::size_t i = 0; i < bad.size(); ++i) EXPECT_THROW(checkMotion(bad[i]), Error) << i;
  for (const Motion& good : {Motion(ConstantTwist{}), Motion(Sinusoid{}), Motion(Waypoints{.points = {{0, {}}}}), Motion(HandHeld{})}) {
    EXPECT_NO_THROW(checkMotion(good));
  }
}

}  // namespace
}  // namespace taxelsim
