// How far a simulated tactile image is from a real one of the same array; paper, figures 8 and 9. Part of the library
// taxelsim_characterize. Images are compared as they are: neither is shifted or scaled first.
#pragma once

#include <cstddef>
#include <span>

#include "taxelsim/measurement.h"
#include "taxelsim/sensor.h"

namespace taxelsim {

// What one image says of the contact, by nominal forces.
struct ImageContact {
  double total_force = 0;               // N
  Vector3 center_of_pressure{0, 0, 0};  // m, in S; NaN without force
  double edge_angle = 0;                // rad in (-pi/2, pi/2], of the longer principal axis; NaN where there is none
};

// Of two images with active taxels A, those where either is above 0. Fractions, not percent. What is not defined is NaN: M1 and M2 when
// both images are all zero, M3 to M5 when the real one is, M5 when the simulated one is. An all-zero simulated image has M4 = 1.
struct ImageComparison {
  std::size_t num_active = 0;    // |A|
  double median_difference = 0;  // M1: median over A of |I_sim - I_real| / full scale
  double mean_difference = 0;    // M2: mean over A of the same
  double rms_difference = 0;     // M3: ||I_sim - I_real||_2 / (sqrt(num_taxels) max I_real), over all taxels, not only A
  double relative_l1 = 0;        // M4: ||I_sim - I_real||_1 / ||I_real||_1
  double cosine = 0;             // M5: <I_sim, I_real> / (||I_sim||_2 ||I_real||_2)
  ImageContact real;
  ImageContact simulated;
  double center_distance = 0;   // m, between the centres of pressure; NaN where one has none
  double angle_difference = 0;  // rad, 0 to pi/2, between the two axes; NaN where one has none
};

// Whether taxel t of one is taxel t of the other: as many patches of the same numbers of rows and columns.
bool haveSameTaxels(const Sensor& a, const Sensor& b);

// Images in counts, (num_taxels), each read by its own sensor's nominal curve; full scale is what the real one's adc_bits can show. Throws
// Error(kInput) when an image and its sensor, or the two sensors, differ in their taxels.
ImageComparison compareImages(const Sensor& real_sensor, std::span<const float> real, const Sensor& simulated_sensor,
                              std::span<const float> simulated);

// A value over several pairs of images, those left out for which it is not defined. All NaN where none is left.
struct ValueRange {
  std::size_t count = 0;
  double median = 0;
  double low = 0;
  double high = 0;
};
ValueRange rangeOf(std::span<const double> values);

// The row nearest to `seconds` (s, >= 0) after touch, which is the first row whose counts sum to more than 5 % of the largest sum of all
// rows. Throws Error(kInput) when the images have no times, nothing touches, or they end before.
std::size_t rowAfterTouch(const Images& images, double seconds);

}  // namespace taxelsim
