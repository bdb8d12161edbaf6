// Edge angles over time, as a curve without jumps.
#include "figures/episode_view.h"

#include "support/test.h"

namespace taxelsim::figures {
namespace {

using ::testing::DoubleNear;
using ::testing::Pointwise;

constexpr double kRounding = 1e-10;  // degrees
constexpr double kDegree = std::numbers::pi / 180;
constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();

TEST(ContinuousAngles, DoNotJumpByHalfATurn) {
  for (const auto& [recorded, expected] : std::vector<std::pair<std::vector<double>, std::vector<double>>>{
           {{80, 89, -82, -70}, {80, 89, 98, 110}},
           {{-70, -80, 89, 60}, {110, 100, 89, 60}},
           {{-5, 3, -2}, {-5, 3, -2}},
           {{-80, -85}, {100, 95}},
       }) {
    std::vector<double> angles;
    for (const double angle : recorded) angles.push_back(angle * kDegree);
    EXPECT_THAT(continuousAngles(angles), Pointwise(DoubleNear(kRounding), expected));
  }
}

TEST(ContinuousAngles, KeepGaps) {
  const std::vector<double> found = continuousAngles({kNaN, 89 * kDegree, kNaN, -89 * kDegree});
  EXPECT_TRUE(std::isnan(found[0]) && std::isnan(found[2]));
  EXPECT_NEAR(found[3] - found[1], 2, kRounding) << "across the gap";
  EXPECT_TRUE(std::isnan(continuousAngles({kNaN})[0]));
}

}  // namespace
}  // namespace taxelsim::figures
