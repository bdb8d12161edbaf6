// Simulated force curves of four taxels for tests of readout fits.
#pragma once

#include "bench_session.h"
#include "characterize/estimates.h"
#include "taxelsim/characterize.h"

namespace taxelsim::testing {

inline constexpr double kNoise = 8;   // counts
inline constexpr double kTop = 3800;  // counts
inline const std::vector<TrueTaxel> kTaxels{{2000, 0.05}, {2300, 0.03}, {1900, 0.04}, {2100, 0.06}};

// Every taxel loaded to 2.4 N and unloaded, 60 readings each.
inline ForceCurve pressed(const std::vector<TrueTaxel>& taxels, std::mt19937& random, double noise = kNoise) {
  ForceCurve curve;
  for (std::size_t t = 0; t < taxels.size(); ++t) {
    for (int k = 0; k < 60; ++k) {
      const double force = 2.4 * std::min(k, 59 - k) / 29;
      curve.taxel.push_back(static_cast<int>(t));
      curve.force.push_back(force);
      curve.counts.push_back(reading(taxels[t], force, noise, kTop, random));
    }
  }
  return curve;
}

inline Characterization characterized(ForceCurve curve) {
  const std::vector<Measurement> measurements{measurementOf("curve", benchSensor(2, 2), std::move(curve))};
  return characterize(measurements);
}

struct Truth {
  double slope = 0;
  double trigger = 0;  // mean over taxels
};

inline Truth truthOf(const std::vector<TrueTaxel>& taxels) {
  Truth truth;
  for (const TrueTaxel& taxel : taxels) truth.slope += taxel.slope / static_cast<double>(taxels.size());
  for (const TrueTaxel& taxel : taxels) truth.trigger += taxel.slope / truth.slope * taxel.trigger / static_cast<double>(taxels.size());
  return truth;
}

// Output 2000 x - 400 x^2 + 50 x^3 counts, x: newtons above the trigger.
inline ForceCurve bent(std::mt19937& random, int degree) {
  ForceCurve curve;
  curve.curve_degree = degree;
  for (int t = 0; t < 4; ++t) {
    for (int k = 0; k < 80; ++k) {
      const double force = 0.03 * k, x = force - 0.05;
      curve.taxel.push_back(t);
      curve.force.push_back(force);
      const double counts = x > 0 ? x * (2000 + x * (-400 + x * 50)) : 2000 * x;
      curve.counts.push_back(reading({1, 0}, counts, kNoise, kTop, random));
    }
  }
  return curve;
}

// An S-shaped curve: counts at 0.32, 0.64, ... N above the trigger. The last point is at the last knot of the fit.
inline const std::vector<double> kPieces{200, 1000, 2200, 3100, 0.95 * kTop};
inline constexpr double kPiece = 0.32;                          // N
inline const std::vector<double> kGains{0.95, 1.1, 0.9, 1.05};  // mean 1
inline constexpr double kShown = 0.05;                          // N: trigger

inline double outputOfPieces(double x) {
  double begin = 0;
  for (std::size_t k = 0;; ++k) {
    const double from = kPiece * static_cast<double>(k);
    if (x <= from + kPiece || k + 1 == kPieces.size()) return begin + (kPieces[k] - begin) * (x - from) / kPiece;
    begin = kPieces[k];
  }
}

inline ForceCurve piecewise(std::mt19937& random, int num_pieces) {
  ForceCurve curve;
  curve.curve_segments = num_pieces;
  for (int t = 0; t < 4; ++t) {
    for (int k = 0; k < 100; ++k) {
      const double force = 0.021 * k;
      curve.taxel.push_back(t);
      curve.force.push_back(force);
      curve.counts.push_back(reading({1, 0}, outputOfPieces(kGains[static_cast<std::size_t>(t)] * force - kShown), kNoise, kTop, random));
    }
  }
  return curve;
}

}  // namespace taxelsim::testing
