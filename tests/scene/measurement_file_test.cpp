// Measurement files: the values of each kind, and the message of each error.
#include "taxelsim/measurement.h"

#include "scene_text.h"
#include "support/test.h"

namespace taxelsim {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;

constexpr std::string_view kSensor = R"(format_version: 1
name: small
num_rows: 1
num_cols: 2
pitch_mm: 3.4
skin: {thickness_mm: 2, normal_contact_stiffness: 1.73e8}
readout: {curve: {counts_per_newton: 2400}}
)";

// A measurement with `keys` and this table, in a temporary directory.
class Bench {
 public:
  Bench(const std::string& keys, std::string_view table) {
    directory_.write("sensor.yaml", kSensor);
    directory_.write("table.csv", table);
    directory_.write("mask.csv", "0,1,1\n# a comment\n0,0.5,0\n");
    directory_.write("empty.csv", "0,0\n");
    directory_.write("ragged.csv", "1,1\n1\n");
    file_ = directory_.write("bench.yaml", "format_version: 1\nsensor: sensor.yaml\ntable: table.csv\n" + keys);
  }
  Measurement load() const { return loadMeasurement(file_); }
  std::string refused() const {
    return refusal(file_, [&] { load(); });
  }

 private:
  testing::TemporaryDirectory directory_;
  std::filesystem::path file_;
};

TEST(MeasurementFile, ReadsEveryKind) {
  const Measurement curve = Bench("measurement: force_curve\n", "taxel,force_N,counts\n0,0.5,100\n1,1,200\n").load();
  EXPECT_EQ(curve.name, "bench");
  EXPECT_EQ(curve.sensor.name, "small");
  EXPECT_THAT(std::get<ForceCurve>(curve.data).taxel, ElementsAre(0, 1));
  EXPECT_THAT(std::get<ForceCurve>(curve.data).counts, ElementsAre(100, 200));

  EXPECT_EQ(std::get<ForceCurve>(curve.data).curve_segments, 0);
  const Measurement pieces = Bench("measurement: force_curve\ncurve_segments: 7\n", "taxel,force_N,counts\n0,0.5,100\n").load();
  EXPECT_EQ(std::get<ForceCurve>(pieces.data).curve_segments, 7);

  const Measurement depth = Bench("measurement: force_depth\nindenter: {sphere: {radius_mm: 4}}\n", "depth_mm,force_N\n1,2\n").load();
  EXPECT_EQ(std::get<ForceDepth>(depth.data).indenter.radius, 0.004);
  EXPECT_THAT(std::get<ForceDepth>(depth.data).depth, ElementsAre(0.001));

  const Measurement point =
      Bench("measurement: point_images\nindenter: {flat_pin: {radius_mm: 0.5}}\n", "x_mm,y_m,r0_c1,r0_c0,force_mN\n1,0.002,7,8,9\n").load();
  const auto& images = std::get<PointImages>(point.data);
  EXPECT_THAT(images.position, ElementsAre(std::array<double, 2>{0.001, 0.002}));
  EXPECT_THAT(images.force, ElementsAre(::testing::DoubleEq(0.009)));
  EXPECT_THAT(images.images.counts, ElementsAre(8, 7));
  EXPECT_EQ(images.images.num_taxels, 2u);
  EXPECT_TRUE(images.images.time.empty());

  const Measurement step = Bench("measurement: step_response\nload: 2\n", "time_ms,counts\n0,0\n100,8190\n").load();
  EXPECT_EQ(std::get<StepResponse>(step.data).load, 2);
  EXPECT_THAT(std::get<StepResponse>(step.data).time, ElementsAre(0, 0.1));
  EXPECT_THAT(std::get<StepResponse>(step.data).counts, ElementsAre(0, 8190)) << "a sum over two taxels of 12 bits";

  const Measurement stamp = Bench("measurement: stamp_images\nload: 3\nindenter: {stamp: {size_mm: [4, 5]}}\ntaxel_columns: \"t{taxel}\"\n",
                                  "time_s,t0,t1\n0,0,0\n1,5,6\n")
                                .load();
  EXPECT_THAT(std::get<StampImages>(stamp.data).indenter.size, ElementsAre(0.004, 0.005));
  EXPECT_THAT(std::get<StampImages>(stamp.data).images.time, ElementsAre(0, 1));

  const Measurement all = Bench("measurement: images\n", "r0_c0,r0_c1\n1,2\n").load();
  EXPECT_THAT(std::get<ImageSequence>(all.data).images.counts, ElementsAre(1, 2));
}

