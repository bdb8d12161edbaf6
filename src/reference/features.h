// Stage 6 of the reference, features: moments of a force image, Kappassov, Corrales and Perdereau, AIM 2020, eq. (3).
//
// The edge angle is the direction of the principal axis, 1/2 atan2(2 mu_xy, mu_xx - mu_yy), with mu the second central moments; the
// confidence is (l1 - l2) / (l1 + l2), with l1 >= l2 their eigenvalues.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <type_traits>
#include <vector>

#include "taxelsim/feature_table.h"
#include "taxelsim/sensor.h"

namespace taxelsim::reference {

// Double precision, or the type of a feature that is none; an array where it has several components.
template <typename T, std::size_t kWidth>
struct FeatureValue {
  using Element = std::conditional_t<std::is_same_v<T, float>, double, T>;
  using type = std::conditional_t<kWidth == 1, Element, std::array<Element, kWidth>>;
};
#define TAXELSIM_VALUE(constant, name, offset, width, type_, ...) FeatureValue<type_, width>::type name{};

// Features of one image, taxelsim/feature_table.h.
struct Features {
  TAXELSIM_IMAGE_FEATURES(TAXELSIM_VALUE)
};

// Whether the edge angle is defined.
inline bool hasEdge(const Features& features) {
  return features.eigenvalues[0] > features.eigenvalues[1];
}

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
