#include "peers/agreement.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <numbers>
#include <variant>
#include <vector>

namespace taxelsim::bench {
namespace {

// Force error of a taxel per distance of the surface: a column of skin one taxel wide carries 2000 N/m, and on a slope the depth error
// exceeds the distance.
constexpr double kForcePerDepth = 3 * 2000;  // N/m
// Tolerance of a taxel's spread force. float32 heights of objects 60 mm long agree to about 1e-7 m, which is 2e-4 N; the peers' cylinder of
// 1024 strips lies up to 4e-8 m inside the true one.
constexpr double kForceTolerance = 5e-4;  // N
// Outliers: a line through a silhouette or between two triangles may fall on either side, which moves the force of one sample.
constexpr double kMaxOutliers = 2e-3;  // of all taxels under contact
// Tolerance of an instance's total force: a few samples.
constexpr double kTotalForceTolerance = 0.01;  // of the total force
constexpr double kTotalForceFloor = 0.4;       // N: two samples at full depth
constexpr double kMostTouched = 40;            // taxels under large contacts
constexpr double kCountsPerNewton = 2400;

// Other models must touch the same taxels, with the centre of pressure within one taxel. Their force is reported only: ODE's depths are
// those of intersecting triangles and depend on the meshes; MuJoCo's are distances to the nearest surface.
constexpr double kMinTouched = 0.9;
constexpr double kStrong = 0.1;     // of the instance's peak: a taxel inside the contact, not one reached by the spread alone
constexpr double kConfident = 0.3;  // smallest edge_confidence for comparing angles

constexpr double kPi = std::numbers::pi;

double quantile(std::vector<double>& values, double q) {
  if (values.empty()) return 0;
  const auto place = static_cast<std::ptrdiff_t>(q * static_cast<double>(values.size() - 1) + 0.5);
  std::nth_element(values.begin(), values.begin() + place, values.end());
  return values[static_cast<std::size_t>(place)];
}

double centerDistance(const PeerFeatures& a, const PeerFeatures& b) {
  return std::hypot(a.center_of_pressure[0] - b.center_of_pressure[0], a.center_of_pressure[1] - b.center_of_pressure[1]);
}

void compareSame(const PeerFrame& ours, const PeerFrame& theirs, std::size_t num_taxels, double depth_tolerance, Agreement& result) {
  result.tolerance = kForceTolerance + kForcePerDepth * depth_tolerance;
  bool totals_agree = true;
  for (std::size_t i = 0; i < theirs.clean.size(); ++i) {
    for (std::size_t k = i * num_taxels; k < (i + 1) * num_taxels; ++k) {
      const double a = ours.spread_force[k], b = theirs.spread_force[k];
      if (a == 0 && b == 0) continue;
      ++result.num_touched;
      const double difference = std::abs(a - b);
      result.largest = std::max(result.largest, difference);
      if (!(difference <= result.tolerance)) {
        ++result.num_outliers;
        continue;
      }
      result.largest_inlier = std::max(result.largest_inlier, difference);
      const int counts_off = std::abs(static_cast<int>(ours.tactile_image[k]) - static_cast<int>(theirs.tactile_image[k]));
      result.num_counts_off += counts_off > 1 + result.tolerance * kCountsPerNewton;
    }
    for (const auto& [a, b] : {std::pair{ours.clean[i], theirs.clean[i]}, {ours.measured[i], theirs.measured[i]}}) {
      const double total = std::abs(a.total_force - b.total_force);
      result.worst_total = std::max(result.worst_total, total);
      totals_agree &= total <= std::max(kTotalForceFloor + kMostTouched * kForcePerDepth * depth_tolerance,
                                        kTotalForceTolerance * static_cast<double>(a.total_force));
      result.worst_center = std::max(result.worst_center, centerDistance(a, b));
    }
  }
  result.agrees = totals_agree && result.num_touched > 0 && result.num_counts_off == 0 &&
                  static_cast<double>(result.num_outliers) <= kMaxOutliers * static_cast<double>(result.num_touched);
}

void compareOther(const PeerFrame& ours, const PeerFrame& theirs, std::size_t num_taxels, double pitch, Agreement& result) {
  std::size_t strong_here = 0, shared = 0, strong_there = 0, alone = 0;
  std::vector<double> totals, centers, angles;
  for (std::size_t i = 0; i < theirs.clean.size(); ++i) {
    const PeerFeatures &a = ours.clean[i], &b = theirs.clean[i];
    for (std::size_t k = i * num_taxels; k < (i + 1) * num_taxels; ++k) {
      const float here = ours.spread_force[k], there = theirs.spread_force[k];
      result.num_touched += here > 0 || there > 0;
      if (here > 0 && here >= kStrong * static_cast<double>(a.peak_force)) {
        ++strong_here;
        shared += there > 0;
      }
      if (there > 0 && there >= kStrong * static_cast<double>(b.peak_force)) {
        ++strong_there;
        alone += here <= 0;
      }
    }
    if (!(a.total_force > 0)) continue;
    totals.push_back(static_cast<double>(b.total_force) / static_cast<double>(a.total_force));
    if (!(b.total_force > 0)) continue;
    centers.push_back(centerDistance(a, b));
    if (a.edge_confidence < kConfident || b.edge_confidence < kConfident) continue;
    const double turn = std::remainder(static_cast<double>(a.edge_angle) - static_cast<double>(b.edge_angle), kPi);
    angles.push_back(std::abs(turn));
  }
  result.touched_by_both = strong_here ? static_cast<double>(shared) / static_cast<double>(strong_here) : 0;
  result.touched_by_them_alone = strong_there ? static_cast<double>(alone) / static_cast<double>(strong_there) : 0;
  result.total_median = quantile(totals, 0.5);
  result.total_low = quantile(totals, 0.05);
  result.total_high = quantile(totals, 0.95);
  result.center_median = quantile(centers, 0.5);
  result.center_high = quantile(centers, 0.95);
  result.angle_median = quantile(angles, 0.5);
  result.angle_high = quantile(angles, 0.95);
  result.agrees = result.touched_by_both >= kMinTouched && result.center_median <= pitch;
}

}  // namespace

Agreement compare(const Sensor& sensor, const PeerFrame& ours, const PeerFrame& theirs, Trust trust, double depth_tolerance) {
  Agreement result;
  result.trust = trust;
  result.num_instances = theirs.clean.size();
  const auto num_taxels = static_cast<std::size_t>(numTaxels(sensor));
  if (trust == Trust::kSameModel) {
    compareSame(ours, theirs, num_taxels, depth_tolerance, result);
  } else {
    compareOther(ours, theirs, num_taxels, std::max(sensor.patches[0].pitch[0], sensor.patches[0].pitch[1]), result);
  }
  return result;
}

std::string textOf(const Agreement& a) {
  char text[300];
  if (a.trust == Trust::kSameModel) {
    std::snprintf(text, sizeof text, "%zu of %zu taxels over %.2g N (at most %.2g N), others within %.2g N, totals within %.2g N%s",
                  a.num_outliers, a.num_touched, a.tolerance, a.largest, a.largest_inlier, a.worst_total,
                  a.num_counts_off ? ", counts off" : "");
  } else {
    std::snprintf(text, sizeof text,
                  "force %.2f of ours (%.2f to %.2f), centre off by %.2g mm (%.2g), angle by %.1f deg (%.1f), touches %.1f %% of ours, "
                  "%.1f %% elsewhere",
                  a.total_median, a.total_low, a.total_high, a.center_median * 1e3, a.center_high * 1e3, a.angle_median * 180 / kPi,
                  a.angle_high * 180 / kPi, 100 * a.touched_by_both, 100 * a.touched_by_them_alone);
  }
  return text;
}

nlohmann::ordered_json toJson(const Agreement& a) {
  nlohmann::ordered_json json = {{"agrees", a.agrees}, {"num_instances", a.num_instances}, {"touched_taxels", a.num_touched}};
  if (a.trust == Trust::kSameModel) {
    json.update({{"tolerance_N", a.tolerance},
                 {"outlier_taxels", a.num_outliers},
                 {"largest_difference_N", a.largest},
                 {"largest_inlier_N", a.largest_inlier},
                 {"counts_off", a.num_counts_off},
                 {"worst_total_force_N", a.worst_total},
                 {"worst_center_of_pressure_m", a.worst_center}});
  } else {
    json.update({{"touched_by_both", a.touched_by_both},
                 {"touched_by_them_alone", a.touched_by_them_alone},
                 {"total_force_ratio", {{"median", a.total_median}, {"p5", a.total_low}, {"p95", a.total_high}}},
                 {"center_of_pressure_m", {{"median", a.center_median}, {"p95", a.center_high}}},
                 {"edge_angle_rad", {{"median", a.angle_median}, {"p95", a.angle_high}}}});
  }
  return json;
}

}  // namespace taxelsim::bench
