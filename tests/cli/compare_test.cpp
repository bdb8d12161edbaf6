// `compare`: measurements and data sets, with table, JSON, figure and refusals.
#include <nlohmann/json.hpp>

#include "cli/command_line.h"
#include "cli/picture.h"
#include "cli/pressed_pad.h"
#include "cli/small_pad.h"
#include "support/test.h"
#include "taxelsim/dataset.h"

namespace taxelsim::testing {
namespace {

using ::testing::HasSubstr;
using ::testing::Not;
using Json = nlohmann::json;

constexpr double kRounding = 1e-12;  // of a dozen operations in double on values of order 1

class Compare : public ::testing::Test {
 protected:
  Compare() { write("pad.yaml", kSmallPad); }

  std::string at(const std::string& name) const { return root_ / name; }
  void write(const std::string& name, const std::string& text) const { std::ofstream(at(name)) << text; }

  // A measurement `name`.yaml and its table.
  std::string images(const std::string& name, const std::string& table, const std::string& sensor = "pad.yaml") const {
    write(name + ".csv", table);
    write(name + ".yaml", "format_version: 1\nmeasurement: images\nsensor: " + sensor + "\ntable: " + name + ".csv\n");
    return at(name + ".yaml");
  }

  static Json jsonOf(const std::vector<std::string>& arguments) {
    const Outcome outcome = succeed(arguments);
    EXPECT_THAT(outcome.out, Not(HasSubstr("nan")));
    return Json::parse(outcome.out, nullptr, /*allow_exceptions=*/false);
  }

