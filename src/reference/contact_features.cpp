#include "reference/contact_features.h"

#include <algorithm>
#include <cmath>
#include <iterator>

#include "base/vector3.h"
#include "reference/psf.h"
#include "reference/readout.h"
#include "reference/ridge_edge.h"
#include "sensor/curve.h"
#include "sensor/regions.h"

namespace taxelsim::reference {
namespace {

constexpr double kWindowWidth = 1.15;  // standard deviation of the Gaussian window, in units of the larger pitch
constexpr int kMeanShiftIterations = 4;
constexpr double kMinWindowShare = 1e-3;  // of the total force: less under the window leaves the angle undefined
constexpr double kMinCoreSpread = 3e-5;   // det / (xx yy) of the core's positions: below it they lie on a diagonal line
constexpr double kNoiseFactor = 5;        // standard deviations
constexpr double kLongestPoint = 2.5;     // pitches
constexpr double kWidestEdge = 0.5;       // of its length
constexpr double kArrayWidth = 0.9;       // of the array under even pressure

// Location of a taxel in the sensor: patch, row, column.
struct TaxelOnPatch {
  int patch, i, j;
};

// Positions and adjacency of the taxels.
struct TaxelLayout {
  explicit TaxelLayout(const Sensor& described_sensor) : sensor(described_sensor), positions(taxelPositions(sensor)) {
    for (int p = 0; p < static_cast<int>(sensor.patches.size()); ++p) {
      first.push_back(static_cast<int>(at.size()));
      for (int i = 0; i < sensor.patches[p].num_rows; ++i) {
        for (int j = 0; j < sensor.patches[p].num_cols; ++j) at.push_back({p, i, j});
      }
    }
    setReception();
    if (!isTaxelList(sensor)) return;
    const std::vector<std::vector<int>> lower = listNeighbours(sensor);
    neighbours.resize(at.size());
    for (int t = 0; t < static_cast<int>(lower.size()); ++t) {
      for (const int s : lower[t]) {
        neighbours[t].push_back(s);
        neighbours[s].push_back(t);
      }
    }
  }

  // Where the forces of a taxel come from, and what they sum up to, if every taxel has a force of 1 N.
  void setReception() {
    const std::vector<double>& gain = sensor.readout.calibrated_gain;
    receives.assign(positions.size(), 0);
    received_from.assign(positions.size(), Vector3{0, 0, 0});
    for (const Share& share : spreadMatrix(sensor)) {
      receives[share.taxel] += share.share;
      received_from[share.taxel] = add(received_from[share.taxel], scale(share.share, positions[share.source]));
    }
    for (std::size_t t = 0; t < positions.size(); ++t) {
      received_from[t] = receives[t] > 0 ? scale(1 / receives[t], received_from[t]) : positions[t];
      if (!gain.empty()) receives[t] *= gain[t];
    }
  }

