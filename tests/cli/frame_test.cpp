// `frame`: values against closed forms, every output, and what is refused.
#include <gtest/gtest.h>

#include <cmath>
#include <nlohmann/json.hpp>
#include <numbers>

#include "cli/command_line.h"

namespace taxelsim::testing {
namespace {

const std::string kSensor = std::string(TAXELSIM_SOURCE_DIR) + "/scenes/sensors/wts0614.yaml";
constexpr double kStiffness = 1.73e8;  // N/m^3, scenes/sensors/wts0614.yaml

std::vector<std::string> frame(const std::string& object, const std::string& pose, std::vector<std::string> more = {}) {
  std::vector<std::string> command{"frame", "--sensor", kSensor, "--object", object, "--pose", pose};
  command.insert(command.end(), more.begin(), more.end());
  return command;
}

TEST(Frame, SphereOnAnElasticFoundation) {
  const Outcome outcome = runTaxelsim(frame("sphere:0.01", "0 0 0.009 1 0 0 0", {"--json"}));
  ASSERT_EQ(outcome.status, 0) << outcome.err;
  const nlohmann::json json = nlohmann::json::parse(outcome.out);
  // PHYSICS: F = pi k d^2 (R - d/3); a = 4.4 mm is 5 samples of 0.85 mm, of which the sum is within 1 % (measured worst over offsets).
  constexpr double kSamplingError = 0.01;
  const double force = std::numbers::pi * kStiffness * 1e-6 * (0.01 - 1e-3 / 3);
  EXPECT_NEAR(json["ground_truth"]["total_force"].get<double>(), force, kSamplingError * force);
  EXPECT_NEAR(json["ground_truth"]["contact_wrench"][2].get<double>(), -force, kSamplingError * force);
  EXPECT_NEAR(json["ground_truth"]["center_of_pressure"][0].get<double>(), 0, 1e-6);
  EXPECT_EQ(json["tactile_image"].size(), 6u);
  for (const char* key : {"total_force", "peak_force", "center_of_pressure", "second_moments", "eigenvalues", "edge_angle",
                          "edge_confidence", "contact_area"}) {
    EXPECT_TRUE(json.contains(key)) << key;
    EXPECT_TRUE(json["ground_truth"].contains(key)) << key;
  }
}

TEST(Frame, LoadIsCarried) {
  for (const char* object : {"sphere:0.01", "cylinder:0.008,0.04", "box:0.01,0.02,0.01", "half_space", "cone:0.01,0.005",
                             "torus:0.01,0.003", "capsule:0.005,0.02"}) {
    const Outcome outcome = runTaxelsim(frame(object, "0.001 0.002 0.05 1 0 0 0", {"--load", "1.5", "--json"}));
    ASSERT_EQ(outcome.status, 0) << object << ": " << outcome.err;
    const nlohmann::json json = nlohmann::json::parse(outcome.out);
    EXPECT_NEAR(json["ground_truth"]["total_force"].get<double>(), 1.5, 1.5e-3) << object;  // 0.1 %
  }
}

TEST(Frame, LoadOutOfReachIsRefused) {
  expectRefused(runTaxelsim(frame("sphere:0.01", "0 0 0.02 1 0 0 0", {"--load", "500"})), "load");
  expectRefused(runTaxelsim(frame("sphere:0.01", "0.5 0 0.02 1 0 0 0", {"--load", "1"})), "load");
}

TEST(Frame, PictureAndText) {
  const TemporaryDirectory root;
  const Outcome outcome = runTaxelsim(frame("cylinder:0.008,0.06", "0 0 0.0075 0.7071068 0.7071068 0 0", {"--png", root / "frame.png"}));
  ASSERT_EQ(outcome.status, 0) << outcome.err;
  EXPECT_TRUE(contentOf(root / "frame.png").starts_with("\x89PNG"));
  EXPECT_NE(outcome.out.find("edge_angle"), std::string::npos);
}

TEST(Frame, BadInputIsRefused) {
  expectRefused(runTaxelsim(frame("sphere:-1", "0 0 0 1 0 0 0")), "-1");
  expectRefused(runTaxelsim(frame("sphere:nan", "0 0 0 1 0 0 0")), "nan");
  expectRefused(runTaxelsim(frame("no_such_file.obj", "0 0 0 1 0 0 0")), "no_such_file.obj");
  expectRefused(runTaxelsim(frame("sphere:0.01", "0 0 0 2 0 0 0")), "quaternion");
  expectRefused(runTaxelsim(frame("sphere:0.01", "0 0 0")), "pose");
  expectRefused(runTaxelsim(frame("sphere:0.01", "0 0 nan 1 0 0 0")), "pose");
  expectRefused(runTaxelsim(frame("sphere:0.01", "0 0 0 1 0 0 0", {"--load", "-1"})), "load");
  expectRefused(runTaxelsim({"frame", "--sensor", "/nonexistent.yaml", "--object", "sphere:1", "--pose", "0 0 0 1 0 0 0"}),
                "/nonexistent.yaml");
}

}  // namespace
}  // namespace taxelsim::testing
