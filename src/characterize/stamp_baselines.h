// Predictions of an image under a stamp that use recorded images and the positions of the taxels, but no model of the sensor. Every
// parameter comes from the training presses.
#pragma once

#include <array>
#include <cstddef>
#include <optional>
#include <vector>

#include "taxelsim/measurement.h"

namespace taxelsim {

struct RecordedPress {
  const Indenter* indenter = nullptr;
  double load = 0;                                  // N
  std::vector<double> image;                        // (num_taxels), counts
  std::size_t place = 0;                            // presses with the same number stood at one place
  std::optional<std::array<double, 2>> position{};  // m, measured by hand
};

// Counts: the footprint of the stamp, spread by a Gaussian, at the mean centroid of the training images of its place, or without any at its
// measured position.
std::vector<double> blurredFootprint(const Sensor& sensor, const std::vector<RecordedPress>& training, const RecordedPress& wanted);

// The same with one trigger and a gain per taxel, which a ridge penalty keeps near 1. Its strength has the smallest error when each
// training load is left out in turn.
std::vector<double> blurredFootprintWithGains(const Sensor& sensor, const std::vector<RecordedPress>& training,
                                              const RecordedPress& wanted);

// A straight line in the load for each taxel, by least squares over the training presses at the same place, clipped at 0. There must be
// one.
std::vector<double> linePerTaxel(const std::vector<RecordedPress>& training, const RecordedPress& wanted);

}  // namespace taxelsim
