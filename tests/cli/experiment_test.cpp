// `experiment`: distances computed by hand, a fit that recovers its reference, outputs, and refusals.
#include "taxelsim/experiment.h"

#include <nlohmann/json.hpp>

#include "cli/command_line.h"
#include "support/test.h"

namespace taxelsim::testing {
namespace {

using ::testing::HasSubstr;

const std::string kScenes = std::string(TAXELSIM_SOURCE_DIR) + "/scenes";

// An experiment with a bar and a ball; `reference` and `sensors` are inserted as given.
std::string experimentText(const std::string& reference, const std::string& sensors,
                           const std::string& rest = "yaw_deg: [0, 45]\nloads: [1, 4]\n") {
  return "format_version: 1\nname: small\nexperiment: static\nreference: " + reference + "\nsensors: " + sensors +
         "\nobjects:\n  - {name: ball, sphere: {radius_mm: 10}}\n  - {name: bar, box: {size_mm: [5, 30, 20]}}\n" + rest;
}

std::filesystem::path written(const TemporaryDirectory& root, const std::string& name, const std::string& text) {
  std::ofstream(root / name) << text;
  return root / name;
}

std::string shipped(const std::string& name) {
  return kScenes + "/sensors/" + name + ".yaml";
}

TEST(ImageDistance, ByHand) {
  // Taxel 0 has no force in either image and is ignored by the median; the others differ by 1, 2, 3.
  const ImageDistance distance = imageDistance({0, 1, 4, 3}, {0, 2, 2, 6}, 0.5, 10);
  EXPECT_DOUBLE_EQ(distance.median_difference, 0.2);
  EXPECT_DOUBLE_EQ(distance.relative_l1, 0.6);
  EXPECT_EQ(imageDistance({0, 0}, {0, 0}, 0.5, 10).median_difference, 0);
  EXPECT_EQ(imageDistance({1, 2}, {1, 2}, 0.5, 10).relative_l1, 0);
  // The median of an even number is the mean of the middle two.
  EXPECT_DOUBLE_EQ(imageDistance({1, 1}, {2, 4}, 0.5, 1).median_difference, 2);
}

TEST(ExperimentStudy, FitRecoversTheReferenceSensor) {
  const TemporaryDirectory root;
  // A softer skin with another spread than the shipped sensor, from which the fit starts.
  std::string text = contentOf(shipped("wts0614_soft_cover"));
  const auto replace = [&](const std::string& from, const std::string& to) { text.replace(text.find(from), from.size(), to); };
  replace("normal_contact_stiffness: 1.73e8", "normal_contact_stiffness: 0.70e8");
  replace("sigma: 0.5", "sigma: 0.7");
  written(root, "soft.yaml", text);
  const std::filesystem::path file = written(
      root, "x.yaml", experimentText("soft.yaml", "[{sensor: " + shipped("wts0614_soft_cover") + ", fitted: true}, {sensor: soft.yaml}]"));
  const nlohmann::json json = jsonOf({"experiment", file, "--json"});
  const nlohmann::json& fitted = json["sensors"][0];
  constexpr double kFound = 0.02;  // size of the simplex after its evaluations, of the logarithms
  EXPECT_EQ(fitted["sensor"], "wts0614_soft_cover_fitted");
  EXPECT_NEAR(std::log(fitted["normal_contact_stiffness"].get<double>() / 0.7e8), 0, kFound);
  EXPECT_NEAR(std::log(fitted["psf_sigma"].get<double>() / 0.7), 0, kFound);
  for (const auto& median : fitted["medians"]) EXPECT_LT(median["relative_l1"].get<double>(), kFound);
  for (const auto& contact : json["sensors"][1]["contacts"]) EXPECT_EQ(contact["relative_l1"], 0) << "the same sensor";
  ASSERT_EQ(fitted["contacts"].size(), 8u);
  for (const auto& contact : fitted["contacts"]) {
    double sum = 0;
    for (const auto& force : contact["tactile_normal_force"]) sum += force.get<double>();
    EXPECT_NEAR(sum, contact["load"].get<double>(), 1e-3 * sum) << "every image carries its load";
  }
}

TEST(Experiment, TableAndPictures) {
  const TemporaryDirectory root;
  const std::filesystem::path file =
      written(root, "x.yaml",
              experimentText(shipped("wts0614_soft_cover"),
                             "[{sensor: " + shipped("wts0614_deformation_mask") + "}, {sensor: " + shipped("wts0614_proximity") + "}]"));
  const Outcome outcome = succeed({"experiment", file, "-o", root / "figures"});
  EXPECT_THAT(outcome.out, HasSubstr("wts0614_deformation_mask"));
  EXPECT_THAT(outcome.out, HasSubstr("M4"));
  EXPECT_THAT(outcome.out, HasSubstr("Reference: images of wts0614_soft_cover, simulated by the law winkler"));
  EXPECT_THAT(outcome.out, HasSubstr("medians over the\ncontacts of ball, bar\n")) << "no fit, so all count: " << outcome.out;
  EXPECT_THAT(outcome.out, HasSubstr("\nall-zero image "));
  EXPECT_THAT(outcome.out, HasSubstr("\nuniform image "));
  EXPECT_THAT(outcome.err, HasSubstr("info: wrote 4 figures to " + (root / "figures").string()));
  for (const char* name : {"bar_1N.png", "bar_4N.png", "ball_1N.png", "ball_4N.png"}) {
    EXPECT_TRUE(contentOf(root / "figures" / name).starts_with("\x89PNG")) << name;
  }
}

TEST(Experiment, OfFingertips) {
  const TemporaryDirectory root;
  const std::filesystem::path file = written(
      root, "x.yaml",
      experimentText(shipped("fingertip_cylinder"), "[{sensor: " + shipped("fingertip_cylinder") + "}]", "yaw_deg: [0]\nloads: [1]\n"));
  const nlohmann::json json = jsonOf({"experiment", file, "-o", root / "figures", "--json"});
  for (const auto& contact : json["sensors"][0]["contacts"]) EXPECT_EQ(contact["relative_l1"], 0);
  ASSERT_EQ(json["baselines"].size(), 2u);
  const nlohmann::json &zero = json["baselines"][0]["medians"][0], &uniform = json["baselines"][1]["medians"][0];
  EXPECT_DOUBLE_EQ(zero["relative_l1"].get<double>(), 1);
  EXPECT_GT(zero["median_difference"].get<double>(), 0);
  EXPECT_GT(uniform["relative_l1"].get<double>(), 0.5);
  EXPECT_LT(uniform["relative_l1"].get<double>(), 2);
  EXPECT_TRUE(contentOf(root / "figures" / "bar_1N.png").starts_with("\x89PNG"));
  written(root, "x.yaml",
          experimentText(shipped("digitacts_6x4"), "[{sensor: " + shipped("digitacts_6x4") + "}]", "yaw_deg: [0]\nloads: [1]\n"));
  const Outcome none = succeed({"experiment", file, "-o", root / "none"});
  EXPECT_THAT(none.err, HasSubstr("warning: no figures: a sensor with several grids cannot be drawn"));
  written(root, "x.yaml", experimentText(shipped("fingertip_cylinder"), "[{sensor: " + shipped("fingertip_cylinder") + ", fitted: true}]"));
  expectRefused(runTaxelsim({"experiment", file}), "only sensors whose point spread function is a kernel over grids can be fitted");
}

TEST(ExperimentStudy, EveryImageOfTheShippedOneHasActiveTaxels) {
  const nlohmann::json json = jsonOf({"experiment", kScenes + "/experiments/paper/static_indenters.yaml", "--json"});
  std::size_t num_images = 0;
  for (const auto& sensor : json["sensors"]) {
    for (const auto& contact : sensor["contacts"]) {
      double most = 0;
      for (const auto& force : contact["tactile_normal_force"]) most = std::max(most, force.get<double>());
      EXPECT_GT(most, 0.02) << sensor["sensor"] << " " << contact["object"];  // N: the trigger of wts0614_soft_cover.yaml
      ++num_images;
    }
  }
  EXPECT_GE(num_images, 6u * 3 * 2);
}

TEST(Experiment, CalibrationTablesAndPicture) {
  const TemporaryDirectory root;
  const std::filesystem::path file =
      written(root, "x.yaml",
              "format_version: 1\nname: pin\nexperiment: calibration\nsensors: [" + shipped("wts0614_soft_cover") +
                  "]\npin_radius_mm: 1.5\ntaxels: [39, 0]\nplaces: 3\ndepths_mm: [0.5, 1]\nloads: "
                  "[0.5, 1000]\nmeasured:\n  force_at_depth: [{depth_mm: 1, force: 2}]\n  "
                  "counts_at_force: [{force: 0.5, counts: 700}, {force: 1000, counts: 800}]\n");
  const Outcome outcome = succeed({"experiment", file, "-o", root / "figures"});
  const auto has = [&](const char* part) { EXPECT_NE(outcome.out.find(part), std::string::npos) << part << "\n" << outcome.out; };
  has("pin: a flat pin of 3 mm diameter on 9 places of taxel 39 and in the middles of 2 taxels\n");
  has("\nwts0614_soft_cover                       1      2.00      ");
  has("\nwts0614_soft_cover                     0.5       700       ");
  has("\nwts0614_soft_cover                    1000       800         -         -         -         -\n");
  has("\nwts0614_soft_cover: 2 of 4 presses on the middles of taxels do not reach their load");
  EXPECT_THAT(outcome.err, HasSubstr("info: wrote 1 figure to " + (root / "figures").string()));
  EXPECT_TRUE(contentOf(root / "figures" / "calibration.png").starts_with("\x89PNG"));
  const Outcome json_outcome = runTaxelsim({"experiment", file, "--json"});
  const nlohmann::json json = nlohmann::json::parse(json_outcome.out);
  ASSERT_EQ(json["sensors"].size(), 1u);
  EXPECT_EQ(json["sensors"][0]["forces"].size(), 18u);
  ASSERT_EQ(json["sensors"][0]["counts"].size(), 4u);
  EXPECT_GT(json["sensors"][0]["counts"][0].get<double>(), 0);
  EXPECT_TRUE(json["sensors"][0]["counts"][3].is_null());
}

TEST(Experiment, Refusals) {
  const TemporaryDirectory root;
  const std::string sensor = "[{sensor: " + shipped("wts0614_soft_cover") + "}]";
  const auto refused = [&](const std::string& text, const std::string& part) {
    expectRefused(runTaxelsim({"experiment", written(root, "x.yaml", text)}), part);
  };
  refused(experimentText("missing.yaml", sensor), "x.yaml:4:12: reference: ");
  refused(experimentText(shipped("wts0614_soft_cover"), "[]"), "x.yaml:5:10: sensors");
  refused(experimentText(shipped("wts0614_soft_cover"), "[{sensor: " + shipped("digitacts_6x4") + "}]"), "taxels, the reference 84");
  refused(experimentText(shipped("wts0614_soft_cover"), "[{sensor: " + shipped("wts0614_proximity") + ", fitted: true}]"),
          "only sensors of law winkler can be fitted");
  refused(experimentText(shipped("wts0614_soft_cover"), "[{sensor: " + shipped("wts0614_soft_cover") + ", fitted: perhaps}]"),
          "fitted: perhaps is not allowed: true | false");
  std::string one_indenter =
      experimentText(shipped("wts0614_soft_cover"), "[{sensor: " + shipped("wts0614_soft_cover") + ", fitted: true}]");
  one_indenter.erase(one_indenter.find("  - {name: bar"), one_indenter.find("yaw") - one_indenter.find("  - {name: bar"));
  refused(one_indenter, "objects: has 1 indenter: a sensor with fitted: true needs 2");
  refused(experimentText(shipped("wts0614_soft_cover"), sensor, "yaw: [0]\nloads: [-1]\n"), "loads");
  refused(experimentText(shipped("wts0614_soft_cover"), sensor, "yaw: []\nloads: [1]\n"), "yaw");
  refused(experimentText(shipped("wts0614_soft_cover"), sensor, "yaw: [0]\n"), "loads is missing");
  refused(experimentText(shipped("wts0614_soft_cover"), sensor, "yaw: [0]\nloads: [1e6]\n"), "out of reach");
  refused(experimentText(shipped("wts0614_soft_cover"), sensor) + "zebra: 1\n", "unknown key");
  expectRefused(runTaxelsim({"experiment", root / "none.yaml"}), "none.yaml");
}

// Without the recordings the experiment is skipped, with one line and no error; no device is needed.
TEST(Experiment, SkipsRecordingsThatAreNotThere) {
  const Outcome outcome = succeed({"experiment", kScenes + "/experiments/recordings/tams.yaml", "--device", "none"});
  EXPECT_EQ(outcome.out, "");
  EXPECT_THAT(outcome.err, HasSubstr("tams: skipped, no recordings: "));
}

TEST(Experiment, PredictsRecordingsInAFolder) {
  const TemporaryDirectory root;
  std::filesystem::create_directory(root.path() / "data");
  std::string table = "taxel,force_N,counts\n";
  for (int k = 0; k < 100; ++k) table += "0," + std::to_string(0.02 * k) + "," + std::to_string(20 * k + k % 3) + "\n";
  written(root, "data/a.csv", table);
  const std::string head = "format_version: 1\nname: mine\nexperiment: characterization\ndata: data\n";
  const std::string common =
      "common: {measurement: force_curve, sensor: {name: s, num_rows: 1, num_cols: 1, pitch_mm: 3, skin: {thickness_mm: 1, "
      "normal_contact_stiffness: 1e8}, readout: {curve: {counts_per_newton: 1000}}}}\n";
  const Outcome outcome = succeed({"experiment", written(root, "x.yaml", head + common + "recordings: [{table: a.csv}]\n")});
  EXPECT_THAT(outcome.out, HasSubstr("a, first part"));
  // A table that is not there is named in one line; the others are run.
  const Outcome some =
      succeed({"experiment", written(root, "x.yaml", head + common + "recordings: [{table: b.csv}, {table: a.csv}, {table: c.csv}]\n")});
  EXPECT_EQ(some.out.substr(0, some.out.find("longest")), outcome.out.substr(0, outcome.out.find("longest")));
  EXPECT_THAT(some.err, HasSubstr("/data has no b.csv and 1 more of the tables"));
  const Outcome none = succeed({"experiment", written(root, "x.yaml", head + common + "recordings: [{table: b.csv}]\n")});
  EXPECT_EQ(none.out, "");
  EXPECT_THAT(none.err, HasSubstr("mine: skipped, no recordings: "));
  const auto refused = [&](const std::string& text, const std::string& part) {
    expectRefused(runTaxelsim({"experiment", written(root, "x.yaml", text)}), part);
  };
  refused(head + common + "recordings: []\n", "a list of 1 to 1000 recordings");
  refused(head + common + "recordings: [{divider: true}]\n", "table is missing");
  refused(head + common + "recordings: [{table: a.csv, lod: 1}]\n", "lod");
  refused(head + "common: 3\nrecordings: [{table: a.csv}]\n", "common");
  refused(head + common + "light_below: 0\nrecordings: [{table: a.csv}]\n", "light_below");
}

}  // namespace
}  // namespace taxelsim::testing