TEST(MeasurementFile, ReadsColumnsByNameAndTheFixture) {
  const std::string keys = "measurement: stamp_images\nload: 2\nindenter: {stamp: {size_mm: [5, 5]}}\n";
  const std::string table = "t_s,a,b\n0,7,8\n";
  const Measurement named = Bench(keys + "taxel_columns: [b, a]\nfixture: holder\n", table).load();
  const auto& stamp = std::get<StampImages>(named.data);
  EXPECT_THAT(stamp.images.counts, ElementsAre(8, 7));
  EXPECT_THAT(stamp.images.time, ElementsAre(0));
  EXPECT_EQ(stamp.fixture, "holder");
  EXPECT_FALSE(stamp.position.has_value());
  const Measurement placed = Bench(keys + "taxel_columns: [b, a]\nposition_mm: [0, 0.5]\n", table).load();
  EXPECT_THAT(std::get<StampImages>(placed.data).position.value(), ElementsAre(0, 0.0005));
  EXPECT_THAT(Bench(keys + "taxel_columns: [b, a]\nposition: [0, 0.5]\n", table).refused(), HasSubstr("0.5 is not allowed")) << "in mm";
  EXPECT_THAT(Bench(keys + "taxel_columns: [b]\n", table).refused(), HasSubstr("1 names are not allowed: the sensor has 2 taxels"));
  EXPECT_THAT(Bench(keys + "taxel_columns: [b, c]\n", table).refused(), HasSubstr("missing column"));
  EXPECT_THAT(Bench("measurement: force_curve\nfixture: holder\n", "taxel,force_N,counts\n0,1,2\n").refused(),
              HasSubstr("not a key of force_curve"));
}

TEST(MeasurementFile, ReadsFootprintsAndUniformPresses) {
  const Measurement film =
      Bench("measurement: footprint_images\nmask: mask.csv\npixel_mm: 0.5\nposition_error_mm: 0.2\n", "yaw_deg,r0_c0,r0_c1\n90,8,7\n")
          .load();
  const auto& footprint = std::get<PointImages>(film.data);
  ASSERT_TRUE(footprint.mask.has_value());
  EXPECT_EQ(footprint.mask->num_rows, 2u);
  EXPECT_EQ(footprint.mask->num_cols, 3u);
  EXPECT_EQ(footprint.mask->pixel, 0.0005);
  EXPECT_THAT(footprint.mask->pressure, ElementsAre(0, 1, 1, 0, 0.5f, 0));
  EXPECT_EQ(footprint.position_error, 0.0002);
  EXPECT_THAT(footprint.position, ElementsAre(std::array<double, 2>{0, 0})) << "without columns of the place: in the middle";
  EXPECT_THAT(footprint.yaw, ElementsAre(::testing::DoubleEq(std::numbers::pi / 2)));

  const Measurement stamp =
      Bench("measurement: footprint_images\nindenter: {stamp: {size_mm: [4, 5]}}\n", "x_mm,y_mm,r0_c0,r0_c1\n1,2,8,7\n").load();
  EXPECT_FALSE(std::get<PointImages>(stamp.data).mask.has_value());
  EXPECT_THAT(std::get<PointImages>(stamp.data).position, ElementsAre(std::array<double, 2>{0.001, 0.002}));

  const Measurement air = Bench("measurement: uniform_press\n", "press,pressure_kPa,r0_c0,r0_c1\n1,20,8,7\n1,20,9,7\n").load();
  EXPECT_THAT(std::get<UniformPress>(air.data).pressure, ElementsAre(20e3, 20e3));
  EXPECT_THAT(std::get<UniformPress>(air.data).press, ElementsAre(1, 1));
  EXPECT_THAT(std::get<UniformPress>(air.data).images.counts, ElementsAre(8, 7, 9, 7));

  const Measurement warm = Bench("measurement: force_curve\ntemperature_degC: -3.5\n", "taxel,force_N,counts\n0,0.5,100\n").load();
  EXPECT_EQ(warm.temperature, -3.5);
  EXPECT_FALSE(air.temperature.has_value());
}

