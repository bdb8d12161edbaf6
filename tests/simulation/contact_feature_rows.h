// Contact features of the device against the twin's of the same forces, within tolerances derived here.
#pragma once

#include "simulation/comparison.h"
#include "support/test.h"

namespace taxelsim::support {

// Sums of up to 16384 terms in up to 64 partial sums of 256: rounding of the terms' own size, 256 + 64 at worst, a tenth of that by chance.
inline constexpr double kSum = 64 * kUlp;

// One row of the features of the device.
struct Row {
  Row(const ContactFeatureView& of, int instance, int number) : view(of), at(static_cast<std::size_t>(instance * of.num_rows + number)) {}
  double operator()(std::span<const float> values, std::size_t width = 1, std::size_t component = 0) const {
    return values[width * at + component];
  }
  std::int32_t operator()(std::span<const std::int32_t> values) const { return values[at]; }
  ContactType operator()(std::span<const ContactType> values) const { return values[at]; }
  const ContactFeatureView& view;
  std::size_t at;
};

// Compares measured and clean features with the twin's, computed from the device's own forces and counts.
void expectFrame(const FrameView& frame, const Sensor& sensor, int num_instances);

}  // namespace taxelsim::support
