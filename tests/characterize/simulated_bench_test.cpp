// Round trip through the simulator: a known sensor is simulated on a bench, `characterize` fits a sensor to the measurements, and both are
// pressed where the fit has not seen them. Prints the table of docs/notes/validation.md.
#include "characterize/simulated_bench.h"
#include "base/median.h"
#include "reference/psf.h"
#include "support/temporary_directory.h"
#include "support/test.h"
#include "taxelsim/characterize.h"
#include "taxelsim/compare.h"
#include "taxelsim/stiffness.h"

namespace taxelsim::testing {
namespace {

constexpr double kStiffness = 2.5e8;  // N/m^3

struct Trial {
  BenchPlace place;
  double load;  // N
};

// Objects, places, angles and loads that no measurement has. A trial is the object, the load, then the place.
std::vector<Trial> trials() {
  std::vector<Trial> all;
  for (const auto& [object, least, most] :
       {std::tuple{BenchObject::kSquare, 3.0, 8.0}, {BenchObject::kBall, 1.0, 3.0}, {BenchObject::kRidge, 2.0, 5.0}}) {
    for (const double load : {least, most}) {
      all.push_back({{object, {-1.3e-3, 0.7e-3}, 0.4}, load});
      all.push_back({{object, {1.9e-3, -2.6e-3}, 1.2}, load});
    }
  }
  return all;
}
constexpr std::size_t kNumObjects = 3, kTrialsPerObject = 4;

// (num_trials), without noise.
std::vector<std::vector<float>> imagesOf(Sensor sensor) {
  sensor.readout.noise = 0;
  const SimulatedBench bench(sensor);
  std::vector<std::vector<float>> images;
  for (const Trial& trial : trials()) images.push_back(bench.press({trial.place}, {trial.load})[0].counts);
  return images;
}

// M4 of images against those of the truth, one per trial.
struct Errors {
  std::vector<double> values;

