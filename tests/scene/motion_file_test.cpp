// The block `motion` of an object and files of waypoints: the values read, and the message of each error.
#include "scene_text.h"
#include "support/test.h"
#include "taxelsim/experiment.h"
#include "taxelsim/scene.h"

namespace taxelsim {
namespace {

constexpr std::string_view kPlace = "    weight: 2\n";  // line 17, in the first object
constexpr std::string_view kWay = "time_s,x_m,y_m,z_m,qw,qx,qy,qz\n0.5,0,0,0,1,0,0,0\n1.5,0.01,0,0,0.7071,0,0,0.7071\n";

std::string withMotion(const std::string& motion) {
  return edited(kScene, kPlace, "    motion: " + motion + "\n");
}

Scene load(const testing::TemporaryDirectory& directory, const std::string& motion) {
  return loadScene(directory.write("scene.yaml", withMotion(motion)));
}

template <typename Kind>
Kind motionOf(const std::string& text) {
  const testing::TemporaryDirectory directory;
  directory.write("way.csv", kWay);
  return std::get<Kind>(load(directory, text).objects[0].motion.value());
}

TEST(MotionFile, ObjectsRestByDefault) {
  const testing::TemporaryDirectory directory;
  for (const SceneObject& object : loadScene(directory.write("scene.yaml", kScene)).objects) EXPECT_FALSE(object.motion);
}

TEST(MotionFile, ReadsAConstantTwist) {
  const auto motion = motionOf<ConstantTwist>("{constant_twist: {linear_velocity_mm: [1, 0, -2], angular_velocity_deg: [0, 180, 0]}}");
  EXPECT_EQ(motion.twist.v, (Vector3{0.001, 0, -0.002}));
  EXPECT_DOUBLE_EQ(motion.twist.w[1], 3.141592653589793);
}

TEST(MotionFile, ReadsASinusoid) {
  const auto motion = motionOf<Sinusoid>("{sinusoid: {axis: [0, 0, 1], amplitude_mm: 3, frequency: 2, phase_deg: 90}}");
  EXPECT_EQ(motion.axis, (Vector3{0, 0, 1}));
  EXPECT_EQ(motion.amplitude, 0.003);
  EXPECT_EQ(motion.angle, 0);
  EXPECT_EQ(motion.frequency, 2);
  EXPECT_DOUBLE_EQ(motion.phase, 1.5707963267948966);
}

TEST(MotionFile, ReadsWaypoints) {
  const auto motion = motionOf<Waypoints>("{waypoints: {file: way.csv, interpolation: linear}}");
  EXPECT_EQ(motion.interpolation, Waypoints::Interpolation::kLinear);
  ASSERT_EQ(motion.points.size(), 2u);
  EXPECT_EQ(motion.points[0].time, 0.5);
  EXPECT_EQ(motion.points[1].pose.position, (Vector3{0.01, 0, 0}));
  EXPECT_DOUBLE_EQ(motion.points[1].pose.rotation[0], std::sqrt(0.5));  // normalised
  EXPECT_EQ(motionOf<Waypoints>("{waypoints: {file: way.csv}}").interpolation, Waypoints::Interpolation::kCubic);
}

TEST(MotionFile, HandHeldHasDefaults) {
  const auto motion = motionOf<HandHeld>("{hand_held: {tremor_mm: 0.2, drift_band: [0.2, 2]}}");
  EXPECT_EQ(motion.tremor, 2e-4);
  EXPECT_EQ(motion.drift, HandHeld{}.drift);
  EXPECT_EQ(motion.drift_band, (std::array<double, 2>{0.2, 2}));
}

TEST(MotionFile, ResolvedSceneHasEverySetting) {
  const testing::TemporaryDirectory directory;
  directory.write("way.csv", kWay);
  std::vector<std::string> texts;
  for (const std::string motion :
       {"{constant_twist: {}}", "{constant_twist: {linear_velocity: [1, 0, 0]}}", "{constant_twist: {angular_velocity: [1, 0, 0]}}",
        "{sinusoid: {axis: [1, 0, 0], angle: 1, frequency: 1}}", "{sinusoid: {axis: [0, 1, 0], angle: 1, frequency: 1}}",
        "{sinusoid: {axis: [1, 0, 0], angle: 2, frequency: 1}}", "{sinusoid: {axis: [1, 0, 0], angle: 1, frequency: 2}}",
        "{sinusoid: {axis: [1, 0, 0], amplitude: 1, angle: 1, frequency: 1}}",
        "{sinusoid: {axis: [1, 0, 0], angle: 1, frequency: 1, phase: 1}}", "{waypoints: {file: way.csv}}",
        "{waypoints: {file: way.csv, interpolation: linear}}", "{hand_held: {}}", "{hand_held: {drift: 1}}", "{hand_held: {tremor: 1}}",
        "{hand_held: {drift_angle: 1}}", "{hand_held: {tremor_angle: 1}}", "{hand_held: {drift_band: [1, 2]}}",
        "{hand_held: {tremor_band: [1, 2]}}"}) {
    const std::string text = load(directory, motion).resolved;
    EXPECT_EQ(loadScene(directory.write("resolved.yaml", text)).resolved, text) << motion;
    EXPECT_EQ(std::count(texts.begin(), texts.end(), text), 0) << motion;
    texts.push_back(text);
  }
  directory.write("way.csv", std::string(kWay) + "2,0,0,0,1,0,0,0\n");
  EXPECT_EQ(std::count(texts.begin(), texts.end(), load(directory, "{waypoints: {file: way.csv}}").resolved), 0);
}

TEST(MotionFile, RejectsBadBlocks) {
  const testing::TemporaryDirectory directory;
  directory.write("way.csv", kWay);
  directory.write("bad.csv", "1,2\n");
  const std::vector<std::pair<std::string, std::string>> table = {
      {"{}", ":17:13: objects[0].motion: exactly one of constant_twist | sinusoid | waypoints | hand_held"},
      {"{hand_held: {}, constant_twist: {}}",
       ":17:25: objects[0].motion.hand_held: conflicts with `constant_twist`: exactly one of constant_twist"},
      {"fast", ":17:13: objects[0].motion: fast is not allowed: a mapping of constant_twist, sinusoid, waypoints, hand_held"},
      {"{constant_twist: {linear_velocity: [1, .nan, 0]}}",
       ":17:52: objects[0].motion.constant_twist.linear_velocity[1]: .nan is not allowed: a number m/s"},
      {"{constant_twist: {speed: 1}}",
       ":17:31: objects[0].motion.constant_twist.speed: unknown key; allowed: linear_velocity[_mm], angular"},
      {"{sinusoid: {axis: [1, 0, 0], frequency: 1}}", ":17:24: objects[0].motion.sinusoid: amplitude[_mm] or angle[_deg] is missing"},
      {"{sinusoid: {axis: [0, 0, 0], amplitude: 1, frequency: 1}}",
       ":17:31: objects[0].motion.sinusoid.axis: a vector of length 0 is not allowed: a finite length > 0"},
      {"{sinusoid: {amplitude: 1, frequency: 1}}", ":17:24: objects[0].motion.sinusoid: axis is missing: a list of 3 numbers"},
      {"{sinusoid: {axis: [1, 0, 0], amplitude: 1, frequency: 0}}",
       ":17:67: objects[0].motion.sinusoid.frequency: 0 is not allowed: a number > 0 Hz"},
      {"{waypoints: {}}", ":17:25: objects[0].motion.waypoints: file is missing: a CSV file of waypoints"},
      {"{waypoints: {file: none.csv}}", ":17:32: objects[0].motion.waypoints.file: "},
      {"{waypoints: {file: bad.csv}}", ":17:32: objects[0].motion.waypoints.file: "},
      {"{waypoints: {file: way.csv, interpolation: square}}",
       ":17:56: objects[0].motion.waypoints.interpolation: square is not allowed: linear | cubic"},
      {"{waypoints: {file: way.csv, sha256: '00'}}", ":17:49: objects[0].motion.waypoints.sha256: not the SHA-256 of"},
      {"{hand_held: {tremor: -1}}", ":17:34: objects[0].motion.hand_held.tremor: -1 is not allowed: a number >= 0 m"},
      {"{hand_held: {tremor_band: [12, 8]}}",
       ":17:39: objects[0].motion.hand_held.tremor_band: [12, 8] is not allowed: [min, max] with min <= max"},
      {"{hand_held: {drift_band: [0, 8]}}", ":17:39: objects[0].motion.hand_held.drift_band[0]: 0 is not allowed: a number > 0 Hz"},
  };
  for (const auto& [motion, message] : table) {
    const std::filesystem::path file = directory.write("scene.yaml", withMotion(motion));
    EXPECT_THAT(refusal(file, [&] { loadScene(file); }), ::testing::StartsWith(message)) << motion;
  }
}

TEST(MotionFile, RejectsMotionInScenesOfContacts) {
  const testing::TemporaryDirectory directory;
  std::string text = edited(withMotion("{hand_held: {}}"), "kind: servo", "kind: contacts");
  text = edited(edited(text, "num_steps: 20, ", ""), "controller:\n  tactile_servo: {edge_angle: {kp: 0.78}}\n", "");
  const std::filesystem::path file = directory.write("scene.yaml", text);
  EXPECT_THAT(refusal(file, [&] { loadScene(file); }),
              ::testing::StartsWith(":17:13: objects[0].motion: a scene of kind contacts has one frame, in which nothing moves"));

  const std::string sensor = (std::filesystem::path(TAXELSIM_SOURCE_DIR) / "scenes/sensors/wts0614_soft_cover.yaml").string();
  const std::filesystem::path experiment = directory.write(
      "experiment.yaml", "format_version: 1\nname: x\nexperiment: static\nreference: " + sensor + "\nsensors: [{sensor: " + sensor +
                             "}]\nobjects:\n  - sphere: {radius: 1}\n    motion: {hand_held: {}}\nyaw: [0]\nloads: [1]\n");
  EXPECT_THAT(refusal(experiment, [&] { loadStaticExperiment(experiment); }),
              ::testing::StartsWith(":8:13: objects[0].motion: objects of a static experiment do not move"));
}

TEST(WaypointFile, AcceptsByteOrderMarkBlanksCommentsAndWindowsLines) {
  const testing::TemporaryDirectory directory;
  const auto points = loadWaypoints(directory.write("way.csv",
                                                    "# recorded\r\n\r\ntime_s, x_m, y_m, z_m, qw, qx, qy, qz\r\n"
                                                    " 0 , 1 ,2, 3,1,0,0,0 # start\r\n1e0,1,2,3,0,0,0,-1"));
  ASSERT_EQ(points.size(), 2u);
  EXPECT_EQ(points[1].time, 1);
  EXPECT_EQ(points[0].pose.position, (Vector3{1, 2, 3}));
  EXPECT_EQ(points[1].pose.rotation, (Quaternion{0, 0, 0, -1}));
  EXPECT_EQ(loadWaypoints(directory.write("way.csv", "\xEF\xBB\xBFtime_s,x_m,y_m,z_m,qw,qx,qy,qz\n0,1,2,3,1,0,0,0\n")).size(), 1u);
}

TEST(WaypointFile, RejectsBadFiles) {
  const testing::TemporaryDirectory directory;
  const std::string heading = "time_s,x_m,y_m,z_m,qw,qx,qy,qz\n";
  const std::vector<std::pair<std::string, std::string>> table = {
      {"", ":1:1: no waypoint found: the file needs the heading time_s,x_m,y_m,z_m,qw,qx,qy,qz and at least one line"},
      {heading, ":2:1: no waypoint"},
      {"0,0,0,0,1,0,0,0\n", ":1:1: missing heading: the first line must be time_s,x_m,y_m,z_m,qw,qx,qy,qz"},
      {"time_s,x_mm,y_m,z_m,qw,qx,qy,qz\n", ":1:1: missing heading"},
      {heading + "0,0,0,0,1,0,0\n", ":2:14: missing value of qz: a line is time_s,x_m,y_m,z_m,qw,qx,qy,qz"},
      {heading + "0,0,0,0,1,0,0,0,7\n", ":2:17: one value too many: a line is time_s,x_m,y_m,z_m,qw,qx,qy,qz"},
      {heading + "0,0,0,0,1,0,0,\n", ":2:15: qz: \"\" is not allowed: a number from -1.001 to 1.001"},
      {heading + "0,0,nan,0,1,0,0,0\n", ":2:5: y_m: \"nan\" is not allowed: a number from -1e+06 to 1e+06"},
      {heading + "0,0,inf,0,1,0,0,0\n", ":2:5: y_m: \"inf\" is not allowed"},
      {heading + "0,0,1e7,0,1,0,0,0\n", ":2:5: y_m: \"1e7\" is not allowed"},
      {heading + "0,0,0,0x1,1,0,0,0\n", ":2:7: z_m: \"0x1\" is not allowed"},
      {heading + "0;0;0;0;1;0;0;0\n", ":2:1: time_s: \"0;0;0;0;1;0;0;0\" is not allowed"},
      {heading + "0,0,0,0,1,0,0,0\n0,0,0,0,1,0,0,0\n", ":3:1: time_s: 0 is not allowed: must be later than the previous waypoint (0 s)"},
      {heading + "1,0,0,0,1,0,0,0\n\n0.5,0,0,0,1,0,0,0\n",
       ":4:1: time_s: 0.5 is not allowed: must be later than the previous waypoint (1 s)"},
      {heading + "0,0,0,0,1,0,0,0.5\n", ":2:9: qw,qx,qy,qz: length 1.118033988749895 is not allowed: a unit quaternion"},
      {heading + "0,0,0,0,0,0,0,0\n", ":2:9: qw,qx,qy,qz: length 0 is not allowed"},
      {heading + "0,0,0,\"\x01\",0,0,0,0\n", ":2:7: z_m: \"\"\\x01\"\" is not allowed"},
  };
  for (const auto& [text, message] : table) {
    const std::filesystem::path file = directory.write("way.csv", text);
    EXPECT_THAT(refusal(file, [&] { loadWaypoints(file); }), ::testing::StartsWith(message)) << text;
  }
  EXPECT_THAT(refusal(directory.path(), [&] { loadWaypoints(directory.path()); }), ::testing::StartsWith(": a directory, not a file"));
}

}  // namespace
}  // namespace taxelsim
