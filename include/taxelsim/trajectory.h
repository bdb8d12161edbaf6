/// @file
/// Prescribed motion of an object through the world. Not dynamics: contact does not act back on the object.
///
/// M is a frame at the object's origin with the axes of W at the start. A Motion gives the displacement X_M0M(t) with X_M0M(0) = 1, so that
/// the same motion applies to every object and every initial pose:
///
///     X_WO(t) = X_WM0 X_M0M(t) X_MO,    X_WM0 = {position of X_WO(0), no rotation},    X_MO = {0, rotation of X_WO(0)}
#pragma once

#include <array>
#include <cstdint>
#include <variant>
#include <vector>

#include "taxelsim/pose.h"

namespace taxelsim {

/// Screw motion: X_M0M(t) = exp(twist t).
struct ConstantTwist {
  Twist twist;  ///< Twist of M in its own axes.
};

/// Oscillation along an axis, about it, or both: (sin(2 pi frequency t + phase) - sin(phase)) times amplitude and angle.
struct Sinusoid {
  Vector3 axis{1, 0, 0};  ///< Direction in M, of any length but 0.
  double amplitude = 0;   ///< m, along the axis.
  double angle = 0;       ///< rad, about the axis.
  double frequency = 1;   ///< Hz, > 0.
  double phase = 0;       ///< rad.
};

/// Pose at a time.
struct Waypoint {
  double time = 0;  ///< s.
  Pose pose;        ///< Pose of M in any frame with the axes of W; only differences to the first waypoint count.
};

/// Motion through poses at given times; at rest before the first and after the last. Time 0 is the time of the first waypoint.
///
/// Rotations: shortest rotation at constant angular velocity from each waypoint to the next.
struct Waypoints {
  /// Interpolation of positions.
  enum class Interpolation {
    kLinear,  ///< Straight lines at constant speed.
    /// Cubic Hermite spline. The slope at a waypoint is that of the parabola through it and its two neighbours; 0 at both ends.
    kCubic,
  };

  std::vector<Waypoint> points;                         ///< At least one; times strictly increasing.
  Interpolation interpolation = Interpolation::kCubic;  ///< Interpolation of positions. Default kCubic.
};

/// Motion of an object in a human hand: slow drift plus physiological tremor in its band of 8 to 12 Hz.
///
/// R. J. Elble, "Physiologic and enhanced physiologic tremor", Handbook of Clinical Neurophysiology 1, 2003; T. Novak, K. M. Newell,
/// "Physiological tremor (8-12 Hz component) in isometric force control", Neuroscience Letters 641, 2017. The amplitudes are assumptions.
/// Each band is a sum of sines of equal amplitude, one in each third of the band, with random frequencies and phases, independently along
/// and about x, y and z of M with the same statistics.
struct HandHeld {
  double drift = 3e-3;                       ///< m, >= 0, root mean square about the mean, per axis.
  double drift_angle = 0.03;                 ///< rad, >= 0, root mean square of the rotation vector, per axis.
  double tremor = 1e-4;                      ///< m, >= 0, root mean square per axis.
  double tremor_angle = 1e-3;                ///< rad, >= 0, root mean square per axis.
  std::array<double, 2> drift_band{0.1, 1};  ///< Hz, > 0, ascending.
  std::array<double, 2> tremor_band{8, 12};  ///< Hz, > 0, ascending.
};

/// Any motion.
using Motion = std::variant<ConstantTwist, Sinusoid, Waypoints, HandHeld>;

/// Throws Error(kInput) with the field, the value found and what is allowed.
void checkMotion(const Motion& motion);

/// Key of the random numbers of a motion.
struct MotionKey {
  std::uint64_t seed = 0;     ///< Seed of the data set.
  std::uint64_t episode = 0;  ///< Number of the episode.
  std::uint32_t slot = 0;     ///< Slot of the object in its instance, below 2^24.
};

/// Trajectory of one object in one episode: a pure function of time.
///
/// Threads: immutable; may be used from several threads at once.
class Trajectory {
 public:
  /// Starts at X_WO at t = 0. `motion` must have passed checkMotion() and outlive this object. Allocates nothing.
  Trajectory(const Motion& motion, const Pose& X_WO, const MotionKey& key = {});
  Trajectory(Motion&& motion, const Pose& X_WO, const MotionKey& key = {}) = delete;

  /// X_WO at time t (s, >= 0).
  Pose at(double t) const;

  /// Twist of O at time t (s, >= 0); the right limit where the velocity jumps.
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
