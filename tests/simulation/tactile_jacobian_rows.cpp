#include "simulation/tactile_jacobian_rows.h"

#include "base/vector3.h"
#include "reference/area_depth.h"
#include "reference/psf.h"
#include "reference/tactile_jacobian.h"
#include "support/test.h"

namespace taxelsim::support {
namespace {

using reference::ByTwist;
using reference::FeatureJacobian;
using reference::Frame;
using reference::TactileJacobian;

// Relative rounding of the terms of a taxel's derivatives: pressures as in kRelativeForce, and as much again for sums and transforms.
constexpr double kRelative = 2 * kRelativeForce;
// Offsets of a position by float32 rounding: the spread of the twin over these corners bounds the error of a value, with some room between
// corners.
constexpr double kBetweenCorners = 3;

// The inputs of the twin Jacobian, with samples moved and the surface lifted.
Frame frameAt(const Sensor& sensor, std::span<const reference::PlacedObject> objects, const std::array<double, 2>& shift, double lift) {
  Frame frame;
  if (sensor.depth_sampling == DepthSampling::kArea) {  // on a flat array
    std::vector<reference::PlacedObject> moved(objects.begin(), objects.end());
    for (reference::PlacedObject& placed : moved) placed.X_SO.position = add(placed.X_SO.position, {-shift[0], -shift[1], lift});
    const reference::AreaDepths depths = reference::AreaDepth(sensor, moved).at();
    frame.penetration = depths.mean;
    frame.share = depths.share;
    frame.points = depths.points;
    frame.contact = reference::computeContact(sensor, depths, {}, 0);
  } else {
    frame.heights = reference::surfaceHeights(sensor, objects, shift);
    for (double& height : frame.heights) height += lift;
    frame.penetration = reference::penetrations(frame.heights, sensor.skin.thickness);
    frame.contact = reference::computeContact(sensor, frame.penetration, {}, 0);
  }
  std::vector<reference::TaxelState> none;
  frame.taxel_force = reference::taxelResponse(sensor, frame.contact.taxel_force, 0, none);
  frame.spread_force = reference::spread(sensor, frame.taxel_force);
  return frame;
}

// A row, or the wrench, as one list of numbers.
std::vector<double> flat(const FeatureJacobian& row) {
  std::vector<double> values;
  for (const ByTwist& axis : row.center_of_pressure) values.insert(values.end(), axis.begin(), axis.end());
  values.insert(values.end(), row.total_force_by_twist.begin(), row.total_force_by_twist.end());
  values.insert(values.end(), row.edge_angle.begin(), row.edge_angle.end());
  return values;
}

std::vector<double> flat(const std::array<ByTwist, 6>& wrench) {
  std::vector<double> values;
  for (const ByTwist& row : wrench) values.insert(values.end(), row.begin(), row.end());
  return values;
}

// (6 x num_taxels), as the device has them.
std::vector<double> byTaxel(const std::vector<ByTwist>& rates) {
  std::vector<double> values;
  for (std::size_t k = 0; k < 6; ++k) {
    for (const ByTwist& taxel : rates) values.push_back(taxel[k]);
  }
  return values;
}

std::vector<double> flat(const TactileJacobianView& view, std::size_t row) {
  std::vector<double> values;
  for (const auto& [block, width] : {std::pair{view.center_of_pressure, 18}, {view.total_force, 6}, {view.edge_angle, 6}}) {
    const auto part = block.subspan(row * static_cast<std::size_t>(width), static_cast<std::size_t>(width));
    values.insert(values.end(), part.begin(), part.end());
  }
  return values;
}

// Sum of magnitudes of the terms for each coordinate of the twist, N/m or N/rad.
ByTwist grossOf(const TactileJacobian& twin, double extent) {
  double by_v = 0;
  for (const ByTwist& taxel : twin.taxel_force) by_v += std::abs(taxel[0]) + std::abs(taxel[1]) + std::abs(taxel[2]);
  ByTwist gross{by_v, by_v, by_v, extent * by_v, extent * by_v, extent * by_v};
  for (const ByTwist& taxel : twin.taxel_force) {
    for (std::size_t k = 3; k < 6; ++k) gross[k] += std::abs(taxel[k]);
  }
  return gross;
}

struct Corners {
  Corners(const Sensor& sensor, std::span<const reference::PlacedObject> objects, const reference::ReadoutDraw& draw) {
    const Rounding rounding = roundingFor(sensor, objects);
    const auto at = [&](double x, double y, double z) {
      return reference::tactileJacobian(sensor, frameAt(sensor, objects, {x * rounding.shift, y * rounding.shift}, z * rounding.margin_z),
                                        draw);
    };
    middle = at(0, 0, 0);
    for (const double x : {-1, 1}) {
      for (const double y : {-1, 1}) corners.push_back(at(x, y, x * y));
    }
  }
  TactileJacobian middle;
  std::vector<TactileJacobian> corners;
};

// `pick` returns the numbers of a row, `gross` the magnitudes of their sums.
template <typename Pick>
void expectNear(const std::vector<double>& found, const Corners& twin, const std::vector<double>& gross, Pick pick, const char* what) {
  const std::vector<double> expected = pick(twin.middle);
  std::vector<std::vector<double>> corners;
  for (const TactileJacobian& corner : twin.corners) corners.push_back(pick(corner));
  std::size_t num_off = 0, first = 0;
  double first_slack = 0;
  for (std::size_t n = found.size(); n-- > 0;) {
    double spread = 0;
    for (const std::vector<double>& corner : corners) spread = std::max(spread, std::abs(corner[n] - expected[n]));
    const double slack = kBetweenCorners * spread + kRelative * (gross[n] + std::abs(expected[n]));
    if (std::abs(found[n] - expected[n]) <= slack) continue;
    ++num_off, first = n, first_slack = slack;
  }
  EXPECT_EQ(num_off, 0u) << what << "[" << first << "]: " << found[first] << ", expected " << expected[first] << " within " << first_slack;
}

template <typename Pick>
void expectRow(const std::vector<double>& found, const Corners& twin, const Sensor& sensor, Pick pick, const char* what) {
  const FeatureJacobian& row = pick(twin.middle);
  const double extent = extentOf(sensor);
  const ByTwist by_twist = grossOf(twin.middle, extent);
  double gain = 1;
  for (const double taxel_gain : sensor.readout.taxel_gain) gain = std::max(gain, taxel_gain);
  std::vector<double> gross;
  for (std::size_t block = 0; block < 5; ++block) {
    for (const double size : by_twist) {
      double value = 2 * gain * size;
      const double difference = row.features.edge_confidence * row.trace;
      if (block < 3) value *= extent / row.features.total_force;
      if (block == 4) value *= difference > 1e-12 ? extent * extent / (row.features.total_force * difference) : 0;
      gross.push_back(row.features.total_force > 0 ? value : 0);
    }
  }
  // Too little force, on one taxel or at its trigger, for meaningful moments.
  if (row.features.total_force < 1e-5) return;
  expectNear(
      found, twin, gross, [&](const TactileJacobian& of) { return flat(pick(of)); }, what);
}

}  // namespace

void expectJacobian(const FrameView& frame, int instance, const Sensor& sensor, std::span<const reference::PlacedObject> objects,
                    const reference::ReadoutDraw& draw) {
  SCOPED_TRACE("instance " + std::to_string(instance));
  const Corners twin(sensor, objects, draw);
  const auto rows = static_cast<std::size_t>(frame.jacobian.num_rows);
  ASSERT_EQ(rows, 1 + twin.middle.clean_patches.size());
  const std::size_t row = static_cast<std::size_t>(instance) * rows;
  expectRow(
      flat(frame.ground_truth.jacobian, row), twin, sensor, [](const TactileJacobian& of) -> const FeatureJacobian& { return of.clean; },
      "clean");
  expectRow(
      flat(frame.jacobian, row), twin, sensor, [](const TactileJacobian& of) -> const FeatureJacobian& { return of.measured; }, "measured");
  for (std::size_t p = 0; p + 1 < rows; ++p) {
    expectRow(
        flat(frame.ground_truth.jacobian, row + 1 + p), twin, sensor,
        [&](const TactileJacobian& of) -> const FeatureJacobian& { return of.clean_patches[p]; }, "clean patch");
    expectRow(
        flat(frame.jacobian, row + 1 + p), twin, sensor,
        [&](const TactileJacobian& of) -> const FeatureJacobian& { return of.measured_patches[p]; }, "measured patch");
  }
  const ByTwist by_twist = grossOf(twin.middle, extentOf(sensor));
  if (!frame.ground_truth.taxel_jacobian.empty()) {
    const std::size_t num_taxels = twin.middle.spread_force.size();
    const auto taxels = frame.ground_truth.taxel_jacobian.subspan(6 * num_taxels * static_cast<std::size_t>(instance), 6 * num_taxels);
    std::vector<double> per_taxel;
    for (const double size : by_twist) per_taxel.insert(per_taxel.end(), num_taxels, size);
    expectNear(
        {taxels.begin(), taxels.end()}, twin, per_taxel, [](const TactileJacobian& of) { return byTaxel(of.spread_force); }, "taxels");
  }
  std::vector<double> gross;
  for (std::size_t c = 0; c < 6; ++c) {
    for (const double size : by_twist) gross.push_back(size * (c < 3 ? 1 : extentOf(sensor)));
  }
  const auto wrench = frame.ground_truth.jacobian.contact_wrench.subspan(36 * static_cast<std::size_t>(instance), 36);
  expectNear(
      {wrench.begin(), wrench.end()}, twin, gross, [](const TactileJacobian& of) { return flat(of.contact_wrench); }, "wrench");
}

}  // namespace taxelsim::support
