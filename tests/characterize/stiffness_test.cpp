// Stiffness fitted to closed forms of indenters on an elastic foundation.
#include "bench_session.h"
#include "characterize/estimates.h"
#include "support/input_error.h"
#include "support/test.h"
#include "taxelsim/characterize.h"
#include "taxelsim/error.h"

namespace taxelsim::testing {
namespace {

using support::estimateOf;

using ::testing::HasSubstr;

constexpr double kStiffness = 1.6e8;  // N/m^3
constexpr double kOffset = 0.21e-3;   // m
constexpr double kPi = std::numbers::pi;

struct Case {
  const char* name;
  Indenter indenter;
  double (*volume)(double);  // m^3 displaced by the indenter at this depth (m)
};

// Volumes of the solids' caps, from textbooks.
const std::vector<Case> kCases{
    {"flat_pin", {.shape = Indenter::Shape::kFlatPin, .radius = 0.5e-3}, [](double d) { return kPi * 0.25e-6 * d; }},
    {"stamp", {.shape = Indenter::Shape::kStamp, .size = {2e-3, 3e-3}}, [](double d) { return 6e-6 * d; }},
    {"sphere", {.shape = Indenter::Shape::kSphere, .radius = 4e-3}, [](double d) { return kPi * d * d * (4e-3 - d / 3); }},
    {"cylinder",
     {.shape = Indenter::Shape::kCylinder, .radius = 3e-3, .length = 5e-3},
     [](double d) {
       constexpr double r = 3e-3;
       return 5e-3 * (r * r * std::acos(1 - d / r) - (r - d) * std::sqrt(2 * r * d - d * d));
     }},
    {"cone", {.shape = Indenter::Shape::kCone, .half_angle = kPi / 4}, [](double d) { return kPi * d * d * d / 3; }},
};

ForceDepth pressed(const Case& with, double noise, std::mt19937& random) {
  ForceDepth data{.indenter = with.indenter, .depth = {}, .force = {}};
  std::normal_distribution<double> gaussian;
  for (int k = 0; k < 50; ++k) {
    const double depth = 0.03e-3 * k, pressed = depth - kOffset;
    data.depth.push_back(depth);
    data.force.push_back((pressed > 0 ? kStiffness * with.volume(pressed) : 0) + noise * gaussian(random));
  }
  return data;
}

Characterization characterized(ForceDepth data) {
  const std::vector<Measurement> measurements{measurementOf("press", benchSensor(1, 1), std::move(data))};
  return characterize(measurements);
}

// Without noise the errors are those of the quadrature and of the solver's tolerance, 1e-10 of a parameter.
TEST(StiffnessFit, FindsTheStiffnessOfClosedForms) {
  constexpr double kExact = 1e-6;
  for (const Case& with : kCases) {
    SCOPED_TRACE(with.name);
    std::mt19937 random(1);
    const Characterization result = characterized(pressed(with, 0, random));
    EXPECT_NEAR(std::get<Winkler>(result.sensor.skin.law).normal_contact_stiffness / kStiffness, 1, kExact);
    EXPECT_NEAR(estimateOf(result, "press.contact_offset").value / kOffset, 1, kExact);
    EXPECT_FALSE(estimateOf(result, "skin.thickness").determined);
  }
}

TEST(StiffnessFit, IntervalsCoverTheTruthAtTheirLevel) {
  constexpr int kRuns = 60;
  for (const Case& with : kCases) {
    SCOPED_TRACE(with.name);
    int stiffness = 0, offset = 0;
    for (unsigned seed = 0; seed < kRuns; ++seed) {
      std::mt19937 random(seed);
      const double noise = 0.01 * kStiffness * with.volume(1.2e-3);
      const Characterization result = characterized(pressed(with, noise, random));
      const Estimate& k = estimateOf(result, "skin.normal_contact_stiffness");
      const Estimate& d = estimateOf(result, "press.contact_offset");
      stiffness += k.low <= kStiffness && kStiffness <= k.high;
      offset += d.low <= kOffset && kOffset <= d.high;
    }
    EXPECT_GE(stiffness, leastHits(kRuns));
    EXPECT_GE(offset, leastHits(kRuns));
  }
}

TEST(StiffnessFit, AcceptsDecreasingDepthsAndOutliers) {
  std::mt19937 random(2);
  ForceDepth data = pressed(kCases[2], 0.001, random);
  for (int k = 49; k >= 0; --k) {
    data.depth.push_back(data.depth[static_cast<std::size_t>(k)]);
    data.force.push_back(data.force[static_cast<std::size_t>(k)]);
  }
  for (std::size_t row = 3; row < data.force.size(); row += 12) data.force[row] += 5;
  const Characterization result = characterized(data);
  EXPECT_EQ(result.fits.front().num_outliers, 9u);
  EXPECT_NEAR(std::get<Winkler>(result.sensor.skin.law).normal_contact_stiffness / kStiffness, 1, 0.01);
}

TEST(StiffnessFit, RejectsUninformativeMeasurements) {
  const auto refused = [](ForceDepth data, Sensor sensor = benchSensor(1, 1)) -> std::string {
    return support::refusal([&] {
      const std::vector<Measurement> measurements{measurementOf("press", std::move(sensor), std::move(data))};
      characterize(measurements);
    });
  };
  std::mt19937 random(3);
  const Indenter pin = kCases[0].indenter;
  EXPECT_THAT(refused({.indenter = pin, .depth = {1e-3}, .force = {1}}), HasSubstr("press.yaml: no press"));
  EXPECT_THAT(refused({.indenter = pin, .depth = {1e-3, 2e-3}, .force = {1, 2}}), HasSubstr("press.yaml: 2 rows found, at least 5 needed"));
  EXPECT_THAT(refused({.indenter = pin, .depth = {1e-3, 2e-3, 3e-3}, .force = {0, 0, 0}}), HasSubstr("press.yaml: no press"));
  Sensor layer = benchSensor(1, 1);
  layer.skin.law = ElasticLayer{.elastic_modulus = 1e6};
  EXPECT_THAT(refused(pressed(kCases[0], 0, random), layer), HasSubstr("press.yaml: force_depth needs a sensor with skin.law winkler"));
}

}  // namespace
}  // namespace taxelsim::testing
