#include "taxelsim/trajectory.h"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <numbers>

#include "base/philox.h"
#include "base/quaternion.h"
#include "base/vector3.h"
#include "control/twist.h"

namespace taxelsim {
namespace {

constexpr double kTwoPi = 2 * std::numbers::pi;

// Logarithm of the rotation from `from` to `to`, by the smaller angle: axis times angle (rad), in the axes of either.
Vector3 rotationVector(const Quaternion& from, const Quaternion& to) {
  Quaternion rotation = conjugate(from) * to;
  if (rotation[0] < 0) rotation = {-rotation[0], -rotation[1], -rotation[2], -rotation[3]};
  const Vector3 imaginary{rotation[1], rotation[2], rotation[3]};
  const double sine = length(imaginary);
  if (sine == 0) return {0, 0, 0};
  return scale(2 * std::atan2(sine, rotation[0]) / sine, imaginary);
}

// A position between two waypoints.
struct Interval {
  std::size_t start;  // index of the waypoint at its start
  double fraction;    // 0 to 1
};

bool isAtRest(const Waypoints& waypoints, double t) {
  return waypoints.points.size() < 2 || t < 0 || t >= waypoints.points.back().time - waypoints.points.front().time;
}

// The interval at `t` (s after the first waypoint); not at rest at t.
Interval intervalAt(const Waypoints& waypoints, double t) {
  const double time = waypoints.points.front().time + t;
  const auto later = [](double value, const Waypoint& point) { return value < point.time; };
  const auto after = std::upper_bound(waypoints.points.begin() + 1, waypoints.points.end() - 1, time, later);
  const auto start = static_cast<std::size_t>(after - waypoints.points.begin()) - 1;
  return {start, (time - waypoints.points[start].time) / (waypoints.points[start + 1].time - waypoints.points[start].time)};
}

Vector3 slopeBefore(const Waypoints& waypoints, std::size_t k) {
  return scale(1 / (waypoints.points[k].time - waypoints.points[k - 1].time),
               subtract(waypoints.points[k].pose.position, waypoints.points[k - 1].pose.position));
}

// Velocity (m/s) of the cubic at a waypoint: that of the parabola through it and its neighbors; 0 at both ends.
Vector3 slopeAt(const Waypoints& waypoints, std::size_t k) {
  if (k == 0 || k + 1 == waypoints.points.size()) return {0, 0, 0};
  const double before = waypoints.points[k].time - waypoints.points[k - 1].time;
  const double after = waypoints.points[k + 1].time - waypoints.points[k].time;
  return scale(1 / (before + after), add(scale(after, slopeBefore(waypoints, k)), scale(before, slopeBefore(waypoints, k + 1))));
}

// Cubic Hermite basis at u: coefficients of p0, p1, m0 h, m1 h.
std::array<double, 4> hermite(double u) {
  const double u2 = u * u, u3 = u2 * u;
  return {2 * u3 - 3 * u2 + 1, 3 * u2 - 2 * u3, u3 - 2 * u2 + u, u3 - u2};
}
std::array<double, 4> hermiteSlope(double u) {
  const double u2 = u * u;
  return {6 * u2 - 6 * u, 6 * u - 6 * u2, 3 * u2 - 4 * u + 1, 3 * u2 - 2 * u};
}

Vector3 combine(const Waypoints& waypoints, std::size_t k, const std::array<double, 4>& c) {
  const double h = waypoints.points[k + 1].time - waypoints.points[k].time;
  // Relative to the first waypoint, to avoid cancellation for waypoints far from the origin of their frame.
  const Vector3& origin = waypoints.points.front().pose.position;
  Vector3 sum = add(scale(c[0], subtract(waypoints.points[k].pose.position, origin)),
                    scale(c[1], subtract(waypoints.points[k + 1].pose.position, origin)));
  if (waypoints.interpolation == Waypoints::Interpolation::kLinear) return sum;
  sum = add(sum, scale(c[2] * h, slopeAt(waypoints, k)));
  return add(sum, scale(c[3] * h, slopeAt(waypoints, k + 1)));
}

Pose displacement(const Waypoints& waypoints, double t) {
  const Waypoint& first = waypoints.points.front();
  const auto relative = [&](const Vector3& p, const Quaternion& R) { return Pose{p, R * conjugate(first.pose.rotation)}; };
  if (isAtRest(waypoints, t)) {
    if (t <= 0) return {};
    return relative(subtract(waypoints.points.back().pose.position, first.pose.position), waypoints.points.back().pose.rotation);
  }
  const auto [k, u] = intervalAt(waypoints, t);
  const bool is_linear = waypoints.interpolation == Waypoints::Interpolation::kLinear;
  const Vector3 position = combine(waypoints, k, is_linear ? std::array{1 - u, u, 0.0, 0.0} : hermite(u));
  const Vector3 rotation = rotationVector(waypoints.points[k].pose.rotation, waypoints.points[k + 1].pose.rotation);
  return relative(position, waypoints.points[k].pose.rotation * exponential({{0, 0, 0}, rotation}, u).rotation);
}

// Twist of M, in M.
Twist velocity(const Waypoints& waypoints, double t) {
  if (isAtRest(waypoints, t)) return {};
  const auto [k, u] = intervalAt(waypoints, t);
  const double h = waypoints.points[k + 1].time - waypoints.points[k].time;
  const bool is_linear = waypoints.interpolation == Waypoints::Interpolation::kLinear;
  const Vector3 v_W = scale(1 / h, combine(waypoints, k, is_linear ? std::array{-1.0, 1.0, 0.0, 0.0} : hermiteSlope(u)));
  const Vector3 rotation = rotationVector(waypoints.points[k].pose.rotation, waypoints.points[k + 1].pose.rotation);
  // `rotation` is in the axes of a frame whose rotation relative to M is that of the first waypoint.
  return {rotate(conjugate(displacement(waypoints, t).rotation), v_W),
          scale(1 / h, rotate(waypoints.points.front().pose.rotation, rotation))};
}

double sinusoidAt(const Sinusoid& s, double t) {
  return std::sin(kTwoPi * s.frequency * t + s.phase) - std::sin(s.phase);
}

}  // namespace

Trajectory::Trajectory(const Motion& motion, const Pose& X_WO, const MotionKey& key)
    : motion_(&motion), X_WM0_{X_WO.position, {1, 0, 0, 0}}, X_MO_{{0, 0, 0}, X_WO.rotation} {
  if (const auto* hand = std::get_if<HandHeld>(&motion)) drawWaves(*hand, key);
}

// Stratified frequencies: wave k of n lies in the k-th of n equal parts of its band. No two frequencies coincide, so the mean
// squares add up.
void Trajectory::drawWaves(const HandHeld& hand, const MotionKey& key) {
  constexpr int kPerBand = kNumWaves / 2;
  DrawKey draw{.seed = key.seed, .episode = key.episode, .frame = 0, .taxel = key.slot, .purpose = Purpose::kMotion};
  const auto uniform = [&] {
    const double number = uniformNumber(draw);
    ++draw.frame;
    return number;
  };
  for (int axis = 0; axis < kNumAxes; ++axis) {
    const bool is_angle = axis >= kNumAxes / 2;
    for (int wave = 0; wave < kNumWaves; ++wave) {
      const bool is_tremor = wave >= kPerBand;
      const std::array<double, 2>& band = is_tremor ? hand.tremor_band : hand.drift_band;
      const double rms = is_tremor ? (is_angle ? hand.tremor_angle : hand.tremor) : (is_angle ? hand.drift_angle : hand.drift);
      const double fraction = (wave % kPerBand + uniform()) / kPerBand;
      const double phase = kTwoPi * uniform();
      waves_[axis][wave] = {rms * std::sqrt(2.0 / kPerBand), kTwoPi * (band[0] + fraction * (band[1] - band[0])), phase};
    }
  }
  start_ = waveSums(0);
}

std::array<double, Trajectory::kNumAxes> Trajectory::waveSums(double t) const {
  std::array<double, kNumAxes> sums{};
  for (int axis = 0; axis < kNumAxes; ++axis) {
    for (const Wave& wave : waves_[axis]) sums[axis] += wave.amplitude * std::sin(wave.frequency * t + wave.phase);
  }
  return sums;
}

std::array<double, Trajectory::kNumAxes> Trajectory::waveSlopes(double t) const {
  std::array<double, kNumAxes> sums{};
  for (int axis = 0; axis < kNumAxes; ++axis) {
    for (const Wave& wave : waves_[axis]) sums[axis] += wave.amplitude * wave.frequency * std::cos(wave.frequency * t + wave.phase);
  }
  return sums;
}

// X_M0M.
Pose Trajectory::displacementAt(double t) const {
  if (const auto* constant = std::get_if<ConstantTwist>(motion_)) return exponential(constant->twist, t);
  if (const auto* wave = std::get_if<Sinusoid>(motion_)) {
    const double s = sinusoidAt(*wave, t);
    return {scale(wave->amplitude * s, unit(wave->axis)), axisAngle(wave->axis, wave->angle * s)};
  }
  if (const auto* waypoints = std::get_if<Waypoints>(motion_)) return displacement(*waypoints, t);
  const std::array<double, kNumAxes> sums = waveSums(t);
  const Vector3 rotation_vector{sums[3] - start_[3], sums[4] - start_[4], sums[5] - start_[5]};
  return {{sums[0] - start_[0], sums[1] - start_[1], sums[2] - start_[2]}, exponential({{0, 0, 0}, rotation_vector}, 1).rotation};
}

Pose Trajectory::at(double t) const {
  return X_WM0_ * (displacementAt(t) * X_MO_);
}

Twist Trajectory::twistAt(double t) const {
  Twist twist_M;
  if (const auto* constant = std::get_if<ConstantTwist>(motion_)) {
    twist_M = constant->twist;
  } else if (const auto* wave = std::get_if<Sinusoid>(motion_)) {
    const double rate = kTwoPi * wave->frequency * std::cos(kTwoPi * wave->frequency * t + wave->phase);
    twist_M = {scale(wave->amplitude * rate, unit(wave->axis)), scale(wave->angle * rate, unit(wave->axis))};
  } else if (const auto* waypoints = std::get_if<Waypoints>(motion_)) {
    twist_M = velocity(*waypoints, t);
  } else {
    const std::array<double, kNumAxes> sums = waveSums(t), slopes = waveSlopes(t);
    const Vector3 rotation_vector{sums[3] - start_[3], sums[4] - start_[4], sums[5] - start_[5]};
    // The position part of exponential() is the left Jacobian of SO(3) times v, here the angular velocity for the rate v of
    // the rotation vector.
    const Pose rotation = exponential({{slopes[3], slopes[4], slopes[5]}, rotation_vector}, 1);
    const Quaternion R_MM0 = conjugate(rotation.rotation);
    twist_M = {rotate(R_MM0, {slopes[0], slopes[1], slopes[2]}), rotate(R_MM0, rotation.position)};
  }
  return changeFrame(inverse(X_MO_), twist_M);
}

}  // namespace taxelsim
