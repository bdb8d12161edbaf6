// Angles of lines: against std::remainder(), to the bit.
#include "control/line_angle.h"
#include "support/test.h"

namespace taxelsim {
namespace {

constexpr double kPi = std::numbers::pi;

double byRemainder(double angle) {
  const double wrapped = std::remainder(angle, kPi);
  return wrapped <= -kPi / 2 ? wrapped + kPi : wrapped;
}

void expectSameBits(double angle) {
  EXPECT_EQ(std::bit_cast<std::uint64_t>(wrapLineAngle(angle)), std::bit_cast<std::uint64_t>(byRemainder(angle))) << angle;
}

TEST(LineAngle, HasTheBitsOfTheRemainder) {
  std::mt19937_64 random(1);
  std::uniform_real_distribution<double> any(-20, 20), usual(-1.5 * kPi, 1.5 * kPi);
  for (int k = 0; k < 200000; ++k) {
    expectSameBits(any(random));
    expectSameBits(usual(random));
  }
}

TEST(LineAngle, HasTheBitsOfTheRemainderAtMultiplesOfAQuarterTurn) {
  for (int quarter = -12; quarter <= 12; ++quarter) {
    const double angle = quarter * (kPi / 2);
    for (const double direction : {-std::numeric_limits<double>::infinity(), std::numeric_limits<double>::infinity()}) {
      double near = angle;
      for (int ulps = 0; ulps < 4; ++ulps, near = std::nextafter(near, direction)) expectSameBits(near);
    }
  }
  for (const double angle : {4.7, -4.7, -0.0}) expectSameBits(angle);
}

TEST(LineAngle, OfNotANumberIsNotANumber) {
  EXPECT_TRUE(std::isnan(wrapLineAngle(std::numeric_limits<double>::quiet_NaN())));
}

}  // namespace
}  // namespace taxelsim
