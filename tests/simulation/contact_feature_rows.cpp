#include "simulation/contact_feature_rows.h"

#include "base/vector3.h"
#include "reference/contact_features.h"
#include "support/test.h"

namespace taxelsim::support {
namespace {

using reference::ContactFeatures;
using reference::ContactRows;

// Relative error of a taxel's force on the device.
constexpr double kCleanForce = 0;  // the twin is given the device's own
constexpr double kMeasuredForce = kRelativeInverse;
// The error of exp(x) is 3 + 2 |x| ulp, that of x itself 3 |x|. For |x| > 10 the weight is below e^-10.
constexpr double kWindowWeight = 64 * kUlp;

double pitchOf(const Sensor& sensor) {
  double pitch = 0;
  for (const GridPatch& patch : sensor.patches) pitch = std::max({pitch, patch.pitch[0], patch.pitch[1]});
  return pitch;
}

// Angle and confidence are derived from second moments with an error of `slack`.
void expectAxes(double angle, double confidence, double expected_angle, double expected_confidence, double trace, double slack) {
  const double confidence_slack = 4 * slack / trace + 8 * kUlp;
  if (!(confidence_slack < 0.1)) return;
  EXPECT_NEAR(confidence, expected_confidence, confidence_slack);
  const double angle_slack = 2 * slack / (trace * expected_confidence) + 8 * kUlp;
  if (angle_slack < 0.1) {
    EXPECT_NEAR(std::remainder(angle - expected_angle, std::numbers::pi), 0, angle_slack);
  }
}

// The normal equations of the ridge have a condition number of some 1e3 (prior of 0.1 taxel; moments of tens of taxels), which two rounds
// multiply with the rounding of sums and exponentials.
constexpr double kRidge = 4 * 1e3 * kSum;

void expectRidge(const Row& row, const ContactFeatures& expected) {
  EXPECT_NEAR(row(row.view.ridge_edge_confidence), expected.ridge_edge_confidence, kRidge);
  if (expected.ridge_edge_confidence < 0.1) return;
  const double error = row(row.view.ridge_edge_angle) - expected.ridge_edge_angle;
  EXPECT_NEAR(std::remainder(error, std::numbers::pi), 0, kRidge / expected.ridge_edge_confidence);
}

void expectTilt(const Row& row, const Sensor& sensor, const ContactFeatures& expected, const reference::ContactImage& image,
                double rounding) {
  if (expected.core.empty()) {
    EXPECT_EQ(row(row.view.tilt, 2, 0), 0);
    EXPECT_EQ(row(row.view.tilt, 2, 1), 0);
    EXPECT_EQ(row(row.view.tilt_confidence), 0);
    return;
  }
  const GridPatch& patch = sensor.patches[expected.patch];
  int first = 0;
  for (int p = 0; p < expected.patch; ++p) first += sensor.patches[p].num_rows * sensor.patches[p].num_cols;
  double mean_i = 0, mean_j = 0, mean = 0, largest = 0, farthest = 1;
  const auto n = static_cast<double>(expected.core.size());
  const auto i_of = [&](int t) { return (t - first) / patch.num_cols; };
  const auto j_of = [&](int t) { return (t - first) % patch.num_cols; };
  for (const int t : expected.core) {
    mean_i += i_of(t) / n, mean_j += j_of(t) / n, mean += image.force[t] / n;
    largest = std::max(largest, image.force[t]);
  }
  double ii = 0, ij = 0, jj = 0;
  for (const int t : expected.core) {
    const double i = i_of(t) - mean_i, j = j_of(t) - mean_j;
    ii += i * i, ij += i * j, jj += j * j;
    // The device uses positions relative to the centre of pressure of the whole part.
    farthest = std::max(farthest, std::hypot(patch.num_rows, patch.num_cols));
  }
  // Sums of force times position have the relative error `rounding`; the slope has that error over the smaller second moment of the
  // positions.
  const double smaller = (ii + jj) / 2 - std::hypot((ii - jj) / 2, ij);
  const double gradient = 4 * rounding * n * largest * farthest / smaller;  // N per pitch
  const Winkler law = foundationOf(sensor.skin);
  const double area = patch.pitch[0] * patch.pitch[1];
  const double depth = std::pow(mean / area / law.normal_contact_stiffness, 1 / law.normal_exponent);
  const double stiffness = law.normal_exponent * law.normal_contact_stiffness * std::pow(depth, law.normal_exponent - 1);
  const double slope = gradient / (area * stiffness * std::min(patch.pitch[0], patch.pitch[1]));
  for (std::size_t axis = 0; axis < 2; ++axis) {
    // The error of pow(), as in kRelativeForce.
    const double relative = kRelativeForce * std::abs(expected.tilt[axis]);
    if (slope < 0.1) {
      EXPECT_NEAR(row(row.view.tilt, 2, axis), expected.tilt[axis], 2 * slope + relative + 8 * kUlp) << axis;
    }
  }
  // Squares of forces have the error `rounding`, too, and are subtracted.
  const double missed = 1 - expected.tilt_confidence, square = 16 * rounding * n / (n - 3) * largest * largest / (mean * mean);
  const double slack = std::min(std::sqrt(square), square / std::max(missed, 1e-12)) + 8 * kUlp;
  if (slack < 0.2) {
    EXPECT_NEAR(row(row.view.tilt_confidence), expected.tilt_confidence, slack);
  }
}

void expectType(const Row& row, const ContactFeatures& expected, double slack) {
  // Lengths are roots of moments with an error of `slack`.
  const auto near_equal = [&](double a, double b) { return std::abs(a * a - b * b) <= 2 * 12 * slack + 1e-5 * a * a; };
  const bool on_border = near_equal(expected.length, expected.longest_point) || near_equal(expected.width, expected.length / 2) ||
                         near_equal(expected.width, expected.widest_point) || near_equal(expected.width, expected.array_width) ||
                         std::abs(expected.total_force - expected.least_force) <= 1e-3 * expected.total_force;
  if (!on_border) {
    EXPECT_EQ(row(row.view.contact_type), expected.contact_type);
  }
}

// Compares one row with the twin's features of the same forces, which have the relative error `of_force`.
void expectRow(const Row& row, const Sensor& sensor, const ContactFeatures& expected, const reference::ContactImage& image,
               double of_force) {
  const ContactFeatureView& view = row.view;
  const double rounding = of_force + kSum, extent = extentOf(sensor);
  const double force = expected.total_force;
  EXPECT_NEAR(row(view.total_force), force, rounding * force);
  EXPECT_NEAR(row(view.peak_force), expected.peak_force, rounding * expected.peak_force);
  EXPECT_NEAR(row(view.contact_area), expected.contact_area, kSum * expected.contact_area);
  EXPECT_EQ(row(view.patch), expected.patch);
  const double place = 4 * rounding * extent;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    EXPECT_NEAR(row(view.center_of_pressure, 3, axis), expected.center_of_pressure[axis], place);
  }
  // Moments are about the device's own centre: their error is relative to their size, plus the rounding of the centre.
  const auto [larger, smaller] = expected.eigenvalues;
  const double moment = 8 * rounding * (larger + smaller) + 8 * kUlp * extent * std::sqrt(larger + smaller) + place * place;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    EXPECT_NEAR(row(view.second_moments, 3, axis), expected.second_moments[axis], moment);
  }
  EXPECT_NEAR(row(view.eigenvalues, 2, 0), larger, 2 * moment);
  EXPECT_NEAR(row(view.eigenvalues, 2, 1), smaller, 2 * moment);
  expectAxes(row(view.edge_angle), row(view.edge_confidence), expected.edge_angle, expected.edge_confidence, larger + smaller, moment);

