// What is said of depth sampling: objects that points may miss, and laws without area sampling.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <regex>

#include "simulation/comparison.h"
#include "simulation/input_error.h"
#include "simulation/small_objects.h"
#include "support/random_scene.h"

namespace taxelsim {
namespace {

Sensor sensorWith(DepthSampling sampling) {
  Sensor sensor = support::gridSensor({.thickness = 2e-3});
  sensor.depth_sampling = sampling;
  return sensor;
}

// One line per object that points may miss, with what would see it.
TEST(SmallObjects, AreWarnedOfWithPoints) {
  const std::vector<Object> objects{Object("pin", Cylinder{0.5e-3, 12e-3}), Object("hair", Cylinder{0.05e-3, 12e-3}),
                                    Object("plate", Box{{20e-3, 10e-3, 1e-3}}), Object(Sphere{2e-3})};
  const auto warnings = [&](const Sensor& sensor) {
    testing::internal::CaptureStderr();
    warnOfSmallObjects(sensor, objects);
    static const std::regex kTime(R"(\[[-0-9]+ [:.0-9]+\] )");
    return std::regex_replace(testing::internal::GetCapturedStderr(), kTime, "");
  };
  Sensor sensor = sensorWith(DepthSampling::kPoint);
  const std::string points = warnings(sensor);
  EXPECT_THAT(points,
              testing::HasSubstr("object pin is 1 mm wide, samples are 0.85 mm apart: its force depends on where it lies between them; "
                                 "depth_sampling: area counts all of it, samples_per_taxel: 14 sees it"));
  EXPECT_THAT(points, testing::HasSubstr("object hair is 0.1 mm wide"));
  EXPECT_THAT(points, testing::HasSubstr(
                          "object plate is 1 mm wide, samples are 0.85 mm apart: where it touches with an edge, its force depends on"));
  EXPECT_EQ(std::count(points.begin(), points.end(), '\n'), 3);
  EXPECT_EQ(warnings(sensorWith(DepthSampling::kArea)), "");
  sensor.skin.law = ElasticLayer{.elastic_modulus = 1e6};
  EXPECT_EQ(warnings(sensor), points);
  sensor.skin.law = Pasternak{.normal_contact_stiffness = 5e8, .shear_stiffness = 218};
  EXPECT_THAT(warnings(sensor), testing::HasSubstr("pasternak cannot see it"));
}

}  // namespace
}  // namespace taxelsim
