// Sine and cosine that a device computes with the same bits.
#include "base/sin_cos.h"
#include "support/test.h"

namespace taxelsim {
namespace {

// Units in the last place between a value and the C library's.
double ulps(double value, double expected) {
  const double next = std::nextafter(std::abs(expected), std::numeric_limits<double>::infinity());
  return std::abs(value - expected) / (next - std::abs(expected));
}

void expectClose(double angle) {
  constexpr double kLimit = 2;  // 1 of sinCos() and 1 of the library
  const auto [sine, cosine] = sinCos(angle);
  EXPECT_LE(ulps(sine, std::sin(angle)), kLimit) << angle;
  EXPECT_LE(ulps(cosine, std::cos(angle)), kLimit) << angle;
}

TEST(SinCos, AgreesWithTheLibrary) {
  std::mt19937_64 random(1);
  for (const double range : {1e-9, 1e-3, 1.0, 4.0, 100.0, 1e4, kLargestReducedAngle}) {
    std::uniform_real_distribution<double> angles(-range, range);
    for (int k = 0; k < 100'000; ++k) expectClose(angles(random));
  }
}

// The results near 0 keep their relative accuracy.
TEST(SinCos, AgreesAtMultiplesOfAQuarterTurn) {
  for (int n = -1000; n <= 1000; ++n) {
    const double angle = n * (std::numbers::pi / 2);
    for (const double near : {std::nextafter(angle, -1e9), angle, std::nextafter(angle, 1e9)}) expectClose(near);
  }
}

TEST(SinCos, HasTheSpecialValuesOfTheLibrary) {
  EXPECT_EQ(sinCos(0.0).sine, 0.0);
  EXPECT_EQ(sinCos(0.0).cosine, 1.0);
  for (const double angle : {1e7, 1e300}) {
    EXPECT_EQ(sinCos(angle).sine, std::sin(angle));
    EXPECT_EQ(sinCos(angle).cosine, std::cos(angle));
  }
  EXPECT_TRUE(std::isnan(sinCos(std::numeric_limits<double>::infinity()).sine));
  EXPECT_TRUE(std::isnan(sinCos(std::numeric_limits<double>::quiet_NaN()).cosine));
}

}  // namespace
}  // namespace taxelsim
