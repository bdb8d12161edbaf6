// Features of what is in contact, of the reference: of the whole sensor, of its patches, and of regions, the connected taxels that report.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "reference/features.h"
#include "taxelsim/contact_type.h"

namespace taxelsim::reference {

// Of one part, as ContactFeatureView has them.
struct ContactFeatures : Features {
  double windowed_edge_angle = 0;
  double windowed_edge_confidence = 0;
  std::array<double, 2> tilt{0, 0};
  double tilt_confidence = 0;
  ContactType contact_type = ContactType::kNone;
  int patch = -1;  // in whose plane all this is; -1: the xy plane of S

  // What these follow from.
  double window_share = 1;                          // the least part of the force that was under the window
  double window_growth = 1;                         // by how much a small step of the window's first middle moves its last
  double windowed_trace = 0;                        // m^2: sum of the second moments under the window
  double length = 0, width = 0, longest_point = 0;  // m
  double least_force = 0;                           // N: no more is no contact
  std::vector<int> core{};                          // taxels from which the tilt is
  std::vector<int> taxels{};                        // of a region
};

struct ContactRows {
  ContactFeatures sensor;
  std::vector<ContactFeatures> patches;  // of a list of taxels none
  std::vector<ContactFeatures> regions;  // all, by force, then by their lowest taxel
};

// What features are taken from, all (num_taxels).
struct ContactImage {
  std::vector<double> force{};    // N
  std::vector<bool> reports{};    // anything
  std::vector<bool> saturated{};  // at the upper end
  double noise = 0;               // N: standard deviation at one taxel
};

ContactRows contactFeatures(const Sensor& sensor, const ContactImage& image);

// From the clean forces, and from the measured ones of a sensor with `extra_noise` counts beside its own.
ContactImage cleanContactImage(const Sensor& sensor, std::span<const double> spread_force);
ContactImage measuredContactImage(const Sensor& sensor, std::span<const std::uint32_t> counts, double extra_noise = 0);

}  // namespace taxelsim::reference
