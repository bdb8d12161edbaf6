// Stage 6 of the reference: moments of an image of forces (paper eq. (3)).
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "taxelsim/sensor.h"

namespace taxelsim::reference {

struct Features {
  double total_force = 0;                         // N
  double peak_force = 0;                          // N
  Vector3 center_of_pressure{0, 0, 0};            // m, in S; 0 without force
  std::array<double, 3> second_moments{0, 0, 0};  // m^2: xx, xy, yy about the centre of pressure; of one patch in its plane, of several in
                                                  // the xy plane of S
  std::array<double, 2> eigenvalues{0, 0};        // m^2, larger first
  double edge_angle = 0;                          // rad in (-pi/2, pi/2]; 0 where undefined
  double edge_confidence = 0;                     // 0 to 1
  double contact_area = 0;                        // m^2
};

// Where a taxel is.
struct TaxelPlace {
  Vector3 position_S;              // m
  std::array<double, 2> in_plane;  // coordinates in which the second moments are taken, m
  double area;                     // m^2
};

// Of taxels at these places with these forces (N); is_touched says which of them count towards the contact area.
Features featuresOf(std::span<const TaxelPlace> places, std::span<const double> force, const std::vector<bool>& is_touched);

// Second moments (xx, xy, yy, m^2) about the mean, and what they say: eigenvalues, angle and confidence.
void setAxes(const std::array<double, 3>& second_moments, Features& features);

// Forces of all taxels, (num_taxels), N; is_touched says which taxels count towards the contact area.
Features featuresOf(const Sensor& sensor, std::span<const double> force, const std::vector<bool>& is_touched);

// Clean features: a taxel is touched when its spread force is above its trigger.
Features cleanFeatures(const Sensor& sensor, std::span<const double> spread_force);

// Measured features: forces by the nominal curve; a taxel is touched when it reports anything.
Features measuredFeatures(const Sensor& sensor, std::span<const std::uint32_t> counts);

}  // namespace taxelsim::reference