  // In the window iteration an error of the middle grows by `growth` per step; the error of the moments is below the width times that.
  const double width = 1.15 * pitchOf(sensor), weight = rounding + kWindowWeight;
  const bool is_empty = expected.window_share < 1e-3;
  if (is_empty) {
    if (expected.window_share < 0.99e-3) {
      EXPECT_EQ(row(view.windowed_edge_confidence), 0);
    }
  } else if (expected.window_share > 1.01e-3) {
    const double step = expected.window_growth * (place + 4 * weight / expected.window_share * width);
    const double windowed = 8 * weight / expected.window_share * width * width + 4 * width * step;
    expectAxes(row(view.windowed_edge_angle), row(view.windowed_edge_confidence), expected.windowed_edge_angle,
               expected.windowed_edge_confidence, expected.windowed_trace, windowed);
  }
  expectRidge(row, expected);
  expectTilt(row, sensor, expected, image, rounding);
  expectType(row, expected, moment);
}

void expectEmpty(const Row& row, int num_patches) {
  const ContactFeatureView& view = row.view;
  for (const std::span<const float> values :
       {view.total_force, view.peak_force, view.edge_angle, view.edge_confidence, view.contact_area, view.windowed_edge_angle,
        view.windowed_edge_confidence, view.ridge_edge_angle, view.ridge_edge_confidence, view.tilt_confidence}) {
    EXPECT_EQ(row(values), 0);
  }
  EXPECT_EQ(row(view.contact_type), ContactType::kNone);
  for (std::size_t axis = 0; axis < 3; ++axis) {
    EXPECT_EQ(row(view.center_of_pressure, 3, axis), 0);
    EXPECT_EQ(row(view.second_moments, 3, axis), 0);
  }
  EXPECT_EQ(row(view.patch), num_patches == 1 ? 0 : -1);
}

