// Parts of bench/sweep: its sensor and prism equal the shipped ones, and the descent finds the fastest setting along its axes.
#include "geometry/polyhedron.h"
#include "support/test.h"
#include "sweep/cases.h"
#include "sweep/descent.h"
#include "sweep/outputs.h"
#include "sweep/setting.h"
#include "taxelsim/device.h"
#include "taxelsim/error.h"

namespace taxelsim::bench {
namespace {

constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
const Setting kStart{64, 1, 32, 64, 8, 1};

// Frame time that grows with the distance from `fastest`, in doublings of any parameter.
FrameTime timeNear(const Setting& setting, const Setting& fastest) {
  FrameTime time{.contact = 1, .image = 1, .device = 0, .wall = 0};
  for (std::size_t axis = 0; axis < kNumAxes; ++axis) {
    const double doublings = std::abs(std::log2(setting[axis]) - std::log2(fastest[axis]));
    (axes()[axis].pass == Pass::kContact ? time.contact : time.image) += doublings;
  }
  time.device = time.wall = time.contact + time.image;
  return time;
}

Descent everywhere() {
  return {.over = axesNamed({}), .only = {}};
}

TEST(SweepCases, SensorAndPrismEqualTheFiles) {
  EXPECT_EQ(sensorText([] {
              Sensor sensor = loadSensor(TAXELSIM_SOURCE_DIR "/bench/sensors/wts0614.yaml");
              sensor.patches[0].name = wts0614().patches[0].name;
              return sensor;
            }()),
            sensorText(wts0614()));
  const Object made("prism", hexPrism()), shipped("prism", loadMesh(TAXELSIM_SOURCE_DIR "/scenes/objects/hex_prism.obj"));
  const Bounds of_made = boundsOf(made), of_shipped = boundsOf(shipped);
  for (std::size_t axis = 0; axis < 3; ++axis) {
    EXPECT_NEAR(of_made.min[axis], of_shipped.min[axis], 1e-8);
    EXPECT_NEAR(of_made.max[axis], of_shipped.max[axis], 1e-8);
  }
  const auto faces = convexFaces(std::get<Mesh>(made.shape), 8);
  ASSERT_TRUE(faces.has_value());
  EXPECT_EQ(faces->size(), 8u);
}

TEST(SweepCases, EveryCaseIsValid) {
  std::set<std::string> names;
  for (const SweepCase& work : sweepCases()) {
    EXPECT_TRUE(names.insert(work.name).second) << work.name;
    EXPECT_NO_THROW(checkSensor(work.sensor)) << work.name;
    EXPECT_NO_THROW(checkObject(work.object)) << work.name;
  }
  EXPECT_EQ(casesNamed({"10x10", "wts0614_prism"}).size(), 2u);
  EXPECT_THROW(casesNamed({"10x10", "10x11"}), Error);
}

TEST(SweepSetting, ModelUsesTheSetting) {
  const SweepCase work = casesNamed({"wts0614_ellipsoid_5120"}).front();
  const ModelOptions options{.sensor = work.sensor, .objects = {work.object}};
  const Setting setting{32, 3, 64, 16, 4, 5};
  EXPECT_EQ(settingOf(modelWith(Device::open(), options, setting)), setting);
  const Setting chosen = settingOf(Model(Device::open(), options));
  EXPECT_EQ(settingOf(modelWith(Device::open(), options, chosen)), chosen);
}

TEST(SweepSetting, MovesOneAxisAndDescribesDifferences) {
  EXPECT_EQ(moved(kStart, kContactRepeat, 4), (Setting{64, 4, 32, 64, 8, 1}));
  EXPECT_EQ(moved(kStart, kImageWorkgroup, 4), (Setting{64, 1, 32, 4, 4, 1}));  // the team follows
  EXPECT_EQ(differenceText(kStart, kStart), "as chosen");
  EXPECT_EQ(differenceText(moved(kStart, kImageWorkgroup, 4), kStart), "image_workgroup 4, image_team 4");
  EXPECT_THROW(axesNamed({"image_teams"}), Error);
}

TEST(SweepDescent, FindsTheFastestAndTimesEachSettingOnce) {
  const Setting fastest{128, 4, 16, 256, 128, 2};
  std::set<Setting> timed{kStart};
  const auto measure = [&](const Setting& setting) -> std::optional<FrameTime> {
    EXPECT_TRUE(timed.insert(setting).second) << "timed twice";
    EXPECT_LE(setting[kImageTeam], setting[kImageWorkgroup]);
    return timeNear(setting, fastest);
  };
  EXPECT_EQ(descend(kStart, timeNear(kStart, fastest), everywhere(), measure), fastest);
}

TEST(SweepDescent, SkipsRefusedSettings) {
  const Setting fastest{256, 1, 32, 64, 8, 1};
  const auto measure = [&](const Setting& setting) -> std::optional<FrameTime> {
    if (setting[kContactWorkgroup] == 256) return std::nullopt;
    return timeNear(setting, fastest);
  };
  EXPECT_EQ(descend(kStart, timeNear(kStart, fastest), everywhere(), measure), moved(kStart, kContactWorkgroup, 128));
}

// Scatter of timings is ignored; without a device clock the wall clock is the objective.
TEST(SweepDescent, IgnoresSmallGainsAndUsesTheWallClock) {
  const auto scattered = [](const Setting& setting) -> std::optional<FrameTime> {
    const double seconds = 1 - 1e-3 * setting[kContactRepeat] / 64.0;
    return FrameTime{.contact = seconds, .image = seconds, .device = seconds, .wall = seconds};
  };
  EXPECT_EQ(descend(kStart, *scattered(kStart), everywhere(), scattered), kStart);
  const auto no_clock = [](const Setting& setting) -> std::optional<FrameTime> {
    return FrameTime{.contact = kNan, .image = kNan, .device = kNan, .wall = 1.0 / setting[kContactRepeat]};
  };
  EXPECT_EQ(descend(kStart, *no_clock(kStart), everywhere(), no_clock)[kContactRepeat], 64);
}

// Three instances of two taxels: one bit in any output is found, with its instance.
TEST(SweepOutputs, OneBitIsADifference) {
  std::vector<std::uint32_t> image{1, 2, 3, 4, 5, 6};
  std::vector<float> force{1, 2, 3}, wrench(18, 1);
  FrameView frame;
  frame.tactile_image = image;
  frame.total_force = force;
  frame.ground_truth.contact_wrench = wrench;
  const Outputs kept = copyOf(frame, 3);
  EXPECT_EQ(firstDifference(kept, frame), "");
  wrench[17] = std::nextafter(1.0f, 2.0f);
  EXPECT_EQ(firstDifference(kept, frame), "contact_wrench of instance 2");
  force[0] = -1;
  EXPECT_EQ(firstDifference(kept, frame), "total_force of instance 0");
  image[3] = 5;
  EXPECT_EQ(firstDifference(kept, frame), "tactile_image of instance 1");

  const Outputs other = copyOf(frame, 3);
  EXPECT_NE(hashOf(kept.tactile_image), hashOf(other.tactile_image));
  EXPECT_NE(hashOfFloats(kept), hashOfFloats(other));
  EXPECT_EQ(hashesOfImages(kept)[0], hashesOfImages(other)[0]);
  EXPECT_NE(hashesOfImages(kept)[1], hashesOfImages(other)[1]);
}

}  // namespace
}  // namespace taxelsim::bench
