/// @file
/// Metrics between a simulated and a real tactile image of the same array (paper, figures 8 and 9). Images are
/// compared without registration: neither is shifted or scaled first.
#pragma once

#include <cstddef>
#include <span>

#include "taxelsim/measurement.h"
#include "taxelsim/sensor.h"

namespace taxelsim {

/// Contact features of one image, computed from nominal forces.
struct ImageContact {
  double total_force = 0;               ///< N.
  Vector3 center_of_pressure{0, 0, 0};  ///< m, in S; NaN if the force is 0.
  double edge_angle = 0;                ///< rad in (-pi/2, pi/2], major principal axis; NaN if undefined.
};

/// Metrics between two images. A is the set of active taxels: those above 0 in either image.
///
/// Values are fractions, not percent. An undefined metric is NaN: M1 and M2 if both images are zero, M3 to M5 if the real image is zero, M5
/// if the simulated image is zero. A simulated image of zeros has M4 = 1.
struct ImageComparison {
  std::size_t num_active = 0;    ///< `|A|`.
  double median_difference = 0;  ///< M1: median over A of `|I_sim - I_real| / full scale`.
  double mean_difference = 0;    ///< M2: mean over A of `|I_sim - I_real| / full scale`.
  double rms_difference = 0;     ///< M3: `||I_sim - I_real||_2 / (sqrt(num_taxels) max I_real)`, over all taxels.
  double relative_l1 = 0;        ///< M4: `||I_sim - I_real||_1 / ||I_real||_1`.
  double cosine = 0;             ///< M5: `<I_sim, I_real> / (||I_sim||_2 ||I_real||_2)`.
  ImageContact real;             ///< Features of the real image.
  ImageContact simulated;        ///< Features of the simulated image.
  double center_distance = 0;    ///< m, between the centres of pressure; NaN if either is undefined.
  double angle_difference = 0;   ///< rad, 0 to pi/2, between the principal axes; NaN if either is undefined.
};

/// Whether both sensors have the same layout: equally many patches, with equal numbers of rows and columns.
bool haveSameTaxels(const Sensor& a, const Sensor& b);

/// Compares two images.
///
/// `real` and `simulated`: (num_taxels), counts. Each is converted to forces by the nominal curve of its own sensor. Full scale is the
/// largest count that the real sensor's `adc_bits` can represent. Throws Error(kInput) if the number of taxels of an image and its sensor,
/// or the layouts of the two sensors, differ.
ImageComparison compareImages(const Sensor& real_sensor, std::span<const float> real, const Sensor& simulated_sensor,
                              std::span<const float> simulated);

/// Median and range of a metric over several pairs of images, without those for which it is undefined. All NaN if none is left.
struct ValueRange {
  std::size_t count = 0;  ///< Number of defined values.
  double median = 0;      ///< Median.
  double low = 0;         ///< Smallest value.
  double high = 0;        ///< Largest value.
};

/// Median and range of `values`; NaN entries are skipped.
ValueRange rangeOf(std::span<const double> values);

/// Index of the row nearest to `seconds` (s, >= 0) after touch.
///
/// Touch is the first row whose counts sum to more than 5 % of the largest sum of all rows. Throws Error(kInput) if the images have no
/// times, if there is no touch, or if they end earlier.
std::size_t rowAfterTouch(const Images& images, double seconds);

}  // namespace taxelsim
