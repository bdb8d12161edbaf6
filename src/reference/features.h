// Stage 6 of the reference, features: moments of a force image, Kappassov, Corrales and Perdereau, AIM 2020, eq. (3).
//
// The edge angle is the direction of the principal axis, 1/2 atan2(2 mu_xy, mu_xx - mu_yy), with mu the second central moments; the
// confidence is (l1 - l2) / (l1 + l2), with l1 >= l2 their eigenvalues.
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
  std::array<double, 3> second_moments{0, 0, 0};  // m^2: xx, xy, yy about the centre of pressure; in the plane of the patch, or in the xy
                                                  // plane of S for several patches
  std::array<double, 2> eigenvalues{0, 0};        // m^2, of the second moments, larger first
  double edge_angle = 0;                          // rad in (-pi/2, pi/2]; 0 where undefined
  double edge_confidence = 0;                     // 0 to 1
  double contact_area = 0;                        // m^2
};

struct TaxelPlace {
  Vector3 position_S;              // m
  std::array<double, 2> in_plane;  // m: coordinates in the plane of the second moments
  double area;                     // m^2
};

// Features of taxels at `places` with forces (N). is_touched selects the taxels that count towards the contact area. All (num_taxels).
Features featuresOf(std::span<const TaxelPlace> places, std::span<const double> force, const std::vector<bool>& is_touched);

// Sets the second moments (xx, xy, yy, m^2) and their eigenvalues, edge angle and edge confidence.
void setPrincipalAxes(const std::array<double, 3>& second_moments, Features& features);

// Features of the whole sensor; force (N) and is_touched have shape (num_taxels).
Features featuresOf(const Sensor& sensor, std::span<const double> force, const std::vector<bool>& is_touched);

// Clean features, from spread forces (num_taxels), N. A taxel is touched if its force exceeds its trigger.
Features cleanFeatures(const Sensor& sensor, std::span<const double> spread_force);

// Measured features, from counts (num_taxels) turned into forces by the nominal curve. A taxel is touched if its count is not 0.
Features measuredFeatures(const Sensor& sensor, std::span<const std::uint32_t> counts);

}  // namespace taxelsim::reference
