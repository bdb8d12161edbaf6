

#include "reference/readout.h"
#include "sensor/curve.h"
#include "support/test.h"
#include "taxelsim/sensor.h"

namespace taxelsim {
namespace {

// Newton's method converges to neighbouring doubles. The evaluation of the curve has a few rounding errors; a slope of at least 1/100 of
// the chord's amplifies them up to 100 times.
constexpr double kRelative = 1e-12;

TEST(NominalForce, IsExactForALinearCurve) {
  Readout readout;
  readout.curve = {2400};
  readout.trigger = 0.2;
  EXPECT_EQ(nominalForce(readout, 0), 0);
  EXPECT_EQ(nominalForce(readout, 3840), 1.8);  // the paper's linear range: 0.2 N to 1.8 N over 3840 counts
  readout.output_scale = 2;
  EXPECT_EQ(nominalForce(readout, 3840), 1.0);
  EXPECT_EQ(nominalForce(readout, -5), 0);
  EXPECT_EQ(nominalForce(readout, std::numeric_limits<double>::quiet_NaN()), 0);
}

TEST(NominalForce, SolvesAQuadraticCurve) {
  Readout readout;
  readout.curve = {100, 25};  // 100 x + 25 x^2 = 300 at x = 2
  readout.trigger = 0.5;
  EXPECT_NEAR(nominalForce(readout, 300), 2.5, 2.5 * kRelative);
  readout.curve = {0, 1};
  EXPECT_NEAR(nominalForce(readout, 9), 3.5, 3.5 * kRelative);
}

TEST(NominalForce, ReturnsTheFirstRootOfCurvesWithMaximum) {
  Readout readout;
  readout.curve = {4, -1};  // maximum 4 at x = 2
  EXPECT_NEAR(nominalForce(readout, 3), 1, kRelative);
  EXPECT_NEAR(nominalForce(readout, 4), 2, 1e-6);                      // a double root has half the digits
  EXPECT_NEAR(nominalForce(readout, 5), 2, 1e-6);                      // above the maximum: the position of the maximum
  readout.curve = {9, -6, 1};                                          // x (x - 3)^2: maximum 4 at x = 1, minimum 0 at x = 3
  EXPECT_NEAR(nominalForce(readout, 2), 2 - std::sqrt(3), kRelative);  // (x - 2)(x^2 - 4 x + 1) = 0
  EXPECT_NEAR(nominalForce(readout, 20), 5, 5 * kRelative);
}

TEST(NominalForce, FollowsStraightPieces) {
  Readout readout;
  readout.curve_points = {{0.5, 800}, {1, 1900}, {2, 2000}};
  EXPECT_DOUBLE_EQ(nominalForce(readout, 400), 0.25);
  EXPECT_DOUBLE_EQ(nominalForce(readout, 800), 0.5);
  EXPECT_DOUBLE_EQ(nominalForce(readout, 1350), 0.75);
  EXPECT_DOUBLE_EQ(nominalForce(readout, 1900), 1);
  EXPECT_DOUBLE_EQ(nominalForce(readout, 1950), 1.5);
  EXPECT_DOUBLE_EQ(nominalForce(readout, 2500), 7) << "the last slope, 100 counts/N";
  readout.output_scale = 2;
  readout.trigger = 0.25;
  EXPECT_DOUBLE_EQ(nominalForce(readout, 2700), 1);
  EXPECT_EQ(nominalForce(readout, 0), 0);
  EXPECT_EQ(nominalForce(readout, -1), 0);
}

TEST(NominalForce, InvertsEveryRisingCurve) {
  EXPECT_TRUE(rc::check([] {
    Readout readout;
    readout.curve = {*rc::gen::inRange(1, 1000) * 1.0};
    const int degree = *rc::gen::inRange(1, 6);
    while (static_cast<int>(readout.curve.size()) < degree) readout.curve.push_back(*rc::gen::inRange(0, 1000) * 0.1);
    readout.output_scale = *rc::gen::inRange(1, 100) * 0.1;
    readout.trigger = *rc::gen::inRange(0, 100) * 0.01;
    const double x = *rc::gen::inRange(1, 10000) * 1e-3;
    const double counts = reference::analogueOutput(readout, readout.trigger + x, 1, readout.trigger, 0);
    RC_ASSERT(std::abs(nominalForce(readout, counts) - readout.trigger - x) <= kRelative * (x + readout.trigger));
  }));
}

TEST(NominalForce, RisesWithTheCounts) {
  Readout readout;
  readout.curve = {3000, -1200, 400};  // slope 3000 - 2400 x + 1200 x^2 > 0 everywhere
  double before = 0;
  for (int counts = 1; counts <= 4095; ++counts) {
    const double force = nominalForce(readout, counts);
    ASSERT_GT(force, before) << counts;
    before = force;
  }
}

TEST(CurveTop, IsTheFirstMaximum) {
  EXPECT_DOUBLE_EQ(curveTop(std::vector<double>{3000, -1000}, 2000), 1.5);
  EXPECT_EQ(curveTop(std::vector<double>{3000, -1000}, 2300), std::numeric_limits<double>::infinity()) << "below saturation";
  EXPECT_DOUBLE_EQ(curveTop(std::vector<double>{9, -6, 1}, 4), 1) << "not where it rises again";
  EXPECT_EQ(curveTop(std::vector<double>{3, -3, 1}, 1), std::numeric_limits<double>::infinity()) << "level at one point only";
  EXPECT_EQ(curveTop(std::vector<double>{2400}, 1), std::numeric_limits<double>::infinity());
}

TEST(CurveRises, DetectsFallingCurves) {
  const std::vector<double> hump{9, -6, 1};  // maximum 4 at x = 1, minimum 0 at x = 3
  EXPECT_TRUE(curveRises(hump, 0.99, 100));
  EXPECT_FALSE(curveRises(hump, 1.01, 100));
  EXPECT_FALSE(curveRises(hump, 5, 100));
  EXPECT_TRUE(curveRises(hump, 5, 3.9));  // reaches 3.9 before the maximum
  EXPECT_FALSE(curveRises(hump, 5, 4.1));
  EXPECT_FALSE(curveRises(std::vector<double>{0}, 1, 10));
  EXPECT_FALSE(curveRises(std::vector<double>{-1}, 1, 10));
  EXPECT_FALSE(curveRises(std::vector<double>{-1, 1}, 5, 10));
  EXPECT_TRUE(curveRises(std::vector<double>{0, 0, 1}, 1, 10));
  EXPECT_TRUE(curveRises(std::vector<double>{3, -3, 1}, 2, 10));  // (x - 1)^3 + 1: slope 0 at one point only
}

}  // namespace
}  // namespace taxelsim
