// `frame`: values against closed forms, outputs, and refusals.
#include <charconv>
#include <nlohmann/json.hpp>

#include "cli/command_line.h"
#include "support/test.h"

namespace taxelsim::testing {
namespace {

using ::testing::HasSubstr;
using ::testing::Not;

const std::string kSensor = std::string(TAXELSIM_SOURCE_DIR) + "/scenes/sensors/wts0614_soft_cover.yaml";
constexpr double kStiffness = 1.73e8;  // N/m^3, scenes/sensors/wts0614_soft_cover.yaml

std::vector<std::string> frame(const std::string& object, const std::string& pose, std::vector<std::string> more = {}) {
  std::vector<std::string> command{"frame", "--sensor", kSensor, "--object", object, "--pose", pose};
  command.insert(command.end(), more.begin(), more.end());
  return command;
}

TEST(Frame, SphereOnAnElasticFoundation) {
  const nlohmann::json json = jsonOf(frame("sphere:0.01", "0 0 0.009 1 0 0 0", {"--json"}));
  // F = pi k d^2 (R - d/3); a = 4.4 mm is 5 samples of 0.85 mm, of which the sum is within 1 % (measured worst over offsets).
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

// An angle of a right angle is 1.5707964 in float32, of which double arithmetic shows more digits.
TEST(Frame, NumbersOfJsonAreTheShortestOfAFloat) {
  const Outcome outcome = succeed(frame("cylinder:0.004,0.1", "0.0013 0.002 0.0034 0.70710678 0.70710678 0 0", {"--json"}));
  int num_fractions = 0;
  for (std::size_t at = outcome.out.find_first_of("0123456789"); at != std::string::npos;
       at = outcome.out.find_first_of("0123456789", at)) {
    const std::size_t end = outcome.out.find_first_not_of("0123456789.e+-", at);
    const std::string text = outcome.out.substr(at, end - at);
    at = end;
    if (text.find('.') == std::string::npos) continue;
    float value = 0;
    std::from_chars(text.data(), text.data() + text.size(), value);
    std::array<char, 32> shortest;
    const auto digits = [](std::string_view number) {
      number = number.substr(0, number.find('e'));
      std::string all;
      std::copy_if(number.begin(), number.end(), std::back_inserter(all), [](char c) { return c != '.'; });
      all.erase(0, std::min(all.find_first_not_of('0'), all.size()));
      all.erase(all.find_last_not_of('0') + 1);
      return all;
    };
    const char* const last = std::to_chars(shortest.data(), shortest.data() + shortest.size(), value).ptr;
    EXPECT_EQ(digits(text).size(), digits({shortest.data(), last}).size()) << text;
    ++num_fractions;
  }
  EXPECT_GT(num_fractions, 100);
}

TEST(Frame, ContactsAreToldApart) {
  std::vector<std::string> command = frame("cylinder:0.004,0.008", "0.002 -0.015 0.0034 0.70710678 0 0.70710678 0", {"--json"});
  command.insert(command.end(), {"--object", "sphere:0.006", "--pose", "-0.001 0.014 0.0055 1 0 0 0"});
  const nlohmann::json json = jsonOf(command);
  for (const nlohmann::json& contact : {json["contact"], json["ground_truth"]["contact"]}) {
    EXPECT_EQ(contact["num_regions"], 2);
    ASSERT_EQ(contact["regions"].size(), 2u);
    EXPECT_EQ(contact["patches"][0], contact["sensor"]);
    EXPECT_LT(contact["regions"][0]["center_of_pressure"][1], -0.014);
    EXPECT_GT(contact["regions"][1]["center_of_pressure"][1], 0.013);
    EXPECT_EQ(contact["regions"][1]["contact_type"], "point");
    EXPECT_EQ(contact["regions"][1]["patch"], 0);
    EXPECT_TRUE(contact["regions"][0].contains("windowed_edge_confidence"));
  }
  constexpr double kSum = 1e-6;  // the same forces, summed in another order
  EXPECT_NEAR(json["contact"]["sensor"]["total_force"].get<double>() / json["total_force"].get<double>(), 1, kSum);
}

TEST(Frame, ATiltedFaceIsSeen) {
  // At the border the spread keeps the sum of forces: it gives more to the neighbours that exist, so taxels in the second row read up to
  // 1.3 % too much in either direction.
  constexpr double kAngle = 0.01, kSlack = 2.6e-2 * kAngle;  // rad
  const double half = kAngle / 2;
  const std::string pose = "0 0 -0.0007 1 " + std::to_string(half) + " 0 0";
  const nlohmann::json contact = jsonOf(frame("half_space", pose, {"--json"}))["ground_truth"]["contact"];
  EXPECT_NEAR(contact["sensor"]["tilt"][0].get<double>(), kAngle, kSlack);
  EXPECT_NEAR(contact["sensor"]["tilt"][1].get<double>(), 0, kSlack);
  EXPECT_GT(contact["sensor"]["tilt_confidence"].get<double>(), 0.95);
}

TEST(Frame, LoadIsCarried) {
  for (const char* object : {"sphere:0.01", "cylinder:0.008,0.04", "box:0.01,0.02,0.01", "half_space", "cone:0.01,0.005",
                             "torus:0.01,0.003", "capsule:0.005,0.02"}) {
    const nlohmann::json json = jsonOf(frame(object, "0.001 0.002 0.05 1 0 0 0", {"--load", "1.5", "--json"}));
    EXPECT_NEAR(json["ground_truth"]["total_force"].get<double>(), 1.5, 1.5e-3) << object;  // 0.1 %
  }
}

TEST(Frame, LoadOutOfReachIsRefused) {
  expectRefused(runTaxelsim(frame("sphere:0.01", "0 0 0.02 1 0 0 0", {"--load", "500"})), "load");
  expectRefused(runTaxelsim(frame("sphere:0.01", "0.5 0 0.02 1 0 0 0", {"--load", "1"})), "load");
}

// The same frame as with a quaternion; sine and cosine differ from its digits by rounding.
TEST(Frame, RollPitchYawIsARotation) {
  const auto angle = [](const std::vector<std::string>& more) {
    std::vector<std::string> command{"frame", "--sensor", kSensor, "--object", "cylinder:0.008,0.06", "--json", "--pose"};
    command.insert(command.end(), more.begin(), more.end());
    const Outcome outcome = succeed(command);
    return nlohmann::json::parse(outcome.out)["ground_truth"]["edge_angle"].get<double>();
  };
  // Roll lays the cylinder along y, then yaw turns it by 30 degrees: its axis is at 90 + 30 degrees from x.
  EXPECT_NEAR(angle({"0 0 0.0075", "--rpy-deg", "90 0 30"}), angle({"0 0 0.0075 0.6830127 0.6830127 0.1830127 0.1830127"}), 1e-5);
  EXPECT_NEAR(angle({"0 0 0.0075", "--rpy-deg", "90,0,30"}), -std::numbers::pi / 3, 0.1) << "a coarse image of the axis";
}

TEST(Frame, WithALoadThePoseHasADefault) {
  const Outcome given = runTaxelsim(frame("sphere:0.01", "0 0 0.01", {"--load", "2", "--json"}));
  const Outcome omitted = succeed({"frame", "--sensor", kSensor, "--object", "sphere:0.01", "--load", "2", "--json"});
  EXPECT_EQ(omitted.out, given.out);
  const Outcome turned =
      succeed({"frame", "--sensor", kSensor, "--object", "cylinder:0.004,0.02", "--rpy-deg", "90 0 0", "--load", "2", "--json"});
  EXPECT_NEAR(nlohmann::json::parse(turned.out)["ground_truth"]["total_force"].get<double>(), 2, 2e-3);
}

// A cube of 20 units whose lowest face is its -y: read in millimetres with y up, it is a box of 20 mm.
class FrameOfACubeInMillimetres : public ::testing::Test {
 protected:
  FrameOfACubeInMillimetres() {
    std::ofstream(file_) << "v -10 0 -10\nv 10 0 -10\nv 10 0 10\nv -10 0 10\nv -10 20 -10\nv 10 20 -10\nv 10 20 10\nv -10 20 10\n"
                            "f 1 2 3 4\nf 5 8 7 6\nf 1 5 6 2\nf 2 6 7 3\nf 3 7 8 4\nf 4 8 5 1\n";
  }
  TemporaryDirectory root_;
  std::string file_ = root_ / "cube.obj";
};

TEST_F(FrameOfACubeInMillimetres, IsScaledAndTurned) {
  const Outcome mesh = succeed(frame(file_, "0 0 -0.0005", {"--scale", "0.001", "--up-axis", "y", "--json"}));
  EXPECT_EQ(mesh.err, "");
  const Outcome box = runTaxelsim(frame("box:0.02,0.02,0.02", "0 0 0.0095", {"--json"}));
  const auto truth = [](const Outcome& outcome) { return nlohmann::json::parse(outcome.out)["ground_truth"]; };
  EXPECT_NEAR(truth(mesh)["total_force"].get<double>(), truth(box)["total_force"].get<double>(), 1e-3);
}

TEST_F(FrameOfACubeInMillimetres, IsWarnedAboutWithoutAScale) {
  const Outcome outcome = succeed(frame(file_, "0 0 0"));
  EXPECT_THAT(outcome.err, HasSubstr("warning: " + file_ + ": the mesh is 20 m long; is the file in millimetres? scale: 0.001\n"));
  expectRefused(runTaxelsim(frame(file_, "0 0 0", {"--scale", "0"})), "scale: 0 is not allowed");
  expectRefused(runTaxelsim(frame(file_, "0 0 0", {"--up-axis", "w"})), "--up-axis");
  expectRefused(runTaxelsim(frame("sphere:0.01", "0 0 0", {"--scale", "0.001"})), "--scale and --up-axis belong to mesh files");
}

TEST(Frame, SizesInMillimetresAreWarnedAbout) {
  const Outcome outcome = succeed(frame("sphere:3", "0 0 2.999"));
  EXPECT_THAT(outcome.err, HasSubstr("object 'sphere:3' is 6 m long; are its sizes in millimetres?"));
  const TemporaryDirectory root;
  std::string text = contentOf(kSensor);
  text.replace(text.find("pitch_mm: 3.4"), 13, "pitch: 3.4   ");
  std::ofstream(root / "s.yaml") << text;
  const Outcome pitch = succeed({"frame", "--sensor", root / "s.yaml", "--object", "sphere:0.01", "--pose", "0 0 0.0095"});
  EXPECT_THAT(pitch.err, HasSubstr(":9:8: pitch: 3.4 m between taxels; is it in millimetres? pitch_mm"));
}

TEST(Frame, WarnsOfOverPenetration) {
  const Outcome deep = succeed(frame("sphere:0.01", "0 0 0.005"));
  EXPECT_THAT(deep.err, HasSubstr("warning: over-penetration: "));
  EXPECT_THAT(deep.err, HasSubstr("deeper than the skin is thick (2 mm)"));
  EXPECT_EQ(runTaxelsim(frame("sphere:0.01", "0 0 0.0095")).err, "");
}

// The windowed edge angle of this image is float32 -pi/2, which is below -pi/2.
TEST(Frame, AnglesOfAxesAreShownAboveMinusARightAngle) {
  const Outcome outcome = succeed(frame("half_space", "0 0 -0.0005"));
  EXPECT_THAT(outcome.out, HasSubstr("edge_angle               rad     1.5708 "));
  EXPECT_THAT(outcome.out, Not(HasSubstr("-1.5708")));
}

TEST(Frame, PictureAndText) {
  const TemporaryDirectory root;
  const Outcome outcome = succeed(frame("cylinder:0.008,0.06", "0 0 0.0075 0.7071068 0.7071068 0 0", {"--png", root / "frame.png"}));
  EXPECT_TRUE(contentOf(root / "frame.png").starts_with("\x89PNG"));
  EXPECT_EQ(outcome.err, "info: wrote " + (root / "frame.png").string() + "\n");
  EXPECT_THAT(outcome.out, HasSubstr("edge_angle"));
}

class FrameOfContacts : public ::testing::Test {
 protected:
  Outcome run(const std::string& content, std::vector<std::string> more = {}) const {
    std::ofstream(file_) << content;
    std::vector<std::string> command{"frame", "--sensor", kSensor, "--contacts", file_};
    command.insert(command.end(), more.begin(), more.end());
    return runTaxelsim(command);
  }
  TemporaryDirectory root_;
  std::string file_ = root_ / "contacts.csv";
};

TEST_F(FrameOfContacts, ForcesGoToTheirTaxels) {
  const Outcome outcome =
      run("# x, y, z, normal force\n0.0017,0.0017,0,1.25\n\n 0.0017 , -0.0017 , -1e-4 , 0.25\r\n1,0,0,3 # outside the array",
          {"--json", "--png", root_ / "frame.png"});
  ASSERT_EQ(outcome.status, 0) << outcome.err;
  const nlohmann::json truth = nlohmann::json::parse(outcome.out)["ground_truth"];
  EXPECT_NEAR(truth["total_force"].get<double>(), 1.5, 1e-6);
  EXPECT_NEAR(truth["contact_wrench"][2].get<double>(), -1.5, 1e-6);
  EXPECT_EQ(truth["off_array_load"], 3);
  EXPECT_EQ(truth["off_array_contacts"], 1);
  EXPECT_FALSE(truth.contains("penetration_depth"));
  EXPECT_TRUE(contentOf(root_ / "frame.png").starts_with("\x89PNG"));
}

TEST_F(FrameOfContacts, EmptyFileIsNoContact) {
  const Outcome outcome = run("# none\n", {"--json"});
  ASSERT_EQ(outcome.status, 0) << outcome.err;
  EXPECT_EQ(nlohmann::json::parse(outcome.out)["total_force"], 0);
}

TEST_F(FrameOfContacts, RejectsBadFilesByLine) {
  for (const std::string line : {"0,0,0", "0,0,0,1,2", "0 0 0 1", "x,y,z,normal_force", "0,0,0,", "0,0,0,1x", "0,0,0,-1", "0,0,0,nan",
                                 "0,inf,0,1", "0,0,1e9,1", "0,0,0,1e300", "0,0,0,1e999"}) {
    const Outcome outcome = run("0,0,0,1\n\n" + line + "\n");
    expectRefused(outcome, file_ + ":3:");
  }
  std::string many;
  for (int n = 0; n <= 4096; ++n) many += "0,0,0,1\n";
  expectRefused(run(many), "4096");
  expectRefused(run(std::string(std::size_t{2} << 20, ' ')), "2097152 bytes are too many: at most 1048576");
  expectRefused(runTaxelsim({"frame", "--sensor", kSensor, "--contacts", root_ / "missing.csv"}), "missing.csv");
  expectRefused(runTaxelsim({"frame", "--sensor", kSensor, "--contacts", root_ / ""}), "a directory, not a file");
  expectRefused(run("0,0,0,1\n", {"--object", "sphere:0.01", "--pose", "0 0 0 1 0 0 0"}),
                "--contacts excludes --object, --pose, --rpy-deg, --load, --slide, --scale and --up-axis");
  expectRefused(run("0,0,0,1\n", {"--load", "1"}), "--contacts excludes --object");
}

TEST_F(FrameOfContacts, TextOfAFileDoesNotControlTheTerminal) {
  const Outcome outcome =
      run("\x1b[2J\xc2\x9b"
          "31m,0,0,1\n");
  expectRefused(outcome, "\\x1b[2J\\xc2\\x9b31m");
  EXPECT_EQ(outcome.err.find_first_of("\x1b\x9b"), std::string::npos) << outcome.err;
  const Outcome path = runTaxelsim({"frame", "--sensor", kSensor, "--contacts", "/no/\x1b[2J" + std::string(1000, 'a')});
  expectRefused(path, "\\x1b[2Jaaa");
  EXPECT_EQ(path.err.size(), std::string("taxelsim: ").size() + 400 + 1) << path.err;
}

TEST(Frame, BadInputIsRefused) {
  expectRefused(runTaxelsim({"frame", "--sensor", kSensor}), "--contacts");
  expectRefused(runTaxelsim(frame("sphere:-1", "0 0 0 1 0 0 0")), "-1");
  expectRefused(runTaxelsim(frame("sphere:nan", "0 0 0 1 0 0 0")), "nan");
  expectRefused(runTaxelsim(frame("no_such_file.obj", "0 0 0 1 0 0 0")), "no_such_file.obj");
  expectRefused(runTaxelsim(frame("sphere:0.01", "0 0 0 2 0 0 0")), "quaternion");
  expectRefused(runTaxelsim(frame("sphere:0.01", "0 0 nan 1 0 0 0")), "pose");
  expectRefused(runTaxelsim(frame("sphere:0.01", "0 0 0 1 0 0 0", {"--load", "-1"})), "load");
  expectRefused(runTaxelsim({"frame", "--sensor", "/nonexistent.yaml", "--object", "sphere:1", "--pose", "0 0 0 1 0 0 0"}),
                "/nonexistent.yaml");
}

}  // namespace
}  // namespace taxelsim::testing