TEST(MeasurementFile, RejectsBadMeasurements) {
  const std::string step = "measurement: step_response\nload: 2\n", point = "measurement: point_images\n";
  const std::string pin = "indenter: {flat_pin: {radius_mm: 0.5}}\n";
  const std::vector<std::tuple<std::string, std::string, std::string>> table = {
      {"measurement: guess\n", "a\n1\n", ":4:14: measurement: guess is not allowed"},
      {"measurement: step_response\n", "time_s,counts\n0,1\n", "load is missing"},
      {"measurement: step_response\nload: -2\n", "time_s,counts\n0,1\n", "load: -2 is not allowed"},
      {step + pin, "time_s,counts\n0,1\n", "indenter: not a key of step_response"},
      {step, "time_s\n0\n", "table.csv:1:1: missing column of the output: counts"},
      {step, "time_s,counts\n0,1\n0,2\n", "table.csv:3:1: time_s: 0 s is not allowed: must be later than the previous row (0 s)"},
      {step, "time_s,counts\n0,8191\n", "table.csv:2:3: counts: 8191 is not allowed: 0 to 8190 counts"},
      {step, "time_s,counts\n0,-1\n", "table.csv:2:3: counts: -1 is not allowed"},
      {"measurement: force_curve\n", "taxel,force_N,counts\n2,1,1\n", "table.csv:2:1: taxel: 2 is not allowed: a whole number from 0 to 1"},
      {"measurement: force_curve\n", "taxel,force_N,counts\n0.5,1,1\n", "table.csv:2:1: taxel: 0.5 is not allowed"},
      {"measurement: force_curve\ncurve_segments: 1\n", "taxel,force_N,counts\n0,1,1\n",
       ":5:17: curve_segments: 1 is not allowed: a whole number from 2 to 16"},
      {"measurement: force_curve\ncurve_segments: 17\n", "taxel,force_N,counts\n0,1,1\n", "curve_segments: 17 is not allowed"},
      {"measurement: force_curve\ncurve_segments: 4\ncurve_degree: 2\n", "taxel,force_N,counts\n0,1,1\n",
       ":6:15: curve_degree: not allowed together with `curve_segments`"},
      {"measurement: force_curve\ndivider: true\ncurve_segments: 4\n", "taxel,force_N,counts\n0,1,1\n",
       ":5:10: divider: not allowed together with `curve_segments`"},
      {step + "curve_segments: 4\n", "time_s,counts\n0,1\n", "curve_segments: not a key of step_response"},
      {"measurement: force_curve\n", "taxel,force_N,counts\n0,1,4096\n", "counts: 4096 is not allowed: 0 to 4095 counts"},
      {"measurement: force_depth\n", "depth_mm,force_N\n0,1\n", "indenter is missing"},
      {"measurement: force_depth\nindenter: {}\n", "depth_mm,force_N\n0,1\n", "flat_pin, stamp, sphere, cylinder or cone"},
      {"measurement: force_depth\nindenter: {sphere: {radius_mm: 1}, cone: {half_angle_deg: 30}}\n", "depth_mm,force_N\n0,1\n",
       "a second shape is given"},
      {"measurement: force_depth\nindenter: {sphere: {radius_mm: 0}}\n", "depth_mm,force_N\n0,1\n", "radius_mm: 0 is not allowed"},
      {"measurement: force_depth\nindenter: {sphere: {radius: 1, length: 1}}\n", "depth_mm,force_N\n0,1\n", "length"},
      {point + pin, "x_mm,y_mm,r0_c0\n0,0,1\n", "missing column of taxel 1"},
      {point + pin, "x_mm,r0_c0,r0_c1\n0,0,1\n", "missing column of the position along y"},
      {"measurement: footprint_images\n", "r0_c0,r0_c1\n0,1\n", "indenter is missing"},
      {"measurement: footprint_images\nmask: mask.csv\n", "r0_c0,r0_c1\n0,1\n", "pixel[_mm] is missing"},
      {"measurement: footprint_images\npixel_mm: 1\n" + pin, "r0_c0,r0_c1\n0,1\n", "pixel_mm: needs a `mask`"},
      {"measurement: footprint_images\nmask: mask.csv\npixel_mm: 1\n" + pin, "r0_c0,r0_c1\n0,1\n", "give only one of them"},
      {"measurement: footprint_images\nmask: none.csv\npixel_mm: 1\n", "r0_c0,r0_c1\n0,1\n", "none.csv"},
      {"measurement: footprint_images\nmask: empty.csv\npixel_mm: 1\n", "r0_c0,r0_c1\n0,1\n", "empty.csv: no pixel above 0"},
      {"measurement: footprint_images\nmask: ragged.csv\npixel_mm: 1\n", "r0_c0,r0_c1\n0,1\n",
       "ragged.csv:2:1: 1 pixels are not allowed: the first row has 2"},
      {"measurement: footprint_images\nmask: mask.csv\npixel_mm: 0\n", "r0_c0,r0_c1\n0,1\n", "pixel_mm: 0 is not allowed"},
      {"measurement: footprint_images\nposition_error: -1\n" + pin, "r0_c0,r0_c1\n0,1\n", "position_error: -1 is not allowed"},
      {"measurement: footprint_images\n" + pin, "x_mm,r0_c0,r0_c1\n0,0,1\n", "x and y are given together or not at all"},
      {"measurement: uniform_press\n" + pin, "r0_c0,r0_c1\n0,1\n", "indenter: not a key of uniform_press"},
      {"measurement: uniform_press\n", "pressure_Pa,r0_c0,r0_c1\n0,1,1\n", "table.csv:2:1: pressure_Pa: 0 is not allowed: above 0 Pa"},
      {"measurement: uniform_press\n", "press,r0_c0,r0_c1\n0.5,1,1\n", "press: 0.5 is not allowed: a whole number"},
      {"measurement: uniform_press\ntemperature_degC: 20\n", "r0_c0,r0_c1\n0,1\n", "temperature_degC: not a key of uniform_press"},
      {"measurement: force_curve\ntemperature_degC: 400\n", "taxel,force_N,counts\n0,1,1\n",
       "temperature_degC: 400 is not allowed: a number from -100 to 300 degrees Celsius"},
      {"measurement: stamp_images\nload: 1\nindenter: {sphere: {radius_mm: 1}}\n", "time_s,r0_c0,r0_c1\n0,0,1\n",
       "stamp_images need a flat indenter"},
      {"measurement: stamp_images\nload: 1\n" + pin, "r0_c0,r0_c1\n0,1\n", "missing column of the time"},
  };
  for (const auto& [keys, text, message] : table) {
    EXPECT_THAT(Bench(keys, text).refused(), HasSubstr(message)) << keys << text;
  }
}

