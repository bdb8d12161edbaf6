#include "taxelsim/trajectory.h"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <numbers>

#include "base/philox.h"
#include "base/vector3.h"
#include "control/twist.h"
#include "control/values.h"

namespace taxelsim {
namespace {

constexpr double kTwoPi = 2 * std::numbers::pi;

Quaternion conjugate(const Quaternion& q) {
  return {q[0], -q[1], -q[2], -q[3]};
}

// The twist with which a screw takes a rotation by the shortest way to another one in unit time, in the axes of either.
Vector3 rotationVector(const Quaternion& from, const Quaternion& to) {
  Quaternion turn = conjugate(from) * to;
  if (turn[0] < 0) turn = {-turn[0], -turn[1], -turn[2], -turn[3]};
  const Vector3 imaginary{turn[1], turn[2], turn[3]};
  const double sine = length(imaginary);
  if (sine == 0) return {0, 0, 0};
  return scale(2 * std::atan2(sine, turn[0]) / sine, imaginary);
}

// The interval that holds `t`, counted from the first waypoint, and how far through it t is.
struct Place {
  std::size_t from;  // the next waypoint ends the interval
  double part;       // 0 to 1
};

bool isAtRest(const Waypoints& way, double t) {
  return way.points.size() < 2 || t < 0 || t >= way.points.back().time - way.points.front().time;
}

// Of a way that is not at rest at t.
Place placeOf(const Waypoints& way, double t) {
  const double time = way.points.front().time + t;
  const auto later = [](double value, const Waypoint& point) { return value < point.time; };
  const auto after = std::upper_bound(way.points.begin() + 1, way.points.end() - 1, time, later);
  const auto from = static_cast<std::size_t>(after - way.points.begin()) - 1;
  return {from, (time - way.points[from].time) / (way.points[from + 1].time - way.points[from].time)};
}

Vector3 slopeBefore(const Waypoints& way, std::size_t k) {
  return scale(1 / (way.points[k].time - way.points[k - 1].time), subtract(way.points[k].pose.position, way.points[k - 1].pose.position));
}

// m/s at a waypoint, of the cubic.
Vector3 slopeAt(const Waypoints& way, std::size_t k) {
  if (k == 0 || k + 1 == way.points.size()) return {0, 0, 0};
  const double before = way.points[k].time - way.points[k - 1].time;
  const double behind = way.points[k + 1].time - way.points[k].time;
  return scale(1 / (before + behind), add(scale(behind, slopeBefore(way, k)), scale(before, slopeBefore(way, k + 1))));
}

// The coefficients of p0, p1, m0 h, m1 h at u.
std::array<double, 4> hermite(double u) {
  const double u2 = u * u, u3 = u2 * u;
  return {2 * u3 - 3 * u2 + 1, 3 * u2 - 2 * u3, u3 - 2 * u2 + u, u3 - u2};
}
std::array<double, 4> hermiteSlope(double u) {
  const double u2 = u * u;
  return {6 * u2 - 6 * u, 6 * u - 6 * u2, 3 * u2 - 4 * u + 1, 3 * u2 - 2 * u};
}

Vector3 combine(const Waypoints& way, std::size_t k, const std::array<double, 4>& c) {
  const double h = way.points[k + 1].time - way.points[k].time;
  // As a difference to the first waypoint, so that a way far from its frame's origin loses no digits.
  const Vector3& origin = way.points.front().pose.position;
  Vector3 sum =
      add(scale(c[0], subtract(way.points[k].pose.position, origin)), scale(c[1], subtract(way.points[k + 1].pose.position, origin)));
  if (way.interpolation == Waypoints::Interpolation::kLinear) return sum;
  sum = add(sum, scale(c[2] * h, slopeAt(way, k)));
  return add(sum, scale(c[3] * h, slopeAt(way, k + 1)));
}

Pose displacement(const Waypoints& way, double t) {
  const Waypoint& first = way.points.front();
  const auto relative = [&](const Vector3& p, const Quaternion& R) { return Pose{p, R * conjugate(first.pose.rotation)}; };
  if (isAtRest(way, t)) {
    if (t <= 0) return {};
    return relative(subtract(way.points.back().pose.position, first.pose.position), way.points.back().pose.rotation);
  }
  const auto [k, u] = placeOf(way, t);
  const bool is_linear = way.interpolation == Waypoints::Interpolation::kLinear;
  const Vector3 position = combine(way, k, is_linear ? std::array{1 - u, u, 0.0, 0.0} : hermite(u));
  const Vector3 turn = rotationVector(way.points[k].pose.rotation, way.points[k + 1].pose.rotation);
  return relative(position, way.points[k].pose.rotation * exponential({{0, 0, 0}, turn}, u).rotation);
}

// Of M, in M.
Twist velocity(const Waypoints& way, double t) {
  if (isAtRest(way, t)) return {};
  const auto [k, u] = placeOf(way, t);
  const double h = way.points[k + 1].time - way.points[k].time;
  const bool is_linear = way.interpolation == Waypoints::Interpolation::kLinear;
  const Vector3 v_W = scale(1 / h, combine(way, k, is_linear ? std::array{-1.0, 1.0, 0.0, 0.0} : hermiteSlope(u)));
  const Vector3 turn = rotationVector(way.points[k].pose.rotation, way.points[k + 1].pose.rotation);
  // `turn` has the axes of a frame whose rotation in M is that of the first waypoint.
  return {rotate(conjugate(displacement(way, t).rotation), v_W), scale(1 / h, rotate(way.points.front().pose.rotation, turn))};
}

double sinusoidAt(const Sinusoid& s, double t) {
  return std::sin(kTwoPi * s.frequency * t + s.phase) - std::sin(s.phase);
}

void checkBand(const std::array<double, 2>& band, const char* field) {
  for (const double frequency : band) requireValue(isPositive(frequency), "motion", field, frequency, "a frequency > 0 Hz");
  requireValue(band[0] <= band[1], "motion", field, band[0], "[min, max] with min <= max");
}

void check(const ConstantTwist& motion) {
  for (const double v : motion.twist.v) requireValue(std::isfinite(v), "motion", "twist.v", v, "a finite velocity");
  for (const double w : motion.twist.w) requireValue(std::isfinite(w), "motion", "twist.w", w, "a finite velocity");
}

void check(const Sinusoid& motion) {
  requireValue(isPositive(length(motion.axis)), "motion", "axis", length(motion.axis), "a vector of finite length > 0");
  requireValue(std::isfinite(motion.amplitude), "motion", "amplitude", motion.amplitude, "a finite length");
  requireValue(std::isfinite(motion.angle), "motion", "angle", motion.angle, "a finite angle");
  requireValue(isPositive(motion.frequency), "motion", "frequency", motion.frequency, "a frequency > 0 Hz");
  requireValue(std::isfinite(motion.phase), "motion", "phase", motion.phase, "a finite angle");
}

void check(const Waypoints& motion) {
  requireValue(!motion.points.empty(), "motion", "points", 0, "at least one waypoint");
  for (std::size_t k = 0; k < motion.points.size(); ++k) {
    const Waypoint& point = motion.points[k];
    requireValue(std::isfinite(point.time), "motion", "time", point.time, "a finite time");
    requireValue(k == 0 || point.time > motion.points[k - 1].time, "motion", "time", point.time, "later than the waypoint before");
    for (const double p : point.pose.position) requireValue(std::isfinite(p), "motion", "position", p, "a finite length");
    for (const double q : point.pose.rotation) requireValue(std::isfinite(q), "motion", "rotation", q, "a unit quaternion");
  }
}

void check(const HandHeld& motion) {
  requireValue(isAtLeastZero(motion.drift), "motion", "drift", motion.drift, "a length >= 0 m");
  requireValue(isAtLeastZero(motion.drift_angle), "motion", "drift_angle", motion.drift_angle, "an angle >= 0 rad");
  requireValue(isAtLeastZero(motion.tremor), "motion", "tremor", motion.tremor, "a length >= 0 m");
  requireValue(isAtLeastZero(motion.tremor_angle), "motion", "tremor_angle", motion.tremor_angle, "an angle >= 0 rad");
  checkBand(motion.drift_band, "drift_band");
  checkBand(motion.tremor_band, "tremor_band");
}

}  // namespace

void checkMotion(const Motion& motion) {
  std::visit([](const auto& kind) { check(kind); }, motion);
}

Trajectory::Trajectory(const Motion& motion, const Pose& X_WO, const MotionKey& key)
    : motion_(&motion), X_WM0_{X_WO.position, {1, 0, 0, 0}}, X_MO_{{0, 0, 0}, X_WO.rotation} {
  if (const auto* hand = std::get_if<HandHeld>(&motion)) drawWaves(*hand, key);
}

// The k-th of n waves lies in the k-th n-th of its band, so that no two coincide: their squares then add up.
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
      const double part = (wave % kPerBand + uniform()) / kPerBand;
      const double phase = kTwoPi * uniform();
      waves_[axis][wave] = {rms * std::sqrt(2.0 / kPerBand), kTwoPi * (band[0] + part * (band[1] - band[0])), phase};
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
  if (const auto* screw = std::get_if<ConstantTwist>(motion_)) return exponential(screw->twist, t);
  if (const auto* wave = std::get_if<Sinusoid>(motion_)) {
    const double s = sinusoidAt(*wave, t);
    return {scale(wave->amplitude * s, unit(wave->axis)), axisAngle(wave->axis, wave->angle * s)};
  }
  if (const auto* way = std::get_if<Waypoints>(motion_)) return displacement(*way, t);
  const std::array<double, kNumAxes> sums = waveSums(t);
  const Vector3 turn{sums[3] - start_[3], sums[4] - start_[4], sums[5] - start_[5]};
  return {{sums[0] - start_[0], sums[1] - start_[1], sums[2] - start_[2]}, exponential({{0, 0, 0}, turn}, 1).rotation};
}