  const Sensor& sensor;
  std::vector<Vector3> positions;
  std::vector<Vector3> received_from{};      // (num_taxels), in S, m
  std::vector<double> receives{};            // (num_taxels), over the calibrated gain
  std::vector<int> first;                    // (num_patches): index of the first taxel
  std::vector<TaxelOnPatch> at;              // (num_taxels)
  std::vector<std::vector<int>> neighbours;  // (num_taxels x any); only for a list of taxels
};

// Neighbours of taxel t; on a grid the 3 x 3 block around it, itself included.
std::vector<int> neighboursOf(const TaxelLayout& layout, int t) {
  if (!layout.neighbours.empty()) return layout.neighbours[t];
  const TaxelOnPatch& a = layout.at[t];
  const GridPatch& patch = layout.sensor.patches[a.patch];
  std::vector<int> around;
  for (int i = std::max(a.i - 1, 0); i <= std::min(a.i + 1, patch.num_rows - 1); ++i) {
    for (int j = std::max(a.j - 1, 0); j <= std::min(a.j + 1, patch.num_cols - 1); ++j) {
      around.push_back(layout.first[a.patch] + i * patch.num_cols + j);
    }
  }
  return around;
}

// Connected components of the reporting taxels, by breadth-first search.
std::vector<std::vector<int>> connectedRegions(const TaxelLayout& layout, const std::vector<bool>& reports) {
  std::vector<std::vector<int>> regions;
  std::vector<bool> seen(reports.size(), false);
  for (int start = 0; start < static_cast<int>(reports.size()); ++start) {
    if (!reports[start] || seen[start]) continue;
    std::vector<int> region{start};
    seen[start] = true;
    for (std::size_t next = 0; next < region.size(); ++next) {
      for (const int neighbour : neighboursOf(layout, region[next])) {
        if (!reports[neighbour] || seen[neighbour]) continue;
        seen[neighbour] = true;
        region.push_back(neighbour);
      }
    }
    std::sort(region.begin(), region.end());
    regions.push_back(region);
  }
  return regions;
}

// Plane of the second moments, and the blur that the PSF and the taxel size add to them.
struct MomentPlane {
  int patch;  // -1: the xy plane of S
  bool is_grid;
  std::array<double, 2> pitch;
  std::array<double, 3> blur;  // m^2: second moments of the PSF and of a taxel, pitch^2 / 12
};

MomentPlane planeOf(const Sensor& sensor, int patch) {
  if (patch >= 0 && !isTaxelList(sensor)) {
    const auto& [px, py] = sensor.patches[patch].pitch;
    const auto& [xx, xy, yy] = spreadShape(sensor.psf, sensor.patches[patch].pitch).moments;
    return {patch, true, {px, py}, {xx + px * px / 12, xy, yy + py * py / 12}};
  }
  const double pitch = meanPitch(sensor);
  const auto& [xx, xy, yy] = spreadShape(sensor.psf, {pitch, pitch}).moments;
  const double blur = (xx + yy) / 2 + pitch * pitch / 12;
  return {patch, false, {pitch, pitch}, {blur, 0, blur}};
}

std::vector<TaxelPlace> placesIn(const TaxelLayout& layout, const MomentPlane& plane, const std::vector<int>& taxels) {
  std::vector<TaxelPlace> places;
  for (const int t : taxels) {
    const auto& [pitch_x, pitch_y] = layout.sensor.patches[layout.at[t].patch].pitch;
    const Vector3 p = plane.patch < 0 ? layout.positions[t] : inverse(layout.sensor.patches[plane.patch].X_SP) * layout.positions[t];
    places.push_back({layout.positions[t], {p[0], p[1]}, pitch_x * pitch_y});
  }
  return places;
}

// Windowed edge angle and confidence: mean shift of a Gaussian window from the centre of pressure.
void setWindowedEdge(std::span<const TaxelPlace> places, std::span<const double> force, double pitch, ContactFeatures& features) {
  const double width = kWindowWidth * pitch;
  std::array<double, 2> middle{0, 0};
  for (std::size_t k = 0; k < force.size(); ++k) {
    for (int axis = 0; axis < 2; ++axis) middle[axis] += force[k] / features.total_force * places[k].in_plane[axis];
  }
  for (int iteration = 0; iteration < kMeanShiftIterations; ++iteration) {
    double sum = 0;
    std::array<double, 2> mean{0, 0};
    std::vector<double> weight;
    for (std::size_t k = 0; k < force.size(); ++k) {
      const double x = places[k].in_plane[0] - middle[0], y = places[k].in_plane[1] - middle[1];
      weight.push_back(force[k] * std::exp(-(x * x + y * y) / (2 * width * width)));
      sum += weight[k];
      mean[0] += weight[k] * places[k].in_plane[0];
      mean[1] += weight[k] * places[k].in_plane[1];
    }
    features.window_share = std::min(features.window_share, sum / features.total_force);
    if (features.window_share < kMinWindowShare) {
      features.windowed_edge_angle = features.windowed_edge_confidence = 0;
      return;
    }
    mean = {mean[0] / sum, mean[1] / sum};
    std::array<double, 3> moments{0, 0, 0};
    for (std::size_t k = 0; k < force.size(); ++k) {
      const double x = places[k].in_plane[0] - mean[0], y = places[k].in_plane[1] - mean[1];
      moments[0] += weight[k] / sum * x * x;
      moments[1] += weight[k] / sum * x * y;
      moments[2] += weight[k] / sum * y * y;
    }
    middle = mean;
    Features axes;
    setPrincipalAxes(moments, axes);
    features.windowed_edge_angle = axes.edge_angle;
    features.windowed_edge_confidence = axes.edge_confidence;
    features.windowed_trace = moments[0] + moments[2];
    // Derivative of the mean by the window's centre: covariance / width^2.
    features.window_growth *= std::max(1.0, axes.eigenvalues[0] / (width * width));
  }
}

// Edge angle from the ridge of a fitted Gaussian. A region has silent taxels of the whole patch, but none of another region.
void setRidgeEdge(const TaxelLayout& layout, const ContactImage& image, const MomentPlane& plane, const std::vector<int>& taxels,
                  ContactFeatures& features) {
  std::vector<bool> of_part(image.force.size(), false);
  for (const int t : taxels) of_part[t] = true;
  std::vector<int> fitted;
  for (int t = 0; t < static_cast<int>(image.force.size()); ++t) {
    const bool in_plane = !plane.is_grid || layout.at[t].patch == plane.patch;
    if (in_plane && layout.receives[t] > 0 && (of_part[t] || !image.reports[t])) fitted.push_back(t);
  }
  std::vector<RidgeTaxel> ridge;
  const Pose X_CS = plane.patch < 0 ? Pose{} : inverse(layout.sensor.patches[plane.patch].X_SP);
  for (const int t : fitted) {
    const Vector3 place = X_CS * layout.received_from[t];
    const double over = layout.receives[t];
    ridge.push_back({.place = {place[0], place[1]},
                     .force = image.reports[t] ? image.force[t] / over : 0,
                     .trigger = triggerOf(layout.sensor.readout, static_cast<std::size_t>(t)) / over,
                     .noise = image.noise / over});
  }
  std::array<double, 2> center{0, 0};
  const std::vector<TaxelPlace> places = placesIn(layout, plane, taxels);
  for (std::size_t k = 0; k < taxels.size(); ++k) {
    for (int axis = 0; axis < 2; ++axis) center[axis] += image.force[taxels[k]] / features.total_force * places[k].in_plane[axis];
  }
  const RidgeEdge edge = ridgeEdge(ridge, {center, features.second_moments, features.peak_force, std::max(plane.pitch[0], plane.pitch[1])});
  features.ridge_edge_angle = edge.angle;
  features.ridge_edge_confidence = edge.confidence;
}

// Whether the taxel is not on the rim of its patch and all taxels within `margin` report. At the rim the contact may end anywhere
// outside the patch.
bool isCore(const TaxelLayout& layout, const std::vector<bool>& reports, int taxel, int margin) {
  const TaxelOnPatch& a = layout.at[taxel];
  const GridPatch& patch = layout.sensor.patches[a.patch];
  if (a.i == 0 || a.j == 0 || a.i == patch.num_rows - 1 || a.j == patch.num_cols - 1) return false;
  for (int i = std::max(a.i - margin, 0); i <= std::min(a.i + margin, patch.num_rows - 1); ++i) {
    for (int j = std::max(a.j - margin, 0); j <= std::min(a.j + margin, patch.num_cols - 1); ++j) {
      if (!reports[layout.first[a.patch] + i * patch.num_cols + j]) return false;
    }
  }
  return true;
}

// Tilt: slope of the least-squares plane through the pressures of the core, over the stiffness of the skin.
void setTilt(const TaxelLayout& layout, const ContactImage& image, const MomentPlane& plane, const std::vector<int>& taxels,
             ContactFeatures& features) {
  const SpreadShape spread = spreadShape(layout.sensor.psf, plane.pitch);
  std::vector<int> core;
  for (const int t : taxels) {
    if (image.reports[t] && !image.saturated[t] && isCore(layout, image.reports, t, spread.radius + 1)) core.push_back(t);
  }
  if (core.size() < 4) return;
  const std::vector<TaxelPlace> places = placesIn(layout, plane, core);
  const auto n = static_cast<double>(core.size());
  std::vector<double> pressure;
  double mean_p = 0, mean_x = 0, mean_y = 0;
  for (std::size_t k = 0; k < core.size(); ++k) {
    pressure.push_back(image.force[core[k]] / (places[k].area * spread.sum));
    mean_p += pressure[k] / n;
    mean_x += places[k].in_plane[0] / n;
    mean_y += places[k].in_plane[1] / n;
  }
  double xx = 0, xy = 0, yy = 0, px = 0, py = 0;
  for (std::size_t k = 0; k < core.size(); ++k) {
    const double x = places[k].in_plane[0] - mean_x, y = places[k].in_plane[1] - mean_y, p = pressure[k] - mean_p;
    xx += x * x, xy += x * y, yy += y * y, px += p * x, py += p * y;
  }
  const double determinant = xx * yy - xy * xy;
  const bool on_line = std::min(xx / (plane.pitch[0] * plane.pitch[0]), yy / (plane.pitch[1] * plane.pitch[1])) < 0.5;
  if (on_line || determinant <= kMinCoreSpread * xx * yy || mean_p <= 0) return;
  const double gx = (yy * px - xy * py) / determinant, gy = (xx * py - xy * px) / determinant;
  double squared_residuals = 0;
  for (std::size_t k = 0; k < core.size(); ++k) {
    const double x = places[k].in_plane[0] - mean_x, y = places[k].in_plane[1] - mean_y;
    const double residual = pressure[k] - mean_p - gx * x - gy * y;
    squared_residuals += residual * residual;
  }
  // Stiffness dp/dd of p = K d^n at the mean pressure.
  const Winkler foundation = foundationOf(layout.sensor.skin);
  const double exponent = foundation.normal_exponent, factor = foundation.normal_contact_stiffness;
  const double depth = std::pow(mean_p / factor, 1 / exponent);
  const double stiffness = exponent * factor * std::pow(depth, exponent - 1);
  features.tilt = {-std::atan(gy / stiffness), std::atan(gx / stiffness)};
  features.core = core;
  features.tilt_confidence = std::max(0.0, 1 - std::sqrt(squared_residuals / (n - 3)) / mean_p);
}

// Second moments of all taxels of a plane under the same pressure, m^2.
std::array<double, 3> evenMoments(const TaxelLayout& layout, const MomentPlane& plane) {
  std::vector<int> taxels;
  for (int t = 0; t < static_cast<int>(layout.at.size()); ++t) {
    if (!plane.is_grid || layout.at[t].patch == plane.patch) taxels.push_back(t);
  }
  const std::vector<TaxelPlace> places = placesIn(layout, plane, taxels);
  std::vector<double> force;
  for (const TaxelPlace& place : places) force.push_back(place.area);
  return reference::featuresOf(places, force, std::vector<bool>(force.size(), true)).second_moments;
}

std::array<double, 3> withoutBlur(std::array<double, 3> moments, const MomentPlane& plane) {
  for (int m = 0; m < 3; ++m) moments[m] -= plane.blur[m];
  return moments;
}

// Sets the sizes of the equivalent rectangle and of the array, and returns the contact type.
ContactType classifyContact(const TaxelLayout& layout, const MomentPlane& plane, ContactFeatures& features) {
  Features unblurred;
  setPrincipalAxes(withoutBlur(features.second_moments, plane), unblurred);
  const double c = std::cos(unblurred.edge_angle), s = std::sin(unblurred.edge_angle);
  const auto [xx, xy, yy] = withoutBlur(evenMoments(layout, plane), plane);
  features.length = std::sqrt(12 * std::max(unblurred.eigenvalues[0], 0.0));
  features.width = std::sqrt(12 * unblurred.eigenvalues[1]);
  features.longest_point = kLongestPoint * std::hypot(c * plane.pitch[0], s * plane.pitch[1]);
  features.widest_point = kLongestPoint * std::hypot(s * plane.pitch[0], c * plane.pitch[1]);
  features.array_width = kArrayWidth * std::sqrt(12 * std::max(s * s * xx - 2 * s * c * xy + c * c * yy, 0.0));
  if (features.total_force <= features.least_force) return ContactType::kNone;
  if (features.length <= features.longest_point) return ContactType::kPoint;
  if (features.width > kWidestEdge * features.length) return ContactType::kArea;
  const bool as_wide_as_the_array = features.width > features.widest_point && features.width >= features.array_width;
  return as_wide_as_the_array ? ContactType::kArea : ContactType::kEdge;
}

ContactFeatures featuresOf(const TaxelLayout& layout, const ContactImage& image, const std::vector<int>& taxels, int patch) {
  const MomentPlane plane = planeOf(layout.sensor, patch);
  const std::vector<TaxelPlace> places = placesIn(layout, plane, taxels);
  std::vector<double> force;
  std::vector<bool> reports;
  for (const int t : taxels) {
    force.push_back(image.force[t]);
    reports.push_back(image.reports[t]);
  }
  ContactFeatures features;
  static_cast<Features&>(features) = reference::featuresOf(places, force, reports);
  features.patch = patch;
  if (features.total_force <= 0) return features;
  setWindowedEdge(places, force, std::max(plane.pitch[0], plane.pitch[1]), features);
  setRidgeEdge(layout, image, plane, taxels, features);
  if (plane.is_grid) setTilt(layout, image, plane, taxels, features);
  features.least_force = kNoiseFactor * image.noise * std::sqrt(static_cast<double>(taxels.size()));
  features.contact_type = classifyContact(layout, plane, features);
  return features;
}

}  // namespace

ContactRows contactFeatures(const Sensor& sensor, const ContactImage& image) {
  const TaxelLayout layout(sensor);
  const bool is_list = isTaxelList(sensor);
  std::vector<int> all;
  for (int t = 0; t < static_cast<int>(layout.at.size()); ++t) all.push_back(t);
  ContactRows rows;
  rows.sensor = featuresOf(layout, image, all, sensor.patches.size() == 1 ? 0 : -1);
  for (int p = 0; p < numFeaturePatches(sensor); ++p) {
    std::vector<int> taxels;
    std::copy_if(all.begin(), all.end(), std::back_inserter(taxels), [&](int t) { return layout.at[t].patch == p; });
    rows.patches.push_back(featuresOf(layout, image, taxels, p));
  }
  for (const std::vector<int>& region : connectedRegions(layout, image.reports)) {
    const auto largest = [&](int s, int t) { return image.force[s] < image.force[t]; };
    const int representative = is_list ? *std::max_element(region.begin(), region.end(), largest) : region.front();
    rows.regions.push_back(featuresOf(layout, image, region, layout.at[representative].patch));
    rows.regions.back().taxels = region;
  }
  std::stable_sort(rows.regions.begin(), rows.regions.end(),
                   [](const ContactFeatures& a, const ContactFeatures& b) { return a.total_force > b.total_force; });
  return rows;
}

ContactImage cleanContactImage(const Sensor& sensor, std::span<const double> spread_force) {
  ContactImage image;
  for (std::size_t t = 0; t < spread_force.size(); ++t) {
    image.force.push_back(spread_force[t]);
    image.reports.push_back(spread_force[t] > std::max(0.0, triggerOf(sensor.readout, t)));
    image.saturated.push_back(false);
  }
  return image;
}

ContactImage measuredContactImage(const Sensor& sensor, std::span<const std::uint32_t> counts, double extra_noise) {
  const Readout& readout = sensor.readout;
  ContactImage image{.force = measuredForce(sensor, counts)};
  for (const std::uint32_t value : counts) {
    image.reports.push_back(value > 0);
    image.saturated.push_back(value >= static_cast<std::uint32_t>(readout.saturation));
  }
  image.noise = std::hypot(readout.noise, extra_noise) / (readout.output_scale * slopeAtZero(readout));
  return image;
}

}  // namespace taxelsim::reference