// Sections compared with the closed forms of the solids.
TEST(Indenter, SectionsAreThoseOfTheSolid) {
  using Shape = Indenter::Shape;
  constexpr double kPi = std::numbers::pi, kRounding = 1e-15;
  EXPECT_NEAR((Indenter{.shape = Shape::kFlatPin, .radius = 2}.sectionAt(0)), 4 * kPi, 1e-14);
  EXPECT_NEAR((Indenter{.shape = Shape::kStamp, .size = {2, 3}}.sectionAt(1)), 6, kRounding);
  EXPECT_NEAR((Indenter{.shape = Shape::kSphere, .radius = 5}.sectionAt(1)), 9 * kPi, 1e-14) << "radius 3 at depth 1: 3^2 + 4^2 = 5^2";
  EXPECT_NEAR((Indenter{.shape = Shape::kSphere, .radius = 5}.sectionAt(7)), 25 * kPi, 1e-13)
      << "deeper than the radius: the largest section";
  EXPECT_NEAR((Indenter{.shape = Shape::kCylinder, .radius = 5, .length = 2}.sectionAt(2)), 16, 1e-14)
      << "half width 4 at depth 2: 4^2 + 3^2 = 5^2";
  EXPECT_NEAR((Indenter{.shape = Shape::kCone, .half_angle = kPi / 4}.sectionAt(3)), 9 * kPi, 1e-13);
}

}  // namespace
}  // namespace taxelsim
