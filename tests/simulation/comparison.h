// The device's frames against the double-precision reference, within tolerances derived here, and the device that all tests share.
//
// Depth and force are bounded by the reference's envelope (tests/support/envelope.h). Readout and features are checked stage by stage: the
// twin's stage is applied to what the device reports of the stage before, so that each stage's own rounding is all that is left.
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "support/envelope.h"
#include "taxelsim/simulator.h"

namespace taxelsim::support {

// One float32 rounding.
inline constexpr double kUlp = 0x1p-24;

// A point of an object within 0.1 m passes through three float32 transforms (vertex, X_SO, X_SP): each of its coordinates takes about four
// roundings of at most 2^-24 0.1 m = 6e-9 m per transform, 7e-8 m if all add up.
inline constexpr double kShift = 1e-7;  // m, in x and y
// The same along z, and as much again for the plane's or solid's equation.
inline constexpr double kMarginZ = 2e-7;  // m
// A torus is the root of a quartic in float32: residual 2^-24 times about 30 terms of order one, in units of its size (up to 30 mm).
inline constexpr double kTorusMarginZ = 2e-6;  // m
// Pressure: pow() of a GPU is exp2(n log2 d), |n log2 d| < 40 with 3 ulp in log2 and 3 + 2 * 40 in exp2, about 160 ulp; a sum of up to 64
// samples.
inline constexpr double kRelativeForce = 250 * kUlp;
// Sums may be held in fixed point, with a last place of at most this.
inline constexpr double kAbsoluteForce = 1e-6;  // N
// Moments sum up to 128 x 128 taxels in a tree of float32: about 30 roundings of terms of the sum's own size.
inline constexpr double kRelativeMoment = 64 * kUlp;
// Turning counts into newtons inverts a polynomial in float32 by iteration.
inline constexpr double kRelativeInverse = 512 * kUlp;

inline constexpr Rounding kRounding{kShift, kMarginZ, kRelativeForce, kAbsoluteForce};
// With the torus's and, of meshes, that of their vertices to fractions of the sample spacing.
Rounding roundingFor(const Sensor& sensor, std::span<const reference::PlacedObject> objects);

// The farthest that a taxel's centre is from the origin of S, and the array's own sides, m: the largest of these.
double extentOf(const Sensor& sensor);

// The one device of this process. TAXELSIM_VALIDATION=1 opens it with the validation layers: any message makes the next wait throw.
const Device& sharedDevice();

// What one instance touches.
struct Touch {
  std::vector<int> ids;    // (num_slots)
  std::vector<Pose> X_SO;  // (num_slots)

  // The same for the reference, moved by `offset` (m) along z of S; empty slots left out.
  std::vector<reference::PlacedObject> placed(const std::vector<Object>& objects, double offset = 0) const;
};

// Hands all touches (one per instance) to the simulator.
void setTouches(Simulator& simulator, const std::vector<Touch>& touches);

// All of one instance's values in a frame, bit by bit, for exact comparison.
std::vector<std::uint32_t> bitsOf(const FrameView& frame, int instance, int num_instances);
// The part that is held between the sensor's own frames.
std::vector<std::uint32_t> measuredBitsOf(const FrameView& frame, int instance, int num_instances);

// Shapes of all arrays, and that every value is finite.
void expectWellFormed(const FrameView& frame, const Sensor& sensor, int num_instances);

// Every stage of one instance's frame against the reference: depth and force inside `envelope`, readout (without noise, with the sensor's
// own gains) and features as the twin computes them from the device's own image.
void expectMatches(const FrameView& frame, int instance, const Sensor& sensor, const FrameEnvelope& envelope);

// Mean over samples of high - low, relative to the skin's thickness: tells whether an envelope proves anything.
double looseness(const Sensor& sensor, const FrameEnvelope& envelope);

}  // namespace taxelsim::support
