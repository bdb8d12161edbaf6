#include "geometry/unit_check.h"
#include "support/test.h"

namespace taxelsim {
namespace {

TEST(ImplausibleSize, IsNotThatOfAnObjectForAHand) {
  const auto question = [](const Bounds& bounds) { return implausibleSize(bounds, "mm?", "twice?"); };
  EXPECT_EQ(question({{0, 0, 0}, {0.7, 0.7, 0.7}}), "");
  EXPECT_EQ(question({{0, 0, 0}, {0.01, 0.84, 0.01}}), "is 0.84 m long; mm?");
  EXPECT_EQ(question({{-0.1, -17.3, -0.1}, {0.1, 17.3, 0.1}}), "is 34.6 m long; mm?");
  EXPECT_EQ(question(boundsOf(Sphere{0.008})), "");
  EXPECT_EQ(question(boundsOf(Sphere{8})), "is 16 m long; mm?");
  EXPECT_EQ(question(boundsOf(Box{{1e-4, 1e-6, 1e-6}})), "");
  EXPECT_EQ(question(boundsOf(Sphere{1.35e-6})), "is 2.7e-06 m long; twice?");
  EXPECT_EQ(question(boundsOf(HalfSpace{})), "") << "a half-space has no size";
  EXPECT_EQ(question({}), "") << "an empty mesh has none either";
}

}  // namespace
}  // namespace taxelsim
