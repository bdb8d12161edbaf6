// A sensor with the scatter of fitted gains in place of the gains themselves. Counts are compared with the formula of
// include/taxelsim/sensor.h.
#include "characterize/bench_session.h"
#include "support/test.h"
#include "taxelsim/characterize.h"
#include "taxelsim/error.h"

namespace taxelsim::testing {
namespace {

constexpr double kRounding = 1e-12;  // of a few operations in double precision, with a margin of 1000

// Counts of a taxel without noise, rounding and saturation.
double countsOf(const Readout& readout, double gain, double force) {
  const double x = gain * force - readout.trigger;
  double y = 0;
  if (readout.curve_points.empty()) {
    for (std::size_t m = readout.curve.size(); m-- > 0;) y = (y + readout.curve[m]) * x;
  } else {
    CurvePoint from{}, to = readout.curve_points[0];
    for (std::size_t k = 1; k < readout.curve_points.size() && x > to.force; ++k) from = to, to = readout.curve_points[k];
    y = from.counts + (to.counts - from.counts) * (x - from.force) / (to.force - from.force);
  }
  return readout.curve_limit > 0 ? y / (1 + y / readout.curve_limit) : y;
}

// Taxels 0 to 3 have gains, taxel 4 is dead, 5 was not determined.
Characterization fittedTo(const Readout& readout) {
  Characterization fitted{.sensor = benchSensor(2, 3), .estimates = {}, .fits = {}, .figures = {}, .dead_taxels = {4}, .remarks = {}};
  fitted.sensor.readout = readout;
  fitted.sensor.readout.taxel_gain = {0.5, 0.8, 1.2, 1.5, 0, 1};
  fitted.sensor.readout.taxel_trigger.assign(6, 0.07);
  for (std::size_t t = 0; t < 6; ++t)
    fitted.estimates.push_back({.parameter = "readout.taxel_gain[" + std::to_string(t) + "]",
                                .unit = "",
                                .determined = t != 5,
                                .value = fitted.sensor.readout.taxel_gain[t],
                                .remark = ""});
  return fitted;
}

TEST(RandomGains, KeepTheMedianTaxel) {
  Readout cubic;
  cubic.curve = {2000, -150, 8};
  cubic.curve_limit = 6000;
  cubic.trigger = 0.05;
  Readout points;
  points.curve_points = {{0.2, 100}, {1, 900}, {3, 1500}};
  points.trigger = 0.03;
  const double median = std::pow(0.5 * 0.8 * 1.2 * 1.5, 0.25);
  for (const Readout& readout : {cubic, points}) {
    const Characterization fitted = fittedTo(readout);
    const Sensor sensor = withRandomGains(fitted);
    EXPECT_TRUE(sensor.readout.taxel_gain.empty() && sensor.readout.taxel_trigger.empty());
    for (const double force : {0.1, 0.5, 1.3, 2.9}) {
      const double expected = countsOf(readout, median, force);
      EXPECT_NEAR(countsOf(sensor.readout, 1, force), expected, kRounding * std::abs(expected)) << force;
    }
  }
}

TEST(RandomGains, ScatterAsTheFittedOnes) {
  const Characterization fitted = fittedTo({});
  // Sample standard deviation of ln 0.5, ln 0.8, ln 1.2, ln 1.5; neither the dead taxel nor the one without an estimate counts.
  constexpr double kSpread = 0.48336;
  EXPECT_NEAR(gainSpreadOf(fitted).value(), kSpread, 5e-6);
  EXPECT_EQ(withRandomGains(fitted).readout.gain_spread, gainSpreadOf(fitted).value());
  Characterization one = fitted;
  one.estimates.resize(1);
  EXPECT_FALSE(gainSpreadOf(one).has_value());
  EXPECT_THROW(withRandomGains(one), Error);
}

}  // namespace
}  // namespace taxelsim::testing
