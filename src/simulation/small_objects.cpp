#include "simulation/small_objects.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <limits>
#include <numbers>
#include <string>
#include <variant>

#include "base/log.h"
#include "base/text.h"

namespace taxelsim {
namespace {

// Samples across an object below which it is warned of, and from which its area is known to about a quarter.
constexpr double kFewSamples = 2, kEnoughSamples = 4;
// The same for an object longer than the array, which crosses it: even where it lies along a row of samples, one row touches it. Elsewhere
// many samples along its length do.
constexpr double kFewSamplesAcross = 1;

// The extents of the object along its axes, m, the smallest first.
std::array<double, 3> extentsOf(const Object& object) {
  const Bounds bounds = boundsOf(object);
  std::array<double, 3> extents{};
  for (std::size_t axis = 0; axis < 3; ++axis) extents[axis] = static_cast<double>(bounds.max[axis]) - bounds.min[axis];
  std::sort(extents.begin(), extents.end());
  return extents;
}

std::string millimetres(double length) {
  std::array<char, 32> text{};
  std::snprintf(text.data(), text.size(), "%.3g mm", 1e3 * length);
  return text.data();
}

double coarsestPitch(const Sensor& sensor) {
  double pitch = 0;
  for (const GridPatch& patch : sensor.patches) pitch = std::max({pitch, patch.pitch[0], patch.pitch[1]});
  return pitch;
}

// Diagonal of the box around the taxels, m.
double arrayLength(const Sensor& sensor) {
  Vector3 least{}, most{};
  least.fill(std::numeric_limits<double>::max());
  most.fill(std::numeric_limits<double>::lowest());
  for (const Vector3& position : taxelPositions(sensor)) {
    for (std::size_t axis = 0; axis < 3; ++axis) {
      least[axis] = std::min(least[axis], position[axis]);
      most[axis] = std::max(most[axis], position[axis]);
    }
  }
  return std::hypot(most[0] - least[0], most[1] - least[1], most[2] - least[2]) + std::numbers::sqrt2 * coarsestPitch(sensor);
}

}  // namespace

void warnOfSmallObjects(const Sensor& sensor, std::span<const Object> objects) {
  if (sensor.depth_sampling == DepthSampling::kArea) return;
  const double pitch = coarsestPitch(sensor), spacing = pitch / sensor.samples_per_taxel, length = arrayLength(sensor);
  for (std::size_t i = 0; i < objects.size(); ++i) {
    const std::array<double, 3> extents = extentsOf(objects[i]);
    const double few = extents[2] > length ? kFewSamplesAcross : kFewSamples;
    const double width = extents[0], least_width = few * spacing;
    const bool is_plate = extents[1] >= least_width;
    if (!(width < least_width)) continue;
    const double count = std::ceil(kEnoughSamples * pitch / width);
    const std::string name = objects[i].name.empty() ? std::to_string(i) : oneLine(objects[i].name);
    std::string line = "object " + name + " is " + millimetres(width) + " wide, samples are " + millimetres(spacing) +
                       " apart: " + (is_plate ? "where it touches with an edge, " : "") +
                       "its force depends on where it lies between them; depth_sampling: area counts all of it";
    if (count <= kMaxSamplesPerTaxel) line += ", samples_per_taxel: " + std::to_string(static_cast<int>(count)) + " sees it";
    logWarning(line);
  }
}

}  // namespace taxelsim
