#include "support/envelope.h"

#include "base/vector3.h"
#include "reference/psf.h"
#include "support/test.h"

namespace taxelsim::support {
namespace {

// Adds factor times the interval [value_low, value_high] to the bounds [low, high].
void addProduct(double factor, double value_low, double value_high, double& low, double& high) {
  low += factor * (factor >= 0 ? value_low : value_high);
  high += factor * (factor >= 0 ? value_high : value_low);
}

// Rounding of products and sums of a step, each at most 2^-24 of a strain.
constexpr double kRoundingsPerStep = 16 * 0x1p-24;

}  // namespace

Bounded heightEnvelope(const Sensor& sensor, std::span<const reference::PlacedObject> objects, double shift, double margin_z) {
  Bounded bounds;
  for (const double dx : {0.0, -shift, shift}) {
    for (const double dy : {0.0, -shift, shift}) {
      const std::vector<double> heights = reference::surfaceHeights(sensor, objects, {dx, dy});
      if (bounds.low.empty()) {
        bounds.low = bounds.high = heights;
      }
      for (std::size_t n = 0; n < heights.size(); ++n) {
        bounds.low[n] = std::min(bounds.low[n], heights[n]);
        bounds.high[n] = std::max(bounds.high[n], heights[n]);
      }
    }
  }
  for (std::size_t n = 0; n < bounds.low.size(); ++n) {
    bounds.low[n] -= margin_z;
    bounds.high[n] += margin_z;
  }
  return bounds;
}

FrameEnvelope frameEnvelope(const Sensor& sensor, std::span<const reference::PlacedObject> objects, const Rounding& rounding,
                            const std::optional<Bounded>& previous, double dt, SkinEnvelope* skin) {
  const Winkler law = foundationOf(sensor.skin);
  const Bounded heights = heightEnvelope(sensor, objects, rounding.shift, rounding.margin_z);
  const std::vector<reference::Sample> samples = reference::samplesOf(sensor);
  const auto per_taxel = static_cast<double>(reference::samplesPerTaxel(sensor));
  const std::size_t num_taxels = samples.size() / reference::samplesPerTaxel(sensor);
  const std::vector<double> zero(num_taxels, 0);

  FrameEnvelope frame;
  frame.penetration = {reference::penetrations(heights.high, sensor.skin.thickness),
                       reference::penetrations(heights.low, sensor.skin.thickness)};
  frame.mean_penetration = frame.taxel_force = {zero, zero};
  frame.wrench = {std::vector<double>(6, 0), std::vector<double>(6, 0)};
  frame.over_penetration = {{0}, {0}};
  const reference::SkinStep skin_low = skin ? skin->low.step(dt) : reference::SkinStep{};
  const reference::SkinStep skin_high = skin ? skin->high.step(dt) : reference::SkinStep{};
  Bounded strain;
  // With relaxation the pressure is a difference of strains, each rounded like a force; a step rounds these and up to four overstresses.
  const double relative_strain = skin ? rounding.relative_force + kRoundingsPerStep * skin->num_steps : 0;
  for (std::size_t n = 0; n < samples.size(); ++n) {
    const reference::Sample& sample = samples[n];
    const double d_low = frame.penetration.low[n], d_high = frame.penetration.high[n];
    const double slowest = previous ? (d_low - previous->high[n]) / dt : 0, fastest = previous ? (d_high - previous->low[n]) / dt : 0;
    const double elastic_low = reference::contactPressure(law, d_low, slowest),
                 elastic_high = reference::contactPressure(law, d_high, fastest);
    const auto low = skin_high.press(n, elastic_low), high = skin_low.press(n, elastic_high);  // crosswise
    strain.low.push_back(skin_low.press(n, elastic_low).strain);
    strain.high.push_back(skin_high.press(n, elastic_high).strain);
    const double absolute = elastic_high > 0 ? relative_strain * strain.high[n] : 0;
    const double force_low = std::max(0.0, low.pressure * (1 - rounding.relative_force) - absolute) * sample.area;
    const double force_high = (high.pressure * (1 + rounding.relative_force) + absolute) * sample.area;
    frame.taxel_force.low[sample.taxel] += force_low;
    frame.taxel_force.high[sample.taxel] += force_high;
    frame.mean_penetration.low[sample.taxel] += d_low / per_taxel;
    frame.mean_penetration.high[sample.taxel] += d_high / per_taxel;
    // A depth within rounding of the thickness may count as over-penetration or not.
    frame.over_penetration.low[0] += -heights.high[n] >= sensor.skin.thickness ? 1.0 : 0.0;
    frame.over_penetration.high[0] += -heights.low[n] >= sensor.skin.thickness ? 1.0 : 0.0;
    const Pose& X_SP = sensor.patches[sample.patch].X_SP;
    const Vector3 direction = rotate(X_SP.rotation, {0, 0, -1});
    const Vector3 arm = cross(X_SP * sample.position_P, direction);
    for (int axis = 0; axis < 3; ++axis) {
      addProduct(direction[axis], force_low, force_high, frame.wrench.low[axis], frame.wrench.high[axis]);
      addProduct(arm[axis], force_low, force_high, frame.wrench.low[3 + axis], frame.wrench.high[3 + axis]);
    }
  }
  if (skin) {
    skin->low.advance(dt, strain.low);
    skin->high.advance(dt, strain.high);
    ++skin->num_steps;
  }
  for (std::size_t t = 0; t < num_taxels; ++t) {
    frame.taxel_force.low[t] -= rounding.absolute_force;
    frame.taxel_force.high[t] += rounding.absolute_force;
    frame.total_low += frame.taxel_force.low[t];
    frame.total_high += frame.taxel_force.high[t];
  }
  frame.spread_force = {reference::spread(sensor, frame.taxel_force.low), reference::spread(sensor, frame.taxel_force.high)};
  frame.over_penetration.low[0] /= static_cast<double>(samples.size());
  frame.over_penetration.high[0] /= static_cast<double>(samples.size());
  return frame;
}

}  // namespace taxelsim::support
