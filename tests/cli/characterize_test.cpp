// `characterize` on the shipped measurements, which were simulated with known parameters.
#include <nlohmann/json.hpp>

#include "cli/command_line.h"
#include "cli/picture.h"
#include "support/test.h"
#include "taxelsim/sensor.h"

namespace taxelsim::testing {
namespace {

using Json = nlohmann::json;
using ::testing::HasSubstr;

const std::string kMeasurements = TAXELSIM_SOURCE_DIR "/scenes/measurements/";

std::vector<std::string> characterized(const std::vector<std::string>& names, const std::string& sensor,
                                       const std::vector<std::string>& more = {}) {
  std::vector<std::string> arguments{"characterize", "-o", sensor};
  for (const std::string& name : names) arguments.push_back(kMeasurements + name + ".yaml");
  arguments.insert(arguments.end(), more.begin(), more.end());
  return arguments;
}

const Json& estimateOf(const Json& json, const std::string& parameter) {
  for (const Json& estimate : json["estimates"]) {
    if (estimate["parameter"] == parameter) return estimate;
  }
  throw std::runtime_error("no estimate of " + parameter);
}

std::string scatterText(double scatter) {
  char text[16];
  std::snprintf(text, sizeof text, "%.4g", scatter);
  return text;
}

// Standard deviation of the logarithm of the gains of live taxels, to four digits.
std::string scatterOfGains(const Sensor& sensor) {
  std::vector<double> logs;
  double mean = 0, squares = 0;
  for (const double gain : sensor.readout.taxel_gain) {
    if (gain > 0) logs.push_back(std::log(gain));
  }
  for (const double value : logs) mean += value / static_cast<double>(logs.size());
  for (const double value : logs) squares += (value - mean) * (value - mean);
  return scatterText(std::sqrt(squares / static_cast<double>(logs.size() - 1)));
}

// TRUTH of scripts/make_measurements.py.
TEST(Characterize, RecoversTheParametersOfTheShippedMeasurements) {
  const TemporaryDirectory directory;
  const Json json = jsonOf(characterized({"force_curve", "force_depth", "point_images", "step_response", "stamp_3N", "stamp_6N"},
                                         directory / "s.yaml", {"--json", "--report", directory / "r.html"}));
  const std::vector<std::pair<std::string, double>> truths{{"readout.curve.counts_per_newton", 2310},
                                                           {"readout.trigger", 0.031},
                                                           {"readout.saturation", 3840},
                                                           {"readout.noise", 6},
                                                           {"skin.normal_contact_stiffness", 1.61e8},
                                                           {"force_depth.contact_offset", 0.212e-3},
                                                           {"psf.gaussian.sigma", 0.6}};
  for (const auto& [parameter, truth] : truths) {
    const Json& estimate = estimateOf(json, parameter);
    ASSERT_TRUE(estimate["determined"].get<bool>()) << parameter;
    // Of seven 95 % intervals of one bench one may miss; none by more than half its width, four standard deviations from the middle.
    const double low = estimate["low"], high = estimate["high"];
    EXPECT_GE(truth, low - (high - low) / 2) << parameter;
    EXPECT_LE(truth, high + (high - low) / 2) << parameter;
  }
  EXPECT_EQ(json["dead_taxels"], Json({40}));
  const Sensor sensor = loadSensor(directory / "s.yaml");
  EXPECT_EQ(sensor.readout.saturation, 3840);
  EXPECT_EQ(sensor.readout.taxel_gain[40], 0);
  EXPECT_EQ(sensor.readout.creep.size(), 2u) << "from the step response, not from the stamps";
  EXPECT_GT(Picture(directory / "r_output_over_time_under_a_constant_load_2.png").width(), 100) << "from the stamps";
  EXPECT_THAT(contentOf(directory / "s.yaml"), HasSubstr("saturation: 3840  # 3840 counts, plateau in the output"));
}

// A pressure film and an air cushion alone: spread and gains.
TEST(Characterize, RecoversSpreadAndGainsWithoutALoadCell) {
  const TemporaryDirectory directory;
  const Json json = jsonOf(characterized({"footprint_images", "uniform_press"}, directory / "s.yaml", {"--json"}));
  const Json &sigma = estimateOf(json, "psf.gaussian.sigma"), &spread = estimateOf(json, "readout.press_gain_spread");
  EXPECT_NEAR(sigma["value"].get<double>(), 0.6, 0.02);
  EXPECT_LT(spread["low"].get<double>(), 0.174);
  EXPECT_GT(spread["high"].get<double>(), 0.174);
  EXPECT_EQ(json["dead_taxels"], Json({40}));
  // With images of points: gains near the border depend on the spread.
  succeed(characterized({"force_curve", "point_images"}, directory / "line.yaml"));
  const std::vector<double> gains = loadSensor(directory / "s.yaml").readout.taxel_gain,
                            by_curves = loadSensor(directory / "line.yaml").readout.taxel_gain;
  // 4 % in five presses is 1.8 %; four times that.
  for (std::size_t t = 0; t < gains.size(); ++t) EXPECT_NEAR(gains[t], by_curves[t], 0.075) << t;
}

TEST(Characterize, RefusesATemperatureThatNoMeasurementHas) {
  const TemporaryDirectory directory;
  expectRefused(runTaxelsim(characterized({"force_curve"}, directory / "s.yaml", {"--temperature", "40"})),
                "--temperature: the measurements have no temperature_degC");
  EXPECT_FALSE(std::filesystem::exists(directory / "s.yaml"));
}

TEST(Characterize, WritesAnArrayOfTheSameKind) {
  const TemporaryDirectory directory;
  succeed(characterized({"force_curve"}, directory / "one.yaml"));
  succeed(characterized({"force_curve"}, directory / "kind.yaml", {"--random-gains"}));
  const Sensor one = loadSensor(directory / "one.yaml"), kind = loadSensor(directory / "kind.yaml");
  EXPECT_TRUE(kind.readout.taxel_gain.empty());
  EXPECT_EQ(scatterText(kind.readout.gain_spread), scatterOfGains(one));
  EXPECT_THAT(contentOf(directory / "kind.yaml"), HasSubstr("# standard deviation of the logarithm of the fitted gains"));
  expectRefused(runTaxelsim(characterized({"force_depth"}, directory / "none.yaml", {"--random-gains"})),
                "--random-gains: the measurements determine the gains of fewer than two taxels");
  EXPECT_FALSE(std::filesystem::exists(directory / "none.yaml"));
}

TEST(Characterize, ReportIsSelfContained) {
  const TemporaryDirectory directory;
  std::vector<std::string> arguments = characterized({"force_curve", "force_depth"}, directory / "s.yaml");
  const std::string report = directory / "r\" onerror=\"x.html";
  arguments.insert(arguments.end(), {"--name", "mine", "--report", report});
  const Outcome outcome = succeed(arguments);
  EXPECT_THAT(outcome.out, HasSubstr("skin.normal_contact_stiffness"));
  EXPECT_THAT(outcome.err, HasSubstr("info: wrote " + (directory / "s.yaml").string() + "\n"));
  EXPECT_THAT(outcome.err, HasSubstr("info: wrote " + report + " and 3 figures in its folder\n"));
  EXPECT_THAT(outcome.out, HasSubstr("standard deviation of their logarithm: " + scatterOfGains(loadSensor(directory / "s.yaml"))));
  EXPECT_THAT(outcome.out, HasSubstr("taxels without a response: 40"));
  EXPECT_EQ(loadSensor(directory / "s.yaml").name, "mine");
  const std::string page = contentOf(report);
  EXPECT_THAT(page, HasSubstr("Characterisation of mine"));
  EXPECT_THAT(page, HasSubstr("<img alt=\"r&quot; onerror=&quot;x_gain_map\"")) << "the name stays inside the attribute";
  EXPECT_THAT(page, HasSubstr("data:image/png;base64,iVBORw0KGgo")) << "signature of a PNG";
  EXPECT_THAT(page, ::testing::Not(::testing::HasSubstr("http")));
  EXPECT_THAT(page, ::testing::Not(::testing::HasSubstr(" nan")));
  for (const char* picture : {"output_against_force_all_taxels.png", "force_against_penetration_depth.png", "gain_map.png"}) {
    EXPECT_GT(Picture(directory / (std::string("r\" onerror=\"x_") + picture)).width(), 100) << picture;
  }
}

// The shipped force curves are straight, and so are the pieces.
TEST(Characterize, WritesACurveOfStraightPieces) {
  const TemporaryDirectory directory;
  std::ofstream(directory / "pieces.yaml") << "format_version: 1\nmeasurement: force_curve\nsensor: " TAXELSIM_SOURCE_DIR
                                              "/scenes/sensors/wts0614_soft_cover.yaml\ncurve_segments: 4\ntable: force_curve.csv\n";
  std::filesystem::copy_file(kMeasurements + "force_curve.csv", directory / "force_curve.csv");
  const Outcome outcome = succeed({"characterize", directory / "pieces.yaml", "-o", directory / "s.yaml"});
  EXPECT_THAT(outcome.out, HasSubstr("readout.curve.points[3].counts"));
  succeed(characterized({"force_curve"}, directory / "line.yaml"));
  const double slope = loadSensor(directory / "line.yaml").readout.curve[0];
  const Sensor sensor = loadSensor(directory / "s.yaml");
  ASSERT_EQ(sensor.readout.curve_points.size(), 4u);
  for (const CurvePoint& point : sensor.readout.curve_points) EXPECT_NEAR(point.counts / point.force, slope, 0.01 * slope) << point.force;
  EXPECT_THAT(contentOf(directory / "s.yaml"), ::testing::ContainsRegex("points: .*  # [0-9.]+ .*, at 0.*; .*, at 1"));
}

TEST(Characterize, IsReproducible) {
  const TemporaryDirectory directory;
  for (const char* name : {"a.yaml", "b.yaml"}) ASSERT_EQ(runTaxelsim(characterized({"force_depth"}, directory / name)).status, 0);
  EXPECT_EQ(contentOf(directory / "a.yaml"), contentOf(directory / "b.yaml"));
}

TEST(Characterize, RejectsBadInputWithoutWriting) {
  const TemporaryDirectory directory;
  const std::string sensor = directory / "s.yaml";
  const auto write = [&](const std::string& name, const std::string& text) { std::ofstream(directory / name) << text; };
  expectRefused(runTaxelsim(characterized({"none"}, sensor)), "none.yaml");
  expectRefused(runTaxelsim({"characterize", "-o", sensor}), "measurements is required");
  expectRefused(runTaxelsim({"characterize", kMeasurements + "force_depth.yaml"}), "--output is required");
  // Another sensor than the first measurement's.
  write("t.csv", "depth_mm,force_N\n0,0\n1,1\n");
  write("m.yaml", "format_version: 1\nmeasurement: force_depth\nsensor: " TAXELSIM_SOURCE_DIR
                  "/scenes/sensors/cea_list.yaml\ntable: t.csv\nindenter: {flat_pin: {radius_mm: 0.5}}\n");
  expectRefused(runTaxelsim(characterized({"force_depth"}, sensor, {directory / "m.yaml"})), "m.yaml: names another sensor than");
  write("n.csv", "depth_mm,force_N\n0,0\n1,nan\n");
  write("n.yaml", "format_version: 1\nmeasurement: force_depth\nsensor: " TAXELSIM_SOURCE_DIR
                  "/scenes/sensors/wts0614_soft_cover.yaml\ntable: n.csv\nindenter: {flat_pin: {radius_mm: 0.5}}\n");
  expectRefused(runTaxelsim({"characterize", directory / "n.yaml", "-o", sensor}), "n.csv:3:3: force_N: \"nan\" is not allowed");
  write("u.yaml", "format_version: 1\nzebra: 1\n");
  const Outcome unknown = runTaxelsim({"characterize", directory / "u.yaml", "-o", sensor});
  expectRefused(unknown, "u.yaml:2:1: zebra: unknown key; allowed: format_version, measurement");
  EXPECT_EQ(unknown.err.find("indenter"), unknown.err.rfind("indenter")) << "every key once\n" << unknown.err;
  EXPECT_FALSE(std::filesystem::exists(sensor));
}

TEST(Characterize, CrossValidationPrintsItsVerdictFirst) {
  const TemporaryDirectory directory;
  const Outcome outcome = succeed(
      characterized({"force_curve", "stamp_3N", "stamp_6N"}, directory / "s.yaml", {"--cross-validate", "--report", directory / "r.html"}));
  EXPECT_THAT(outcome.out, ::testing::StartsWith("left-out loads: this set cannot be cross-validated by stamps: "));
  EXPECT_THAT(outcome.out, HasSubstr("\nleft-out cycles or halves: "));
  EXPECT_THAT(outcome.out, HasSubstr("line in the force per taxel"));
  const std::string page = contentOf(directory / "r.html");
  EXPECT_LT(page.find("left-out loads: "), page.find("<h2>Parameters"));
  expectRefused(runTaxelsim({"characterize", kMeasurements + "step_response.yaml", "-o", directory / "s.yaml", "--cross-validate"}),
                "cross-validation needs measurements of kind stamp_images or force_curve");
  expectRefused(runTaxelsim({"characterize", kMeasurements + "stamp_3N.yaml", "-o", directory / "s.yaml", "--light-below", "2"}),
                "--light-below");
}

}  // namespace
}  // namespace taxelsim::testing