  double median() const { return medianOf(values); }
  double worst() const { return *std::max_element(values.begin(), values.end()); }
  double medianOfObject(std::size_t object) const {
    const auto first = values.begin() + static_cast<std::ptrdiff_t>(object * kTrialsPerObject);
    return medianOf(std::vector<double>(first, first + kTrialsPerObject));
  }
};

void printRow(const std::string& name, const Errors& errors) {
  std::printf("%-30s", name.c_str());
  for (std::size_t object = 0; object < kNumObjects; ++object) std::printf(" %8.1f", 100 * errors.medianOfObject(object));
  std::printf(" %8.1f %8.1f\n", 100 * errors.median(), 100 * errors.worst());
}

struct RoundTrip {
  Sensor truth, fitted;
  Errors model, nothing, stamp;
};

RoundTrip roundTrip(const std::string& name, const Sensor& truth) {
  const TemporaryDirectory directory;
  const Characterization found = characterize(SimulatedBench(truth).measure(benchPrior(), directory.path()));
  // Through the file, as a user does.
  std::ofstream(directory / "fitted.yaml") << sensorText(found.sensor);
  RoundTrip trip{.truth = truth, .fitted = loadSensor(directory / "fitted.yaml"), .model = {}, .nothing = {}, .stamp = {}};
  const auto real = imagesOf(truth), simulated = imagesOf(trip.fitted);
  for (std::size_t k = 0; k < real.size(); ++k) {
    const auto errorOf = [&](const std::vector<float>& image) { return compareImages(truth, real[k], truth, image).relative_l1; };
    trip.model.values.push_back(errorOf(simulated[k]));
    trip.nothing.values.push_back(errorOf(std::vector<float>(real[k].size(), 0)));
    trip.stamp.values.push_back(errorOf(uniformStamp(truth, trials()[k].place, trials()[k].load)));
  }
  std::printf("%-30s %8s %8s %8s %8s %8s\n", "M4, %", "square", "ball", "ridge", "median", "worst");
  printRow(name, trip.model);
  printRow("  zero image", trip.nothing);
  printRow("  uniform stamp", trip.stamp);
  std::printf("  %.4g N/m^3\n", foundationOf(trip.fitted.skin).normal_contact_stiffness);
  return trip;
}

// Counts per newton of each taxel under a force on it, spread included: a fit may divide them otherwise between gains and spread.
std::vector<double> responses(const Sensor& sensor) {
  std::vector<double> values;
  for (std::size_t t = 0; t < sensor.readout.taxel_gain.size(); ++t) {
    std::vector<double> force(sensor.readout.taxel_gain.size());
    force[t] = 1;
    const double slope = sensor.readout.output_scale * sensor.readout.curve[0] * sensor.readout.taxel_gain[t];
    values.push_back(slope * reference::spread(sensor, force)[t]);
  }
  return values;
}

// 17 readings with a standard deviation of 2 counts, over 2 N: 0.2 %; five times that.
constexpr double kResponse = 0.01;

void expectSameResponses(const RoundTrip& trip) {
  const std::vector<double> real = responses(trip.truth), fitted = responses(trip.fitted);
  ASSERT_EQ(fitted.size(), real.size());
  for (std::size_t t = 0; t < real.size(); ++t) EXPECT_NEAR(fitted[t] / real[t], 1, kResponse) << "taxel " << t;
}

void expectErrors(const RoundTrip& trip, double median, double worst) {
  EXPECT_LT(trip.model.median(), median);
  EXPECT_LT(trip.model.worst(), worst);
  for (std::size_t k = 0; k < trip.model.values.size(); ++k) {
    EXPECT_EQ(trip.nothing.values[k], 1) << "trial " << k;
    EXPECT_LT(trip.model.values[k], trip.stamp.values[k]) << "trial " << k;
  }
}

// The fit covers areas exactly, the simulator by samples. A row of samples is 7 % of the pin's width: where the border of a taxel cuts the
// pin, the force on either side is off by up to half a row, 3.5 %, a third of that on average.
constexpr double kMedianOfSprings = 0.015, kWorstOfSprings = 0.025;
// A disc of 7 samples radius has its area within 3 %; the mean over places is within a third of it.
constexpr double kStiffnessOfSprings = 0.01;

void expectSprings(const RoundTrip& trip) {
  expectSameResponses(trip);
  expectErrors(trip, kMedianOfSprings, kWorstOfSprings);
  EXPECT_NEAR(foundationOf(trip.fitted.skin).normal_contact_stiffness / kStiffness, 1, kStiffnessOfSprings);
}

TEST(SimulatedBench, Winkler) {
  expectSprings(roundTrip("winkler", benchTruth(Winkler{.normal_contact_stiffness = kStiffness})));
}

TEST(SimulatedBench, MassSpringDamper) {
  expectSprings(roundTrip("mass_spring_damper", benchTruth(MassSpringDamper{.normal_contact_stiffness = kStiffness})));
}

TEST(SimulatedBench, Proximity) {
  expectSprings(roundTrip("proximity", benchTruth(Proximity{.sensitivity = kStiffness})));
}

TEST(SimulatedBench, LuGre) {
  expectSprings(roundTrip("lugre", benchTruth(LuGre{.normal_contact_stiffness = kStiffness})));
}

// Mask and spread together reach two taxels; the fit has one kernel for both.
TEST(SimulatedBench, DeformationMask) {
  const RoundTrip trip = roundTrip("deformation_mask", benchTruth(DeformationMask{.normal_contact_stiffness = kStiffness}));
  EXPECT_EQ(trip.fitted.psf.size, 5);
  expectErrors(trip, 2 * kMedianOfSprings, 2 * kWorstOfSprings);
  EXPECT_NEAR(foundationOf(trip.fitted.skin).normal_contact_stiffness / kStiffness, 1, kStiffnessOfSprings);
}

// No area stiffness describes a layer under all contacts: the fit keeps that of the pin, and what springs lack adds to their errors above.
TEST(SimulatedBench, ElasticLayer) {
  constexpr double kModulus = 0.5e6, kPoissonRatio = 0.49;
  constexpr double kMedian = 0.04, kWorst = 0.06;
  constexpr double kPinStiffness = 0.06;  // of a layer under a pin with 7 samples along its radius
  const Sensor truth = benchTruth(ElasticLayer{.elastic_modulus = kModulus, .poisson_ratio = kPoissonRatio});
  const RoundTrip trip = roundTrip("elastic_layer", truth);
  expectSameResponses(trip);
  expectErrors(trip, kMedian, kWorst);
  const double depth = 1e-4, area = std::numbers::pi * kPinRadius * kPinRadius;
  const double of_pin = pinForce(truth.skin, 2 * kPinRadius, depth) / (area * depth);
  EXPECT_NEAR(foundationOf(trip.fitted.skin).normal_contact_stiffness / of_pin, 1, kPinStiffness);
}

}  // namespace
}  // namespace taxelsim::testing
