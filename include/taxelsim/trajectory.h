// How an object moves through the world: its pose at any time. Not dynamics: nothing pushes back.
//
// M is a frame at the object's origin, with the axes of W at the start. A Motion says where M goes from there, X_M0M(t) with
// X_M0M(0) = 1, so that the same motion suits every object and every place where one is set down:
//
//   X_WO(t) = X_WM0 X_M0M(t) X_MO,    X_WM0 = {position of X_WO(0), no rotation},    X_MO = {0, rotation of X_WO(0)}
#pragma once

#include <array>
#include <cstdint>
#include <variant>
#include <vector>

#include "taxelsim/pose.h"

namespace taxelsim {

// A screw: X_M0M(t) = exp(twist t), the twist being that of M in its own axes.
struct ConstantTwist {
  Twist twist;
};

// To and fro along an axis, about it, or both: by (sin(2 pi frequency t + phase) - sin(phase)) times amplitude and angle.
struct Sinusoid {
  Vector3 axis{1, 0, 0};  // of any length but 0
  double amplitude = 0;   // m
  double angle = 0;       // rad
  double frequency = 1;   // Hz, > 0
  double phase = 0;       // rad
};

struct Waypoint {
  double time = 0;  // s
  Pose pose;        // of M in any frame with the axes of W; only differences to the first waypoint count
};

// Through poses at given times; at rest before the first and after the last. Time 0 is that of the first waypoint, whatever the file says.
// Positions: straight at constant speed (kLinear), or cubic Hermite (kCubic) with the slope of the parabola through a waypoint and its
// two neighbours, and slope 0 at both ends. Rotations: the shortest way at constant angular velocity from each waypoint to the next.
struct Waypoints {
  enum class Interpolation { kLinear, kCubic };

  std::vector<Waypoint> points;  // at least one, times strictly increasing
  Interpolation interpolation = Interpolation::kCubic;
};

// As a hand holds a thing: slow drift, and physiological tremor in its band of 8 to 12 Hz (R. J. Elble, "Physiologic and enhanced
// physiologic tremor", Handbook of Clinical Neurophysiology 1, 2003; T. Novak, K. M. Newell, "Physiological tremor (8-12 Hz component) in
// isometric force control", Neuroscience Letters 641, 2017). Amplitudes are assumptions. Each band is a sum of sines of equal
// amplitude, one in each third of the band, with random frequencies and phases, the same along and about x, y and z of M.
struct HandHeld {
  double drift = 3e-3;                       // m, >= 0: root mean square about the mean, per axis
  double drift_angle = 0.03;                 // rad, >= 0, the same of the rotation vector
  double tremor = 1e-4;                      // m, >= 0
  double tremor_angle = 1e-3;                // rad, >= 0
  std::array<double, 2> drift_band{0.1, 1};  // Hz, > 0, ascending
  std::array<double, 2> tremor_band{8, 12};  // Hz, > 0, ascending
};

using Motion = std::variant<ConstantTwist, Sinusoid, Waypoints, HandHeld>;

// Throws Error(kInput): the field, the value found and what is allowed.
void checkMotion(const Motion& motion);

// What random motions are drawn from.
struct MotionKey {
  std::uint64_t seed = 0;
  std::uint64_t episode = 0;
  std::uint32_t slot = 0;  // below 2^24; of the object among those an instance touches at once
};

// One object's way through one episode. A pure function of time: neither order nor batch shows.
class Trajectory {
 public:
  // Starts at X_WO at t = 0. `motion` has passed checkMotion() and must outlive this. Allocates nothing.
  Trajectory(const Motion& motion, const Pose& X_WO, const MotionKey& key = {});
  Trajectory(Motion&& motion, const Pose& X_WO, const MotionKey& key = {}) = delete;

  // X_WO at t seconds, t >= 0.
  Pose at(double t) const;

  // The twist of O at t, from the right where the velocity jumps.
  Twist twistAt(double t) const;

 private:
  static constexpr int kNumAxes = 6;   // along x, y, z; about x, y, z
  static constexpr int kNumWaves = 6;  // of an axis: half drift, half tremor
  struct Wave {
    double amplitude;  // m or rad
    double frequency;  // rad/s
    double phase;      // rad
  };

  void drawWaves(const HandHeld& hand, const MotionKey& key);
  std::array<double, kNumAxes> waveSums(double t) const;
  std::array<double, kNumAxes> waveSlopes(double t) const;
  Pose displacementAt(double t) const;

  const Motion* motion_;
  Pose X_WM0_;
  Pose X_MO_;
  std::array<std::array<Wave, kNumWaves>, kNumAxes> waves_{};  // of HandHeld
  std::array<double, kNumAxes> start_{};                       // their sums at t = 0
};

}  // namespace taxelsim