// Compares all rows of an instance.
void expectRows(const ContactFeatureView& view, int instance, const Sensor& sensor, const reference::ContactImage& image, double of_force) {
  SCOPED_TRACE("instance " + std::to_string(instance));
  const ContactRows rows = reference::contactFeatures(sensor, image);
  ASSERT_EQ(view.num_patches, static_cast<int>(rows.patches.size()));
  expectRow(Row(view, instance, 0), sensor, rows.sensor, image, of_force);
  for (int p = 0; p < view.num_patches; ++p) {
    SCOPED_TRACE("patch " + std::to_string(p));
    expectRow(Row(view, instance, 1 + p), sensor, rows.patches[p], image, of_force);
  }
  const int max_regions = view.num_rows - 1 - view.num_patches;
  if (max_regions == 0) return;
  EXPECT_EQ(view.num_regions[instance], static_cast<int>(rows.regions.size()));
  // Forces are summed in fixed point with steps of 2^-(30 - bits of the number of taxels) of the largest: regions that differ by less may
  // be in either order.
  const double step = std::ldexp(rows.sensor.peak_force, static_cast<int>(std::bit_width(image.force.size())) - 30);
  for (int r = 0; r < max_regions; ++r) {
    SCOPED_TRACE("region " + std::to_string(r));
    const Row row(view, instance, 1 + view.num_patches + r);
    if (r >= static_cast<int>(rows.regions.size())) {
      expectEmpty(row, static_cast<int>(sensor.patches.size()));
      continue;
    }
    const ContactFeatures* match = &rows.regions[r];
    double nearest = std::numeric_limits<double>::infinity();
    for (const ContactFeatures& region : rows.regions) {
      const double slack = step * static_cast<double>(region.taxels.size() + rows.regions[r].taxels.size());
      if (std::abs(region.total_force - rows.regions[r].total_force) > slack + 4 * of_force * region.total_force) continue;
      double off = 0;
      for (std::size_t axis = 0; axis < 3; ++axis) {
        off += std::abs(row(view.center_of_pressure, 3, axis) - region.center_of_pressure[axis]);
      }
      if (off < nearest) match = &region;
      nearest = std::min(nearest, off);
    }
    expectRow(row, sensor, *match, image, of_force);
  }
}

}  // namespace

void expectFrame(const FrameView& frame, const Sensor& sensor, int num_instances) {
  const auto n = static_cast<std::size_t>(numTaxels(sensor));
  for (int i = 0; i < num_instances; ++i) {
    const auto counts = frame.tactile_image.subspan(static_cast<std::size_t>(i) * n, n);
    const auto force = frame.ground_truth.tactile_normal_force.subspan(static_cast<std::size_t>(i) * n, n);
    expectRows(frame.contact, i, sensor, reference::measuredContactImage(sensor, counts), kMeasuredForce);
    expectRows(frame.ground_truth.contact, i, sensor, reference::cleanContactImage(sensor, std::vector<double>(force.begin(), force.end())),
               kCleanForce);
  }
}

}  // namespace taxelsim::support