Pose Trajectory::at(double t) const {
  return X_WM0_ * (displacementAt(t) * X_MO_);
}

Twist Trajectory::twistAt(double t) const {
  Twist twist_M;
  if (const auto* screw = std::get_if<ConstantTwist>(motion_)) {
    twist_M = screw->twist;
  } else if (const auto* wave = std::get_if<Sinusoid>(motion_)) {
    const double rate = kTwoPi * wave->frequency * std::cos(kTwoPi * wave->frequency * t + wave->phase);
    twist_M = {scale(wave->amplitude * rate, unit(wave->axis)), scale(wave->angle * rate, unit(wave->axis))};
  } else if (const auto* way = std::get_if<Waypoints>(motion_)) {
    twist_M = velocity(*way, t);
  } else {
    const std::array<double, kNumAxes> sums = waveSums(t), slopes = waveSlopes(t);
    const Vector3 turn{sums[3] - start_[3], sums[4] - start_[4], sums[5] - start_[5]};
    // The exponential's position is its left Jacobian times v: the angular velocity when the rotation vector changes by v.
    const Pose rotation = exponential({{slopes[3], slopes[4], slopes[5]}, turn}, 1);
    const Quaternion R_MM0 = conjugate(rotation.rotation);
    twist_M = {rotate(R_MM0, {slopes[0], slopes[1], slopes[2]}), rotate(R_MM0, rotation.position)};
  }
  return changeFrame(inverse(X_MO_), twist_M);
}

}  // namespace taxelsim
