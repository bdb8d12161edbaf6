// What is said of depth sampling: objects that points may miss, and laws without area sampling.
#include "simulation/comparison.h"
#include "simulation/small_objects.h"
#include "support/input_error.h"
#include "support/random_scene.h"
#include "support/test.h"
#include "taxelsim/log.h"

namespace taxelsim {
namespace {

Sensor sensorWith(DepthSampling sampling) {
  Sensor sensor = support::gridSensor({.thickness = 2e-3});
  sensor.depth_sampling = sampling;
  return sensor;
}

// What is logged of `object` under `name`, a new one: each line is logged once.
std::string warningOf(const Sensor& sensor, const std::string& name, const Shape& shape) {
  std::string lines;
  setLogSink([&](LogLevel, std::string_view line) { lines += line; });
  const std::vector<Object> objects{Object(name, shape)};
  warnOfSmallObjects(sensor, objects);
  setLogSink({});
  return lines;
}

// One line per object that points may miss, with what would see it.
TEST(SmallObjects, AreWarnedOfWithPoints) {
  Sensor sensor = sensorWith(DepthSampling::kPoint);
  EXPECT_EQ(warningOf(sensor, "pin", Cylinder{0.5e-3, 12e-3}),
            "object pin is 1 mm wide, samples are 0.85 mm apart: its force depends on where it lies between them; "
            "depth_sampling: area counts all of it, samples_per_taxel: 14 sees it");
  EXPECT_EQ(warningOf(sensor, "pin", Cylinder{0.5e-3, 12e-3}), "");  // once
  EXPECT_THAT(warningOf(sensor, "hair", Cylinder{0.05e-3, 12e-3}), testing::HasSubstr("object hair is 0.1 mm wide"));
  EXPECT_THAT(
      warningOf(sensor, "plate", Box{{20e-3, 10e-3, 1e-3}}),
      testing::HasSubstr("object plate is 1 mm wide, samples are 0.85 mm apart: where it touches with an edge, its force depends on"));
  EXPECT_EQ(warningOf(sensor, "ball", Sphere{2e-3}), "");
  EXPECT_EQ(warningOf(sensor, "long wire", Cylinder{0.5e-3, 120e-3}), "");
  EXPECT_THAT(warningOf(sensor, "thin wire", Cylinder{0.3e-3, 120e-3}), testing::HasSubstr("object thin wire is 0.6 mm wide"));
  EXPECT_EQ(warningOf(sensorWith(DepthSampling::kArea), "covered pin", Cylinder{0.5e-3, 12e-3}), "");
  sensor.skin.law = ElasticLayer{.elastic_modulus = 1e6};
  EXPECT_THAT(warningOf(sensor, "pin on a layer", Cylinder{0.5e-3, 12e-3}), testing::HasSubstr("samples are 0.85 mm apart"));
}

}  // namespace
}  // namespace taxelsim
