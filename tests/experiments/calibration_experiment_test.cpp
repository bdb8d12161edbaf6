// The paper's calibration with a pin: closed forms of springs, and files that are refused.
#include "support/input_error.h"
#include "support/temporary_directory.h"
#include "support/test.h"
#include "taxelsim/device.h"
#include "taxelsim/error.h"
#include "taxelsim/experiment.h"

namespace taxelsim::testing {
namespace {

constexpr double kStiffness = 2.5e8, kPitch = 3.4e-3, kRadius = 1.5e-3;  // N/m^3, m, m
constexpr double kSlope = 1500, kTrigger = 0.1;                          // counts/N, N
// The disc of the pin has 156 samples; a row of samples along its border is 7 % of its width, half of it at most is too much or too little.
constexpr double kSampled = 0.04;
constexpr double kFloat = 1e-3;  // of depths of 0.2 mm: float32 heights of 0.2 um

const std::string kFile = R"(format_version: 1
name: pin
experiment: calibration
sensors:
  - name: pad
    num_rows: 3
    num_cols: 4
    pitch_mm: 3.4
    samples_per_taxel: 16
    skin: {thickness_mm: 2, law: winkler, normal_contact_stiffness: 2.5e8}
    psf: {kernel: [[0, 1, 0], [1, 4, 1], [0, 1, 0]]}
    readout: {curve: {counts_per_newton: 1500}, trigger: 0.1}
pin_radius_mm: 1.5
taxels: [0, 5]
places: 3
depths_mm: [0.2, 0.5, 1]
loads: [0.5, 1.5, 1000]
measured:
  force_at_depth: [{depth_mm: 1, force: 2}]
  counts_at_force: [{force: 0.5, counts: 400}]
)";

CalibrationExperiment loaded(const std::string& text) {
  const TemporaryDirectory directory;
  std::ofstream(directory / "pin.yaml") << text;
  return std::get<CalibrationExperiment>(loadExperiment(directory / "pin.yaml"));
}

std::string replaced(const std::string& part, const std::string& by) {
  std::string text = kFile;
  const std::size_t at = text.find(part);
  if (at == std::string::npos) throw std::runtime_error("not in the file: " + part);
  return text.replace(at, part.size(), by);
}

TEST(CalibrationExperiment, ReadsEverySetting) {
  const CalibrationExperiment experiment = loaded(kFile);
  EXPECT_EQ(experiment.name, "pin");
  ASSERT_EQ(experiment.sensors.size(), 1u);
  EXPECT_EQ(experiment.sensors[0].name, "pad");
  EXPECT_DOUBLE_EQ(experiment.pin_radius, kRadius);
  EXPECT_EQ(experiment.taxels, (std::vector<int>{0, 5}));
  EXPECT_EQ(experiment.places, 3);
  EXPECT_EQ(experiment.numPlaces(), 9u);
  EXPECT_THAT(experiment.depths, ::testing::ElementsAre(0.2e-3, 0.5e-3, 1e-3));
  EXPECT_EQ(experiment.loads, (std::vector<double>{0.5, 1.5, 1000}));
  ASSERT_EQ(experiment.measured_forces.size(), 1u);
  EXPECT_EQ(experiment.measured_forces[0].depth, experiment.depths[2]);
  EXPECT_EQ(experiment.measured_forces[0].force, 2);
  ASSERT_EQ(experiment.measured_counts.size(), 1u);
  EXPECT_EQ(experiment.measured_counts[0].counts, 400);
  EXPECT_EQ(loaded(replaced("places: 3\n", "")).places, 7);
}

TEST(CalibrationExperiment, SpringsCarryTheAreaOfThePin) {
  const CalibrationExperiment experiment = loaded(kFile);
  const CalibrationCurves curves = runCalibrationExperiment(Device::open(), experiment).front();
  EXPECT_EQ(curves.name, "pad");
  ASSERT_EQ(curves.forces.size(), 27u);
  // Taxel 0 is in a corner: a third of a pitch from its middle towards -x or -y, a segment of the pin is off the array.
  const double to_border = kPitch / 2 - kPitch / 3;
  const double segment =
      kRadius * kRadius * std::acos(to_border / kRadius) - to_border * std::sqrt(kRadius * kRadius - to_border * to_border);
  const double disc = std::numbers::pi * kRadius * kRadius;
  for (std::size_t d = 0; d < 3; ++d) {
    const double per_area = kStiffness * experiment.depths[d];
    const double* at = &curves.forces[9 * d];
    for (const std::size_t inside : {4, 5, 7, 8}) EXPECT_NEAR(at[inside] / (per_area * disc), 1, kSampled) << inside;
    for (const std::size_t cut : {1, 2, 3, 6}) EXPECT_NEAR(at[cut] / (per_area * (disc - segment)), 1, kSampled) << cut;
    EXPECT_LT(at[0], at[1]);
    for (std::size_t p = 0; p < 9; ++p) EXPECT_NEAR(at[p] / curves.forces[p], experiment.depths[d] / experiment.depths[0], 5 * kFloat);
  }
}

// A taxel keeps 4 of 8 parts of a force, a corner 4 of 6.
TEST(CalibrationExperiment, CountsFollowSpreadAndReadout) {
  const CalibrationCurves curves = runCalibrationExperiment(Device::open(), loaded(kFile)).front();
  ASSERT_EQ(curves.counts.size(), 6u);
  const double loads[] = {0.5, 1.5}, shares[] = {4.0 / 6, 0.5};
  for (std::size_t load = 0; load < 2; ++load) {
    for (std::size_t taxel = 0; taxel < 2; ++taxel) {
      EXPECT_NEAR(curves.shares[2 * load + taxel], shares[taxel], kFloat);
      EXPECT_NEAR(curves.counts[2 * load + taxel], kSlope * (shares[taxel] * loads[load] - kTrigger), 1 + kSlope * loads[load] * kFloat);
    }
  }
  for (std::size_t out_of_reach = 4; out_of_reach < 6; ++out_of_reach) {
    EXPECT_TRUE(std::isnan(curves.counts[out_of_reach]));
    EXPECT_TRUE(std::isnan(curves.shares[out_of_reach]));
  }
}

// The paper's points, and springs with the stiffness that its pin has: right on average over the places.
// Springs with the stiffness of figure 6b give its forces at every place of the taxel.
TEST(CalibrationExperiment, OfThePaper) {
  constexpr double kEverywhere = 1e-3;  // of the force: 2.546 has four digits, and the pin's outline is rounded by 0.1 um
  auto experiment =
      std::get<CalibrationExperiment>(loadExperiment(std::string(TAXELSIM_SOURCE_DIR) + "/scenes/experiments/paper/calibration.yaml"));
  ASSERT_EQ(experiment.sensors.front().name, "wts0614_pin");
  experiment.sensors.resize(1);
  const CalibrationCurves curves = runCalibrationExperiment(Device::open(), experiment).front();
  ASSERT_EQ(experiment.measured_forces.size(), 2u);
  for (const auto& [depth, force] : experiment.measured_forces) {
    const auto at = std::find(experiment.depths.begin(), experiment.depths.end(), depth) - experiment.depths.begin();
    const auto first = curves.forces.begin() + at * static_cast<std::ptrdiff_t>(experiment.numPlaces());
    for (std::size_t place = 0; place < static_cast<std::size_t>(experiment.numPlaces()); ++place) {
      EXPECT_NEAR(first[static_cast<std::ptrdiff_t>(place)] / force, 1, kEverywhere) << depth << " m, place " << place;
    }
  }
}

TEST(CalibrationExperiment, Refusals) {
  const std::pair<std::pair<const char*, const char*>, const char*> cases[] = {
      {{"calibration", "pins"}, ":3:13: experiment: pins is not allowed: static | servo | calibration"},
      {{"experiment: calibration\n", ""}, "experiment is missing: static | servo | calibration"},
      {{"    num_rows: 3\n    num_cols: 4\n    pitch_mm: 3.4\n",
        "    patches:\n      - {num_rows: 1, num_cols: 2, pitch_mm: 3, pose: {rpy_deg: [0, 5, 0]}}\n"},
       "pad is not allowed: only sensors with one level grid"},
      {{"winkler, normal_contact_stiffness", "proximity, sensitivity"}, "pad is not allowed: the law proximity has no force"},
      {{"pin_radius_mm: 1.5", "pin_radius_mm: 0"}, ":13:16: pin_radius_mm: 0 is not allowed: a number > 0 mm"},
      {{"[0, 5]", "[12]"}, ":14:10: taxels[0]: 12 is not allowed: a number from 0 to 11"},
      {{"[0, 5]", "[1.5]"}, ":14:9: taxels: 1.5 is not allowed: a whole number from 0 to 11"},
      {{"places: 3", "places: 4"}, ":15:9: places: 4 is not allowed: an odd number"},
      {{"places: 3", "places: 33"}, ":15:9: places: 33 is not allowed: a whole number from 1 to 31"},
      {{"0.5, 1]", "1, 0.5]"}, ":16:12: depths_mm: the values do not ascend"},
      {{"0.5, 1]", "0.5, 2.1]"}, ":16:12: depths_mm: 0.0021 m is deeper than the skin of pad, 0.002 m"},
      {{"[0.5, 1.5, 1000]", "[]"}, "loads"},
      {{"depth_mm: 1,", "depth_mm: 0.7,"}, "7e-04 m is not one of `depths`"},
      {{"force: 0.5,", "force: 0.6,"}, "0.6 N is not one of `loads`"},
      {{"counts: 400", "counts: -1"}, "counts: -1 is not allowed: a number >= 0"},
      {{"measured:", "zebra: 1\nmeasured:"}, "zebra"},
  };
  for (const auto& [change, message] : cases) {
    EXPECT_THAT(support::inputError([&] { loaded(replaced(change.first, change.second)); }), ::testing::HasSubstr(message));
  }
}

}  // namespace
}  // namespace taxelsim::testing
