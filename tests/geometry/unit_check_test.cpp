#include "geometry/unit_check.h"

#include <gtest/gtest.h>

namespace taxelsim {
namespace {

TEST(ImplausibleSize, IsLongerThanAMetre) {
  EXPECT_EQ(implausibleSize({{0, 0, 0}, {1, 1, 1}}), "");
  EXPECT_EQ(implausibleSize({{-0.1, -17.3, -0.1}, {0.1, 17.3, 0.1}}), "is 34.6 m long");
  EXPECT_EQ(implausibleSize(boundsOf(Sphere{0.008})), "");
  EXPECT_EQ(implausibleSize(boundsOf(Sphere{8})), "is 16 m long");
  EXPECT_EQ(implausibleSize(boundsOf(HalfSpace{})), "") << "a half-space has no size";
}

}  // namespace
}  // namespace taxelsim
