// Contact features of the reference: windowed edge angle, tilt and contact type of the whole sensor, of each patch and of each contact
// region.
//
//   region               connected component of the reporting taxels of a patch, 8-connected on a grid; found by breadth-first search
//   windowed edge angle  principal axis under a Gaussian window of 1.15 pitches that converges on the contact by mean shift, 4 rounds
//                        (D. Comaniciu and P. Meer, IEEE Trans. PAMI 24(5), 2002); less biased than plain moments on truncated edges
//   ridge edge angle     major axis of a Gaussian fitted to the forces on a logarithmic scale (reference/ridge_edge.h)
//   tilt                 slope of the least-squares plane through the pressures of the core, over the stiffness of the skin. Core: the
//                        taxels so far inside the contact that neither its rim nor saturation changes their force
//   contact type         from length and width of the uniform rectangle with the same second moments, less those of the PSF and of a taxel
//                        (include/taxelsim/contact_type.h); one as wide as the array is an area
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "reference/features.h"
#include "taxelsim/contact_type.h"

namespace taxelsim::reference {

// Features of one row, as in ContactFeatureView, and the quantities they follow from, for tests.
struct ContactFeatures : Features {
  TAXELSIM_CONTACT_FEATURES(TAXELSIM_VALUE)

  double window_share = 1;                     // smallest fraction of the force under the window in any round
  double window_growth = 1;                    // bound on |d(final centre)/d(initial centre)| of the window
  double windowed_trace = 0;                   // m^2: trace of the second moments under the window
  double length = 0, width = 0;                // m: of the equivalent rectangle
  double longest_point = 0, widest_point = 0;  // m: longest length of a point; the same limit for the width
  double array_width = 0;                      // m: width from which a contact is as wide as the array
  double least_force = 0;                      // N: total forces up to this are noise
  std::vector<int> core{};                     // taxels that the tilt is fitted to
  std::vector<int> taxels{};                   // regions only: its taxels, ascending
};

struct ContactRows {
  ContactFeatures sensor;
  std::vector<ContactFeatures> patches;  // (num_patches); empty for a list of taxels
  std::vector<ContactFeatures> regions;  // all, by descending force, ties by their lowest taxel
};

// Input of contactFeatures(); arrays have shape (num_taxels).
struct ContactImage {
  std::vector<double> force{};    // N
  std::vector<bool> reports{};    // whether the taxel reports contact
  std::vector<bool> saturated{};  // whether the taxel is saturated
  double noise = 0;               // N: standard deviation at one taxel
};

ContactRows contactFeatures(const Sensor& sensor, const ContactImage& image);

// Image of the clean forces (num_taxels), N.
ContactImage cleanContactImage(const Sensor& sensor, std::span<const double> spread_force);

// Image of the measured forces. extra_noise (counts): noise of the episode, added in quadrature to the sensor's own.
ContactImage measuredContactImage(const Sensor& sensor, std::span<const std::uint32_t> counts, double extra_noise = 0);

}  // namespace taxelsim::reference
