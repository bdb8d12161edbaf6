// Compares frames of the device with the double-precision reference, within tolerances derived here; opens the device that all tests of a
// process share.
//
// Depth and force are bounded by the reference's envelope (tests/support/envelope.h). Readout and features are checked stage by stage: the
// twin's stage takes the device's output of the stage before, so that only the rounding of the stage itself remains.
#pragma once

#include "support/envelope.h"
#include "support/test.h"
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
// Pressure: pow() of a GPU is exp2(n log2 d), |n log2 d| < 40 with 3 ulp in log2 and 3 + 2 * 40 in exp2, about 160 ulp; a sum of up to 256
// samples.
inline constexpr double kRelativeForce = 420 * kUlp;
// Last place of sums in fixed point.
inline constexpr double kAbsoluteForce = 1e-6;  // N
// Moments sum up to 128 x 128 taxels in a tree of float32: about 30 roundings of terms of the sum's own size.
inline constexpr double kRelativeMoment = 64 * kUlp;
// Counts are converted to newtons by iterative inversion of a polynomial in float32.
inline constexpr double kRelativeInverse = 512 * kUlp;

inline constexpr Rounding kRounding{kShift, kMarginZ, kRelativeForce, kAbsoluteForce};
// kRounding, widened for a torus, and for a mesh by the rounding of its vertices to fractions of the sample spacing.
Rounding roundingFor(const Sensor& sensor, std::span<const reference::PlacedObject> objects);

// The largest of the distances of taxel centres from the origin of S and the sides of the array, m.
double extentOf(const Sensor& sensor);

// The one device of this process. TAXELSIM_VALIDATION=1 opens it with the validation layers: any message makes the next wait throw.
const Device& sharedDevice();

// The objects of one instance.
struct Touch {
  std::vector<int> ids;    // (num_slots)
  std::vector<Pose> X_SO;  // (num_slots)

  // The objects for the reference, moved by `offset` (m) along z of S, without empty slots.
  std::vector<reference::PlacedObject> placed(const std::vector<Object>& objects, double offset = 0) const;
};

// Sets the objects of all instances.
void setTouches(Simulator& simulator, const std::vector<Touch>& touches);

// A simulator with a model of its own on the shared device.
Simulator makeSimulator(const Sensor& sensor, const std::vector<Object>& objects, const SimulatorOptions& options = {});

// Sets the objects, and the loads if there are any, of all instances, advances by `dt` (s) and reads the frame.
FrameView stepOnce(Simulator& simulator, const std::vector<Touch>& touches, double dt, const std::vector<float>& loads = {});
// Advances by `dt` (s) and reads the frame.
FrameView stepOnce(Simulator& simulator, double dt);

// Bits of all values of one instance in a frame.
std::vector<std::uint32_t> bitsOf(const FrameView& frame, int instance, int num_instances);
// Bits of every instance, (num_instances).
std::vector<std::vector<std::uint32_t>> bitsOfAll(const FrameView& frame, int num_instances);
// Bits of the values that are held between sensor frames.
std::vector<std::uint32_t> measuredBitsOf(const FrameView& frame, int instance, int num_instances);

// Checks shapes of all arrays, and that all values are finite.
void expectWellFormed(const FrameView& frame, const Sensor& sensor, int num_instances);

// Compares every stage of one instance's frame with the reference: depth and force inside `envelope`; readout (without noise, with the
// gains of the sensor) and features as the twin computes them from the device's own image.
void expectMatches(const FrameView& frame, int instance, const Sensor& sensor, const FrameEnvelope& envelope);

// Mean of high - low over the samples, relative to the thickness of the skin. A large value means that the envelope proves little.
double looseness(const Sensor& sensor, const FrameEnvelope& envelope);

// Expects the median of `values`, the upper one of two, to be at most `max`. Accepts an empty list.
void expectMedianAtMost(std::vector<double> values, double max);

}  // namespace taxelsim::support
