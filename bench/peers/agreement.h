// Verification before timing: compares a peer's frame with taxelsim's.
#pragma once

#include <nlohmann/json.hpp>
#include <string>

#include "peers/peer.h"
#include "taxelsim/sensor.h"

namespace taxelsim::bench {

struct Agreement {
  Trust trust = Trust::kSameModel;
  std::size_t num_instances = 0;  // compared
  std::size_t num_touched = 0;    // taxels under contact in either
  bool agrees = false;

  // Trust::kSameModel.
  std::size_t num_outliers = 0;    // taxels whose forces differ by more than the tolerance
  std::size_t num_counts_off = 0;  // other taxels whose counts differ by more than the tolerance explains
  double tolerance = 0;            // N
  double largest_inlier = 0;       // N
  double largest = 0;              // N
  double worst_total = 0;          // N, of an instance
  double worst_center = 0;         // m, of an instance

  // Trust::kOtherModel.
  double touched_by_both = 0;                 // fraction of our taxels above a tenth of the peak with force there
  double touched_by_them_alone = 0;           // fraction of their taxels above a tenth of the peak without force here
  double total_median = 0;                    // their total force over ours, median
  double total_low = 0, total_high = 0;       // 5th and 95th percentile
  double center_median = 0, center_high = 0;  // m: distance of the centres of pressure, median and 95th percentile
  double angle_median = 0, angle_high = 0;    // rad: difference of the edge angles where both are confident
};

// Compares the instances of `theirs` with the same ones of `ours`. `depth_tolerance` (m): allowed distance of their surface from ours.
Agreement compare(const Sensor& sensor, const PeerFrame& ours, const PeerFrame& theirs, Trust trust, double depth_tolerance);

// One line.
std::string textOf(const Agreement& agreement);
nlohmann::ordered_json toJson(const Agreement& agreement);

}  // namespace taxelsim::bench