 private:
  TemporaryDirectory root_;
};

// Five taxels are active, with differences of 100, 50, 300, 10 and 40 counts; full scale is 1023.
const std::string kReal = kSmallPadColumns + "400,300,0,0,10,200\n";
const std::string kSimulated = kSmallPadColumns + "300,350,300,0,0,240\n";

TEST_F(Compare, ByHand) {
  const Json json = jsonOf({"compare", images("real", kReal), images("sim", kSimulated), "--json"});
  ASSERT_EQ(json["pairs"].size(), 1u);
  const Json& pair = json["pairs"][0];
  EXPECT_NEAR(pair["M1_median_difference"], 50 / 1023.0, kRounding);
  EXPECT_NEAR(pair["M2_mean_difference"], 100 / 1023.0, kRounding);
  EXPECT_NEAR(pair["M3_rms_difference"], std::sqrt(104200 / 6.0) / 400, kRounding);
  EXPECT_NEAR(pair["M4_relative_l1"], 500 / 910.0, kRounding);
  EXPECT_NEAR(pair["M5_cosine"], 273000 / std::sqrt(290100 * 360100.0), kRounding);
  EXPECT_EQ(json["all"]["M4_relative_l1"]["median"], pair["M4_relative_l1"]);
  EXPECT_NEAR(pair["real"]["total_force"], 0.91, kRounding) << "1000 counts / N";
  EXPECT_NEAR(pair["force_difference"], 0.28, kRounding);
  EXPECT_EQ(json["full_scale"], 1023);

  const Outcome table = succeed({"compare", at("real.yaml"), at("sim.yaml")});
  for (const char* part : {"M1  median difference", "4.888", "M2 ", "M3 ", "M4 ", "54.95", "M5 ", "0.8447", "0.91", "1.19", "0.28"}) {
    EXPECT_THAT(table.out, HasSubstr(part));
  }
}

TEST_F(Compare, OneImageAgainstSeveral) {
  const std::string several = kSmallPadColumns + "400,300,0,0,10,200\n0,0,0,0,0,0\n300,350,300,0,0,240\n";
  for (const bool one_is_real : {true, false}) {
    std::vector<std::string> sides{images("one", kReal), images("several", several)};
    if (!one_is_real) std::swap(sides[0], sides[1]);
    const Json json = jsonOf({"compare", sides[0], sides[1], "--json"});
    ASSERT_EQ(json["pairs"].size(), 3u);
    EXPECT_EQ(json["pairs"][2][one_is_real ? "real_row" : "simulated_row"], 0);
    EXPECT_EQ(json["pairs"][2][one_is_real ? "simulated_row" : "real_row"], 2);
    EXPECT_EQ(json["pairs"][0]["M4_relative_l1"], 0);
    const Json& all = json["all"]["M5_cosine"];
    EXPECT_EQ(all["pairs"], 2) << "an all-zero image has none";
    EXPECT_NEAR(all["highest"], 1, kRounding);
    EXPECT_NEAR(all["median"], (1 + all["lowest"].get<double>()) / 2, kRounding);
  }
}

TEST_F(Compare, UndefinedValuesAreNull) {
  const std::string empty = images("empty", kSmallPadColumns + "0,0,0,0,0,0\n");
  const Json json = jsonOf({"compare", empty, images("sim", kSimulated), "--json"});
  const Json& pair = json["pairs"][0];
  for (const char* key : {"M3_rms_difference", "M4_relative_l1", "M5_cosine", "center_distance", "angle_difference"}) {
    EXPECT_TRUE(pair.at(key).is_null()) << key;
    EXPECT_TRUE(json["all"][key]["median"].is_null()) << key;
  }
  EXPECT_TRUE(pair["real"].at("center_of_pressure").is_null());
  EXPECT_TRUE(pair["real"].at("edge_angle").is_null());
  EXPECT_EQ(pair["real"]["total_force"], 0);
  const Outcome table = succeed({"compare", empty, empty, "-o", at("empty.png")});
  EXPECT_THAT(table.out, Not(HasSubstr("nan")));
}

TEST_F(Compare, AtSelectsATimeAfterContact) {
  const std::string recorded =
      "time_s," + kSmallPadColumns + "0,0,0,0,0,0,0\n1,0,0,0,0,0,10\n2,0,0,0,0,0,900\n4.1,400,300,0,0,10,200\n6,0,0,0,0,0,0\n";
  const std::string real = images("recorded", recorded), sim = images("sim", kReal);
  const Json json = jsonOf({"compare", real, sim, "--at", "2", "--json"});
  ASSERT_EQ(json["pairs"].size(), 1u);
  EXPECT_EQ(json["pairs"][0]["real_time"], 4.1) << "contact is at 2 s: 10 counts are less than 5 % of 910";
  EXPECT_EQ(json["pairs"][0]["M4_relative_l1"], 0);
  expectRefused(runTaxelsim({"compare", real, sim, "--at", "9"}), "recorded.yaml: 9 s after contact is out of range");
  expectRefused(runTaxelsim({"compare", sim, sim, "--at", "2"}), "--at: neither");
}

// A data set whose scene has no sensor uses that of the measurement.
TEST_F(Compare, DataSetWithoutASensor) {
  writePressedPad(at("data"));
  const DatasetReader reader(at("data"));
  std::string heading, values;
  for (int t = 0; t < 84; ++t) heading += (t > 0 ? ",r" : "r") + std::to_string(t / 14) + "_c" + std::to_string(t % 14);
  for (const double value : reader.readAsDouble("data/tactile_image", 2, 1)) values += (values.empty() ? "" : ",") + std::to_string(value);
  const std::string real =
      images("frame", heading + "\n" + values + "\n", std::string(TAXELSIM_SOURCE_DIR) + "/scenes/sensors/wts0614_soft_cover.yaml");
  const Json json = jsonOf({"compare", real, at("data"), "--json"});
  ASSERT_EQ(json["pairs"].size(), reader.numFrames());
  EXPECT_EQ(json["pairs"][2]["M1_median_difference"], 0);
  EXPECT_GT(json["pairs"][1]["M1_median_difference"], 0);
  expectRefused(runTaxelsim({"compare", at("data"), at("data")}), "neither names its sensor");
  expectRefused(runTaxelsim({"compare", at("data"), images("sim", kReal)}), "has 84 taxels");
}

TEST_F(Compare, DataSetsOfOneScene) {
  write("scene.yaml", std::string("format_version: 1\nname: pressed\nkind: contacts\nsensor: ") + TAXELSIM_SOURCE_DIR +
                          "/scenes/sensors/wts0614_soft_cover.yaml\nobjects: [{sphere: {radius_mm: 10}}]\nrandomization: {load: [1, 3]}\n");
  for (const char* seed : {"1", "2"}) {
    succeed({"generate", at("scene.yaml"), "-o", at(seed), "--episodes", "3", "--seed", seed});
  }
  const Json same = jsonOf({"compare", at("1"), at("1"), "--json"}), other = jsonOf({"compare", at("1"), at("2"), "--json"});
  EXPECT_EQ(same["all"]["M4_relative_l1"]["highest"], 0);
  EXPECT_EQ(same["all"]["center_distance"]["highest"], 0);
  EXPECT_GT(other["all"]["M4_relative_l1"]["lowest"], 0);
  EXPECT_GT(same["pairs"][0]["real"]["total_force"], 0.5) << "by the sensor of the scene";
}

TEST_F(Compare, Picture) {
  const Outcome outcome = succeed({"compare", images("real", kReal), images("sim", kSimulated), "-o", at("pair.png")});
  EXPECT_EQ(outcome.err, "info: wrote " + at("pair.png") + "\n");
  const Picture picture(at("pair.png"));
  const Picture::Spot largest = picture.of(0xfde725), more = picture.of(0xb5372b), nothing = picture.of(0xeeeff1);
  EXPECT_LT(largest.left, picture.width() / 3) << "400 counts, the most of all, on the real side";
  EXPECT_GT(more.count, 100) << "300 counts too many";
  EXPECT_GT(more.left, picture.width() / 2) << "in the third panel";
  EXPECT_GT(nothing.count, 100) << "no difference";
  const Outcome refused = runTaxelsim({"compare", at("real.yaml"), at("sim.yaml"), "-o", at("none/pair.png")});
  EXPECT_EQ(refused.status, 1) << refused.err;
  EXPECT_EQ(std::count(refused.err.begin(), refused.err.end(), '\n'), 1);
}

TEST_F(Compare, RejectsDifferentArrays) {
  const std::string real = images("real", kReal);
  const std::string two = images("two", kReal + "1,2,3,4,5,6\n"), three = images("three", kReal + "1,2,3,4,5,6\n1,2,3,4,5,6\n");
  expectRefused(runTaxelsim({"compare", two, three}), "two.yaml has 2 images");
  const Outcome one = runTaxelsim({"compare", real, two});
  EXPECT_THAT(one.out, HasSubstr("real.yaml: 1 image of 2 x 3 taxels"));
  EXPECT_THAT(one.out, HasSubstr("two.yaml: 2 images of 2 x 3 taxels"));
  std::string turned = kSmallPad;
  turned.replace(turned.find("num_rows: 2\nnum_cols: 3"), 23, "num_rows: 3\nnum_cols: 2");
  write("turned.yaml", turned);
  const std::string other = images("other", "r0_c0,r0_c1,r1_c0,r1_c1,r2_c0,r2_c1\n0,0,0,0,0,0\n", "turned.yaml");
  expectRefused(runTaxelsim({"compare", real, other}), "real.yaml has 2 x 3 taxels");
  expectRefused(runTaxelsim({"compare", real, images("nan", kSmallPadColumns + "nan,0,0,0,0,0\n")}), "nan.csv:2:1");
  expectRefused(runTaxelsim({"compare", real, images("few", "r0_c0,r0_c1\n0,0\n")}), "missing column of taxel 2");
  expectRefused(runTaxelsim({"compare", real, at("none.yaml")}), "none.yaml");
  write("curve.csv", "taxel,force_N,counts\n0,1,100\n");
  write("curve.yaml", "format_version: 1\nmeasurement: force_curve\nsensor: pad.yaml\ntable: curve.csv\n");
  expectRefused(runTaxelsim({"compare", real, at("curve.yaml")}), "a measurement without images");
}

}  // namespace
}  // namespace taxelsim::testing
