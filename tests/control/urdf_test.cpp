// Robots from URDF: compared with Denavit-Hartenberg parameters and with KDL's solvers; invalid files; fuzzing.
// After gtest.h, whose macros it uses.
#include <kdl/chainfksolverpos_recursive.hpp>
#include <kdl/chainjnttojacsolver.hpp>
#include <kdl/tree.hpp>

#include "control/chain.h"
#include "control/urdf_model.h"
#include "random_robots.h"
#include "support/test.h"
#include "taxelsim/error.h"
#include "urdf_text.h"

namespace taxelsim {
namespace {

constexpr double kPi = std::numbers::pi;
constexpr double kRounding = 1e-14;  // tens of rounding errors of numbers of order 1
constexpr double kInfinity = std::numeric_limits<double>::infinity();

Manipulator load(const std::string& text, const std::string& link, const std::string& base = "") {
  const testing::TemporaryDirectory directory;
  return loadUrdf(directory.write("robot.urdf", text), {.base_link = base, .sensors = {{link, {}}}});
}

Pose poseOf(const Manipulator& robot, const std::vector<double>& q) {
  return Chain(robot.sensors[0], static_cast<int>(robot.joints.size())).poseAt(q.data());
}

// Transform of one row of Denavit-Hartenberg parameters.
Pose dh(double theta, double d, double a, double alpha) {
  return Pose{{0, 0, d}, axisAngle({0, 0, 1}, theta)} * Pose{{a, 0, 0}, axisAngle({1, 0, 0}, alpha)};
}

RC_GTEST_PROP(Lwr, MatchesItsDenavitHartenbergParameters, ()) {
  const Manipulator robot = loadUrdf(kRobots / "lwr_palm.urdf", {.base_link = "", .sensors = {{"flange", {}}}});
  std::vector<double> q(7);
  for (double& position : q) position = drawBetween(-2, 2);
  const double d[7] = {0.3105, 0, 0.4, 0, 0.39, 0, 0.078};
  const double alpha[7] = {kPi / 2, -kPi / 2, -kPi / 2, kPi / 2, kPi / 2, -kPi / 2, 0};
  Pose X;
  for (int j = 0; j < 7; ++j) X = X * dh(q[j], d[j], 0, alpha[j]);
  RC_ASSERT(distance(poseOf(robot, q), X) <= kRounding);
}

TEST(Lwr, HasTheLimitsOfTheDataSheet) {
  const Manipulator robot = loadUrdf(kRobots / "lwr_palm.urdf", {.base_link = "", .sensors = {{"palm", {}}}, .velocity_limit_scale = 0.5});
  ASSERT_EQ(robot.joints.size(), 7u);
  for (int j = 0; j < 7; ++j) {
    const double range = (j % 2 == 0 ? 170 : 120) * kPi / 180;
    EXPECT_EQ(robot.joints[j].name, "a" + std::to_string(j + 1));
    EXPECT_NEAR(robot.joints[j].upper, range, kRounding);
    EXPECT_NEAR(robot.joints[j].lower, -range, kRounding);
    EXPECT_NEAR(robot.joints[j].max_velocity, 0.5 * (j == 4 ? 180 : 112.5) * kPi / 180, kRounding);
  }
}

std::string originText(const Pose& X) {
  const auto& [w, x, y, z] = X.rotation;
  const double roll = std::atan2(2 * (w * x + y * z), 1 - 2 * (x * x + y * y));
  const double pitch = std::asin(std::clamp(2 * (w * y - z * x), -1.0, 1.0));
  const double yaw = std::atan2(2 * (w * z + x * y), 1 - 2 * (y * y + z * z));
  std::ostringstream text;
  text.precision(17);
  text << "<origin xyz='" << X.position[0] << " " << X.position[1] << " " << X.position[2] << "' rpy='" << roll << " " << pitch << " "
       << yaw << "'/>";
  return text.str();
}

std::string axisText(const Vector3& axis) {
  std::ostringstream text;
  text.precision(17);
  text << "<axis xyz='" << axis[0] << " " << axis[1] << " " << axis[2] << "'/>";
  return text.str();
}

// A random tree of links l0, l1, ...; the parent of each is an earlier one.
std::string drawTree(int num_links) {
  std::string text = "<link name='l0'/>\n";
  for (int k = 1; k < num_links; ++k) {
    const std::string type = *rc::gen::element<std::string>("revolute", "continuous", "prismatic", "fixed");
    const Vector3 axis = *rc::gen::arbitrary<bool>() ? Vector3{0, 0, *rc::gen::element(1.0, -1.0)} : add(drawVector(1), {0, 0, 1.1});
    const std::string limit = type == "continuous" || type == "fixed" ? "" : "<limit lower='-3' upper='3' effort='1' velocity='1'/>";
    text += "<link name='l" + std::to_string(k) + "'/>\n" +
            joint("j" + std::to_string(k), type, "l" + std::to_string(*rc::gen::inRange(std::max(0, k - 2), k)), "l" + std::to_string(k),
                  originText(drawPose(0.5)) + axisText(axis) + limit);
  }
  return robot(text);
}

// Chains between any two links, up and down the tree.
RC_GTEST_PROP(Urdf, MatchesKdlSolvers, ()) {
  const testing::TemporaryDirectory directory;
  const int num_links = *rc::gen::inRange(3, 12);
  const std::filesystem::path file = directory.write("robot.urdf", drawTree(num_links));
  const std::string base = "l" + std::to_string(*rc::gen::inRange(0, num_links));
  const std::string tip = "l" + std::to_string(*rc::gen::inRange(0, num_links));
  const Pose X_LS = drawPose(0.2);
  KDL::Chain kdl;
  const UrdfModel model(file);
  RC_ASSERT(model.tree().getChain(base, tip, kdl));
  if (kdl.getNrOfJoints() == 0) return;
  const Manipulator robot = loadUrdf(file, {.base_link = base, .sensors = {{tip, X_LS}}});
  const auto num_joints = static_cast<int>(kdl.getNrOfJoints());
  RC_ASSERT(static_cast<int>(robot.joints.size()) == num_joints);

  KDL::JntArray q(num_joints);
  for (int j = 0; j < num_joints; ++j) q(j) = drawBetween(-2, 2);
  KDL::Frame frame;
  KDL::Jacobian kdl_jacobian(num_joints);
  RC_ASSERT(KDL::ChainFkSolverPos_recursive(kdl).JntToCart(q, frame) == 0);
  RC_ASSERT(KDL::ChainJntToJacSolver(kdl).JntToJac(q, kdl_jacobian) == 0);

  std::vector<double> jacobian(6 * static_cast<std::size_t>(num_joints));
  const Pose X_BS = Chain(robot.sensors[0], num_joints).poseAt(q.data.data(), jacobian.data());
  Pose X_BL{{frame.p.x(), frame.p.y(), frame.p.z()}, {}};
  frame.M.GetQuaternion(X_BL.rotation[1], X_BL.rotation[2], X_BL.rotation[3], X_BL.rotation[0]);
  constexpr double kMatrixRounding = 1e-13;  // translations up to 20 m, and conversion of matrices to quaternions
  RC_ASSERT(distance(X_BS, X_BL * X_LS) <= kMatrixRounding);
  // KDL's Jacobian is that of L's origin, in the axes of the base.
  const Vector3 lever = subtract(X_BS.position, X_BL.position);
  for (int j = 0; j < num_joints; ++j) {
    const KDL::Twist column = kdl_jacobian.getColumn(j);
    const Vector3 w{column.rot.x(), column.rot.y(), column.rot.z()};
    const Vector3 v = add({column.vel.x(), column.vel.y(), column.vel.z()}, cross(w, lever));
    const Quaternion R_SB = inverse(X_BS).rotation;
    const double* const row = &jacobian[6 * static_cast<std::size_t>(j)];
    RC_ASSERT(distance(rotate(R_SB, v), Vector3{row[0], row[1], row[2]}) <= kMatrixRounding);
    RC_ASSERT(distance(rotate(R_SB, w), Vector3{row[3], row[4], row[5]}) <= kMatrixRounding);
  }
}

TEST(Urdf, ContinuousJointsHaveNoLimits) {
  const Manipulator robot = load(::taxelsim::robot(kLinks + joint("ab", "continuous", "a", "b") + joint("bc", "fixed", "b", "c")), "c");
  ASSERT_EQ(robot.joints.size(), 1u);
  EXPECT_EQ(robot.joints[0].lower, -kInfinity);
  EXPECT_EQ(robot.joints[0].upper, kInfinity);
  EXPECT_EQ(robot.joints[0].max_velocity, kInfinity);
}

TEST(Urdf, PrismaticJointsTranslate) {
  const std::string text = robot(
      kLinks +
      joint("ab", "prismatic", "a", "b", "<origin xyz='0 0 1'/><axis xyz='0 2 0'/><limit lower='0.1' upper='1' effort='1' velocity='2'/>") +
      joint("bc", "fixed", "b", "c", "<origin xyz='1 0 0'/>"));
  const Manipulator robot = load(text, "c");
  EXPECT_EQ(robot.joints[0].type, JointType::kPrismatic);
  EXPECT_EQ(robot.joints[0].initial_position, 0.1);  // 0 is outside
  EXPECT_LE(distance(poseOf(robot, {0.3}), Pose{{1, 0.3, 1}, {1, 0, 0, 0}}), kRounding);
}

// q_c = -2 q_b + 0.5.
TEST(Urdf, MimicJointsNarrowTheLimitsOfTheirLeader) {
  const std::string z = "<axis xyz='0 0 1'/>", up = "<origin xyz='1 0 0'/>";
  const std::string mimic = "<mimic joint='ab' multiplier='-2' offset='0.5'/>";
  const Manipulator robot_with_mimic =
      load(robot(kLinks + joint("ab", "revolute", "a", "b", z + kLimit) +
                 joint("bc", "revolute", "b", "c", z + up + "<limit lower='-1' upper='1' effort='1' velocity='3'/>" + mimic)),
           "c");
  ASSERT_EQ(robot_with_mimic.joints.size(), 1u);
  EXPECT_LE(distance(poseOf(robot_with_mimic, {0.2}), Pose{{std::cos(0.2), std::sin(0.2), 0}, axisAngle({0, 0, 1}, 0.2 - 2 * 0.2 + 0.5)}),
            kRounding);
  // -1 <= -2 q + 0.5 <= 1
  EXPECT_NEAR(robot_with_mimic.joints[0].lower, -0.25, kRounding);
  EXPECT_NEAR(robot_with_mimic.joints[0].upper, 0.75, kRounding);
  EXPECT_NEAR(robot_with_mimic.joints[0].max_velocity, 1.5, kRounding);
}

// q_b = 3 q_a + 0.2, q_c = 2 q_b + 0.1.
TEST(Urdf, MimicJointsMayMimicMimicJoints) {
  const std::string z = "<axis xyz='0 0 1'/>";
  const Manipulator robot_with_mimic =
      load(robot(kLinks + "<link name='d'/>" + joint("ab", "continuous", "a", "b", z) +
                 joint("bc", "continuous", "b", "c", z + "<mimic joint='ab' multiplier='3' offset='0.2'/>") +
                 joint("cd", "continuous", "c", "d", z + "<mimic joint='bc' multiplier='2' offset='0.1'/>")),
           "d");
  ASSERT_EQ(robot_with_mimic.joints.size(), 1u);
  EXPECT_LE(distance(poseOf(robot_with_mimic, {0.1}), Pose{{0, 0, 0}, axisAngle({0, 0, 1}, 0.1 + 0.5 + 1.1)}), kRounding);
}

// The leader need not be on the path to the sensor.
TEST(Urdf, MimicJointsMayMimicAJointOffThePath) {
  const std::string z = "<axis xyz='0 0 1'/>";
  const Manipulator robot_with_mimic =
      load(robot(kLinks + joint("ab", "revolute", "a", "b", z + kLimit) +
                 joint("ac", "revolute", "a", "c", z + kLimit + "<mimic joint='ab' multiplier='1' offset='0'/>")),
           "c");
  ASSERT_EQ(robot_with_mimic.joints.size(), 1u);
  EXPECT_EQ(robot_with_mimic.joints[0].name, "ab");
  EXPECT_LE(distance(poseOf(robot_with_mimic, {0.2}), Pose{{0, 0, 0}, axisAngle({0, 0, 1}, 0.2)}), kRounding);
}

TEST(Urdf, SensorsShareJoints) {
  const testing::TemporaryDirectory directory;
  const auto file =
      directory.write("robot.urdf", robot(kLinks + joint("ab", "revolute", "a", "b", kLimit) + joint("bc", "continuous", "b", "c")));
  const Manipulator hand = loadUrdf(file, {.base_link = "", .sensors = {{"b", {}}, {"c", {}}}});
  EXPECT_EQ(hand.joints.size(), 2u);
  EXPECT_EQ(hand.sensors[0].chain.size(), 1u);
  EXPECT_EQ(hand.sensors[1].chain[0].joint, hand.sensors[0].chain[0].joint);
}

TEST(Urdf, IgnoresVisualsAndInertias) {
  const std::string text = robot(
      "<link name='a'><visual><geometry><dodecahedron/></geometry></visual><inertial><mass value='heavy'/></inertial></link><link "
      "name='b'/>"
      "<transmission/><gazebo reference='a'/><material name='x'/><material name='x'/>" +
      joint("ab", "revolute", "a", "b", kLimit));
  EXPECT_EQ(load(text, "b").joints.size(), 1u);
}

struct BadUrdf {
  std::string text;
  std::string message;  // start of the message, after the file's name
  std::string link = "c";
};

std::string errorFor(const BadUrdf& bad, const std::string& base = "") {
  const testing::TemporaryDirectory directory;
  const std::filesystem::path file = directory.write("robot.urdf", bad.text);
  try {
    loadUrdf(file, {.base_link = base, .sensors = {{bad.link, {}}}});
  } catch (const Error& error) {
    const std::string message = error.what();
    EXPECT_EQ(error.kind(), ErrorKind::kInput);
    EXPECT_EQ(message.find('\n'), std::string::npos) << message;
    EXPECT_TRUE(message.starts_with(file.string() + ":")) << message;
    return message.substr(std::min(message.size(), file.string().size()));
  }
  return "no error";
}

TEST(BadUrdfs, AreRejectedWithOneLine) {
  const std::string ab = joint("ab", "revolute", "a", "b", kLimit), bc = joint("bc", "revolute", "b", "c", kLimit);
  const auto withLimit = [&](const std::string& limit) { return robot(kLinks + ab + joint("bc", "revolute", "b", "c", limit)); };
  const auto withMore = [&](const std::string& more) { return robot(kLinks + ab + joint("bc", "continuous", "b", "c", more)); };
  const std::vector<BadUrdf> table = {
      {"", ":0: is not XML: XML_ERROR_EMPTY_DOCUMENT"},
      {"<robot name='x'>", ":1: is not XML: "},
      {"<robot name='x'>\n<link></joint>\n</robot>", ":2: is not XML: "},
      {"<sdf/>", ":1: is not a URDF: no <robot>"},
      {robot(""), ": "},
      {robot(kLinks + ab + bc), ": no link d: the links are a, b, c", "d"},
      {robot(kLinks + ab), ": Failed to find root link: Two root links found: [a] and [c]"},
      {robot(kLinks + ab + joint("bc", "revolute", "x", "c", kLimit)), ": Failed to build tree: parent link [x] of joint [bc] not found."},
      {robot(kLinks + ab + bc + joint("bd", "fixed", "b", "d")), ": Failed to build tree: child link [d] of joint [bd] not found"},
      {robot(kLinks + ab + bc + joint("ac", "fixed", "a", "c")),
       ":5: joint ac: its child c is already the child of joint bc: a link has one parent"},
      {robot(kLinks + ab + bc + joint("ca", "fixed", "c", "a")), ":5: joint ca is in, or below, a loop of links: only trees are allowed"},
      {robot(kLinks + ab + joint("cc", "fixed", "c", "c")), ":4: joint cc is in, or below, a loop of links"},
      {robot(kLinks + ab + joint("bc", "ball", "b", "c")),
       ":4: joint bc: type: \"ball\" is not allowed: revolute, continuous, prismatic or fixed"},
      {robot(kLinks + ab + joint("bc", "floating", "b", "c")),
       ": joint bc is floating: revolute, continuous, prismatic or fixed is allowed"},
      {robot(kLinks + ab + joint("bc", "planar", "b", "c", "<axis xyz='0 0 1'/>")), ": joint bc is planar: "},
      {robot(kLinks + ab + "<joint name='bc' type='fixed'><parent link='b'/></joint>"),
       ":4: joint bc: a <parent link> or <child link> is missing"},
      {robot(kLinks + ab + ab), ":4: joint ab: its child b is already the child of joint ab"},
      {robot(kLinks + joint("ab", "fixed", "a", "b") + joint("ab", "fixed", "b", "c")), ": joint 'ab' is not unique."},
      {robot("<link name='a'/><link name='a'/>"), ": link 'a' is not unique.", "a"},
      {robot("<link/>"), ": "},
      {robot(kLinks + joint("ab", "fixed", "a", "b") + joint("bc", "fixed", "b", "c")), ": no joint moves between link a and the sensors"},
      {withLimit(""), ": Joint [bc] is of type REVOLUTE but it does not specify limits"},
      {withLimit("<limit lower='1' upper='-1' effort='1' velocity='2'/>"), ": joint bc: limit lower: 1 is not allowed: at most upper (-1)"},
      {withLimit("<limit lower='-1' upper='1' effort='1' velocity='0'/>"), ": joint bc: limit velocity: 0 is not allowed: a velocity > 0"},
      {withLimit("<limit lower='-1' upper='1' effort='1' velocity='-2'/>"),
       ": joint bc: limit velocity: -2 is not allowed: a velocity > 0"},
      {withLimit("<limit lower='nan' upper='1' effort='1' velocity='2'/>"), ": "},
      {withLimit("<limit lower='-1' upper='1e999' effort='1' velocity='2'/>"), ": "},
      {withLimit("<limit lower='-1' upper='inf' effort='1' velocity='2'/>"), ": "},
      {withLimit("<limit lower='-1' upper='1' effort='1'/>"), ": "},
      {withLimit("<limit lower='-1' upper='one' effort='1' velocity='2'/>"), ": "},
      {withMore("<axis xyz='0 0 0'/>"), ": joint bc: axis: 0 is not allowed: a vector of finite length > 0"},
      {withMore("<axis xyz='0 0 nan'/>"), ": "},
      {withMore("<axis xyz='0 1'/>"), ": "},
      {withMore("<origin xyz='0 0 inf'/>"), ": "},
      {withMore("<origin xyz='0 0 0' rpy='nan 0 0'/>"), ": "},
      {withMore("<mimic joint='zz'/>"), ": joint bc: mimic: no joint zz"},
      {withMore("<mimic joint='bc'/>"), ": joint bc: mimic: the joint mimics itself"},
      {withMore("<mimic/>"), ": "},
      {withMore("<mimic joint='ab' multiplier='nan'/>"), ": "},
      {robot(kLinks + joint("ab", "fixed", "a", "b") + joint("bc", "continuous", "b", "c", "<mimic joint='ab'/>")),
       ": joint bc: mimic: joint ab is fixed and cannot be mimicked"},
      {robot(kLinks + ab + joint("bc", "revolute", "b", "c", "<limit lower='5' upper='6' effort='1' velocity='2'/><mimic joint='ab'/>")),
       ": joint bc: no position of joint ab, which it mimics, is within the limits of both"},
  };
  for (const BadUrdf& bad : table) {
    ::testing::internal::CaptureStderr();
    EXPECT_THAT(errorFor(bad), ::testing::StartsWith(bad.message)) << bad.text;
    EXPECT_EQ(::testing::internal::GetCapturedStderr(), "") << bad.text;
  }
  EXPECT_THAT(errorFor({robot(kLinks + ab + bc), ""}, "z"), ::testing::StartsWith(": no link z: the links are a, b, c"));
}

TEST(BadUrdfs, MissingAndLargeFilesAreRejected) {
  EXPECT_THROW(loadUrdf("no such file", {.base_link = "", .sensors = {{"a", {}}}}), Error);
  EXPECT_THROW(loadUrdf(kRobots, {.base_link = "", .sensors = {{"a", {}}}}), Error);
  std::string deep;
  for (int i = 0; i < 100'000; ++i) deep += "<a>";
  EXPECT_THAT(errorFor({robot(deep), ""}), ::testing::HasSubstr("is not XML: XML_ELEMENT_DEPTH_EXCEEDED"));
  std::string wide;
  for (int i = 0; i < 5000; ++i) wide += "<link name='l" + std::to_string(i) + "'/>";
  EXPECT_THAT(errorFor({robot(wide), ""}), ::testing::StartsWith(":1: has 5000 links: at most 4096 are allowed"));
}

TEST(BadUrdfs, OptionsOutOfRangeAreRejected) {
  EXPECT_THROW(loadUrdf(kRobots / "lwr_palm.urdf", {.base_link = "", .sensors = {}}), Error);
  EXPECT_THROW(loadUrdf(kRobots / "lwr_palm.urdf", {.base_link = "", .sensors = {{"palm", {}}}, .velocity_limit_scale = 0}), Error);
  EXPECT_THROW(loadUrdf(kRobots / "lwr_palm.urdf", {.base_link = "", .sensors = {{"palm", {}}}, .velocity_limit_scale = NAN}), Error);
  EXPECT_THROW(loadUrdf(kRobots / "lwr_palm.urdf", {.base_link = "", .sensors = {{"palm", {{NAN, 0, 0}, {1, 0, 0, 0}}}}}), Error);
}

// Weak oracle: the file is loaded, or rejected with one line.
RC_GTEST_PROP(FuzzedUrdf, LoadsOrIsRejected, ()) {
  static const testing::TemporaryDirectory directory;
  static const std::string original = [] {
    std::ifstream stream(kRobots / "lwr_palm.urdf");
    std::ostringstream text;
    text << stream.rdbuf();
    return text.str();
  }();
  static constexpr std::string_view kPunctuation = "<>/\"'=!?-&; 019.eE\n\t";
  std::string text = original;
  const int count = *rc::gen::inRange(1, 5);
  for (int i = 0; i < count; ++i) {
    const auto at = *rc::gen::inRange<std::size_t>(0, text.size());
    switch (*rc::gen::inRange(0, 3)) {
      case 0:
        text[at] = static_cast<char>(text[at] ^ (1 << *rc::gen::inRange(0, 8)));
        break;
      case 1:
        text[at] = kPunctuation[*rc::gen::inRange<std::size_t>(0, kPunctuation.size())];
        break;
      default:
        text.erase(at, *rc::gen::inRange<std::size_t>(1, 40));
    }
  }
  try {
    loadUrdf(directory.write("robot.urdf", text), {.base_link = "", .sensors = {{"palm", {}}}});
  } catch (const Error& error) {
    const std::string message = error.what();
    RC_ASSERT(!message.empty());
    RC_ASSERT(message.find('\n') == std::string::npos);
  }
}

// The arm of lwr_palm.urdf with the hand of shadow_hand.urdf: palm and fingertips are where those two files place them.
TEST(LwrShadowHand, JoinsTheArmAndTheHand) {
  // m: lwr_palm.urdf rounds the height of the wrist to 0.1 mm, 0.213 instead of 0.21301.
  constexpr double kWristRounding = 1.1e-5;
  const std::vector<SensorMount> mounts{{"palm", {}},     {"ffdistal", {}}, {"mfdistal", {}},
                                        {"rfdistal", {}}, {"lfdistal", {}}, {"thdistal", {}}};
  const Manipulator joined = loadUrdf(kRobots / "lwr_shadow_hand.urdf", {.base_link = "", .sensors = mounts});
  const Manipulator hand = loadUrdf(kRobots / "shadow_hand.urdf", {.base_link = "palm", .sensors = mounts});
  const Manipulator arm = loadUrdf(kRobots / "lwr_palm.urdf", {.base_link = "", .sensors = {{"palm", {}}}});
  ASSERT_EQ(joined.joints.size(), 31u);
  std::vector<double> q(joined.joints.size(), 0.0);
  for (std::size_t j = 0; j < q.size(); ++j) {
    const Joint& joint = joined.joints[j];
    if (!joint.name.starts_with("WRJ"))
      q[j] = joint.lower + (joint.upper - joint.lower) * (0.3 + 0.4 * std::fmod(0.618 * static_cast<double>(j), 1));
  }
  const auto poseAt = [&](const Manipulator& robot, std::size_t sensor) {
    std::vector<double> positions;
    for (const Joint& joint : robot.joints) {
      const auto same = [&](const Joint& other) { return other.name == joint.name; };
      const auto found = std::find_if(joined.joints.begin(), joined.joints.end(), same);
      EXPECT_NE(found, joined.joints.end());
      EXPECT_EQ(found->lower, joint.lower);
      EXPECT_EQ(found->upper, joint.upper);
      EXPECT_EQ(found->max_velocity, joint.max_velocity);
      positions.push_back(q[static_cast<std::size_t>(found - joined.joints.begin())]);
    }
    return Chain(robot.sensors[sensor], static_cast<int>(robot.joints.size())).poseAt(positions.data());
  };
  const auto expectNear = [](const Pose& found, const Pose& expected, double tolerance) {
    for (std::size_t k = 0; k < 3; ++k) EXPECT_NEAR(found.position[k], expected.position[k], tolerance);
    double cosine = 0;
    for (std::size_t k = 0; k < 4; ++k) cosine += found.rotation[k] * expected.rotation[k];
    EXPECT_NEAR(std::abs(cosine), 1, 1e-12);
  };
  const Pose X_BP = poseAt(joined, 0);
  expectNear(X_BP, poseAt(arm, 0), kWristRounding);
  for (std::size_t s = 1; s < mounts.size(); ++s) expectNear(inverse(X_BP) * poseAt(joined, s), poseAt(hand, s), 1e-12);
}

}  // namespace
}  // namespace taxelsim
