// `frame` with sensors of three-axis taxels, and --slide.
#include <nlohmann/json.hpp>

#include "cli/command_line.h"
#include "cli/picture.h"
#include "support/test.h"

namespace taxelsim::testing {
namespace {

constexpr unsigned kRed = 0xe5322d;  // of arrows and outlines
const std::string kSensors = std::string(TAXELSIM_SOURCE_DIR) + "/scenes/sensors/";

class ThreeAxisFrame : public ::testing::Test {
 protected:
  // The shipped sensor without noise and hysteresis: its counts are the rounded product of the gain matrix and the force.
  ThreeAxisFrame() {
    std::string text = contentOf(kSensors + "uskin_like_4x4.yaml");
    for (const char* const error : {"noise: [3, 3, 3]", "hysteresis_strength: [0.3, 0.3, 0.3]"}) {
      const std::size_t at = text.find(error);
      if (at == std::string::npos) throw std::logic_error(error);
      text.insert(at, "# ");
    }
    std::ofstream(sensor_) << text;
  }

  Outcome run(const std::string& object, std::vector<std::string> more) const {
    std::vector<std::string> command{"frame", "--sensor", sensor_, "--object", object};
    command.insert(command.end(), more.begin(), more.end());
    return runTaxelsim(command);
  }

  TemporaryDirectory root_;
  std::string sensor_ = root_ / "sensor.yaml";
};

TEST_F(ThreeAxisFrame, CountsAreTheGainMatrixTimesTheForce) {
  const Outcome outcome = run("sphere:0.012", {"--load", "2", "--slide", "0.0008 -0.0004", "--json"});
  ASSERT_EQ(outcome.status, 0) << outcome.err;
  const nlohmann::json json = nlohmann::json::parse(outcome.out), truth = json["ground_truth"];
  constexpr double kGain = 1000, kCrossTalk = 50;  // counts/N, of the sensor file
  constexpr double kRounding = 0.5 + 2e-3;         // counts; the forces are float32, 1e-7 of 1 N
  ASSERT_EQ(json["taxel_counts"].size(), 4u);
  double least = 0, most = 0;
  for (std::size_t i = 0; i < 4; ++i) {
    ASSERT_EQ(json["taxel_counts"][i].size(), 4u);
    for (std::size_t j = 0; j < 4; ++j) {
      const nlohmann::json shear = truth["tactile_shear_force"][i][j], counts = json["taxel_counts"][i][j];
      const std::array<double, 3> force{shear[0], shear[1], truth["tactile_normal_force"][i][j]};
      for (std::size_t axis = 0; axis < 3; ++axis) {
        const double expected = kGain * force[axis] + kCrossTalk * (force[0] + force[1] + force[2] - force[axis]);
        EXPECT_NEAR(counts[axis].get<double>(), expected, kRounding) << i << ", " << j << ", axis " << axis;
      }
      most = std::max(most, force[0]);
      least = std::min(least, force[1]);
    }
  }
  EXPECT_GT(most, 0.05) << "N: the sphere slides along +x";
  EXPECT_LT(least, -0.05) << "and along -y";
}

// A plate that presses on the whole pad and slides by less than where it slips stretches all tangential springs alike.
TEST_F(ThreeAxisFrame, ASlideStretchesTheTangentialSprings) {
  constexpr double kStiffness = 1.5e7, kArea = 16 * 4.7e-3 * 4.7e-3, kSlide = 2e-4;  // N/m^3 and m^2 of the sensor file, m
  constexpr double kFloat = 1e-4;  // relative: ten steps of float32, 2e-4 m of float32 poses
  for (const auto& [slide, along_x, along_y] : {std::tuple{"0.0002 0", 1, 0}, {"0 -0.0002", 0, -1}}) {
    const Outcome outcome = run("half_space", {"--pose", "0 0 -0.0002", "--slide", slide, "--json"});
    ASSERT_EQ(outcome.status, 0) << outcome.err;
    const nlohmann::json wrench = nlohmann::json::parse(outcome.out)["ground_truth"]["contact_wrench"];
    const double force = kStiffness * kArea * kSlide;
    EXPECT_NEAR(wrench[0].get<double>(), along_x * force, kFloat * force) << slide;
    EXPECT_NEAR(wrench[1].get<double>(), along_y * force, kFloat * force) << slide;
  }
}

TEST_F(ThreeAxisFrame, TextAndPictureShowTheAxes) {
  const std::string still = root_ / "still.png", slid = root_ / "slid.png";
  const std::vector<std::string> press{"--load", "2", "--png", still};
  ASSERT_EQ(run("sphere:0.012", press).status, 0);
  const Outcome outcome = run("sphere:0.012", {"--load", "2", "--slide", "0.001 0", "--png", slid});
  ASSERT_EQ(outcome.status, 0) << outcome.err;
  std::size_t at = 0;
  for (const char* const part : {"tactile_image", "taxel_counts along x", "taxel_counts along y", "taxel_counts along the normal"}) {
    at = outcome.out.find(part, at);
    EXPECT_NE(at, std::string::npos) << part;
  }
  // The panel on the right has no outline: its red pixels are arrows. Those of cross-talk alone are a fifth of a taxel long.
  const Picture before(still), after(slid);
  EXPECT_GT(after.of(kRed).count, before.of(kRed).count + 500);
}

TEST(FrameSlide, RefusesWhatIsNoSlide) {
  const std::vector<std::string> press{"frame", "--sensor", kSensors + "uskin_like_4x4.yaml", "--object", "sphere:0.01", "--load", "1"};
  for (const char* const slide : {"0.001", "0.001 0 0", "0.001 x", "nan 0"}) {
    std::vector<std::string> command = press;
    command.insert(command.end(), {"--slide", slide});
    expectRefused(runTaxelsim(command), "it is \"x y\", m in the sensor frame");
  }
}

TEST(FrameSlide, ASkinWithoutFrictionHasNoShear) {
  const nlohmann::json json = jsonOf({"frame", "--sensor", kSensors + "wts0614_soft_cover.yaml", "--object", "sphere:0.01", "--load", "1",
                                      "--slide", "0.001 0", "--json"});
  EXPECT_FALSE(json.contains("taxel_counts"));
  EXPECT_EQ(json["ground_truth"]["contact_wrench"][0].get<double>(), 0);
  EXPECT_NEAR(json["ground_truth"]["center_of_pressure"][0].get<double>(), 1e-3, 1e-4) << "m: the sphere has moved";
}

}  // namespace
}  // namespace taxelsim::testing
