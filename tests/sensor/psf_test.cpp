

#include "support/test.h"
#include "taxelsim/error.h"
#include "taxelsim/sensor.h"

namespace taxelsim {
namespace {

double sum(const Psf& psf) {
  return std::accumulate(psf.kernel.begin(), psf.kernel.end(), 0.0);
}

// The sums are known to six decimals.
constexpr double kDecimals = 0.6e-6;

TEST(GaussianPsf, IsThePapersSampledKernel) {
  const Psf psf = gaussianPsf(0.5, 3, Psf::Normalization::kNone);
  ASSERT_EQ(psf.kernel.size(), 9u);
  // Middle 1/(2 pi 0.25); sides and corners are e^-2 and e^-4 times that.
  EXPECT_NEAR(psf.kernel[4], 0.636620, kDecimals);
  EXPECT_NEAR(psf.kernel[1], 0.636620 * std::exp(-2), kDecimals);
  EXPECT_NEAR(psf.kernel[0], 0.636620 * std::exp(-4), kDecimals);
  EXPECT_NEAR(sum(psf), 1.02789, 0.5e-5);  // the value in the paper, rounded to five decimals
  // Normalized weights in one dimension: 0.1065069789, 0.7869860422.
  const double row = (psf.kernel[3] + psf.kernel[4] + psf.kernel[5]) / sum(psf);
  EXPECT_NEAR(row, 0.7869860422, 1e-10);
}

TEST(GaussianPsf, SumsForOtherWidths) {
  const std::pair<double, double> known[] = {{0.3, 1.795840}, {0.4, 1.177219}, {0.6, 0.993001},
                                             {0.7, 0.961907}, {0.8, 0.912599}, {1.0, 0.779484}};
  for (const auto& [sigma, expected] : known) EXPECT_NEAR(sum(gaussianPsf(sigma, 3)), expected, kDecimals) << sigma;
}

TEST(GaussianPsf, IsSymmetric) {
  const Psf psf = gaussianPsf(0.8, 5);
  for (std::size_t a = 0; a < 5; ++a) {
    for (std::size_t b = 0; b < 5; ++b) {
      EXPECT_EQ(psf.kernel[a * 5 + b], psf.kernel[b * 5 + a]);
      EXPECT_EQ(psf.kernel[a * 5 + b], psf.kernel[(4 - a) * 5 + b]);
    }
  }
}

TEST(GaussianPsf, RejectsValuesOutOfRange) {
  constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
  for (const double sigma : {0.0, -0.5, kNan, std::numeric_limits<double>::infinity(), 1e-200, 1e200}) {
    EXPECT_THROW(gaussianPsf(sigma, 3), Error) << sigma;
  }
  for (const int size : {-1, 0, 2, 4, 10, 11}) EXPECT_THROW(gaussianPsf(0.5, size), Error) << size;
}

}  // namespace
}  // namespace taxelsim
