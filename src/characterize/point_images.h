// Images under an indenter at known positions, prepared for a fit of the point spread function.
#pragma once

#include <array>
#include <cstddef>
#include <vector>

#include "characterize/fits.h"
#include "characterize/footprint.h"

namespace taxelsim {

struct PointImage {
  std::vector<double> share;        // (num_taxels), of the indenter's force
  std::vector<std::size_t> loaded;  // taxels with a share
  std::vector<std::size_t> taxels;  // fitted taxels
  const float* counts = nullptr;    // (num_taxels)
  double amplitude = 0;             // N, start value
  double force = 0;                 // N, measured; 0 for none
  // What the shares are made of, for images at another place.
  const PointImages* points = nullptr;
  std::size_t row = 0;
  std::vector<PressedSection> sections;

  // Sets the shares, and the taxels with a share, of a footprint that is moved by `offset` (m) from its recorded place.
  void place(const GridPatch& patch, const std::array<double, 2>& offset);
};

// Images with contact, at most 600 of them. The footprint is that of an elastic foundation (footprint.h) pressed as deep as carries the
// measured force, or else the force that the image reads. `num_off` receives the number of images whose indenter is off the array. Throws
// Error(kInput) if no image is left.
std::vector<PointImage> pointImages(Measured measurements, const Sensor& sensor, std::size_t& num_off);

}  // namespace taxelsim
