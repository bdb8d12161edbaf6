// Contact features do not depend on batch, workgroup or other outputs, and are held between the frames of the sensor.
#include "simulation/comparison.h"
#include "simulation/contact_feature_images.h"
#include "support/input_error.h"
#include "support/random_scene.h"
#include "support/test.h"
#include "taxelsim/error.h"

namespace taxelsim {
namespace {

using support::kContactFeatures;
using support::kImageStep;
using support::press;
using support::Random;
using support::randomImage;

std::vector<std::vector<std::uint32_t>> bitsUnder(const Model& model, const std::vector<std::vector<double>>& forces) {
  const int n = static_cast<int>(forces.size());
  Simulator simulator(model, {.num_instances = n, .outputs = kContactFeatures, .max_contacts = 3000, .max_regions = 5});
  return support::bitsOfAll(press(simulator, forces), n);
}

TEST(ContactFeaturesOnEveryDriver, IndependentOfBatchAndWorkgroup) {
  Sensor sensor = support::gridSensor({.num_rows = 23, .num_cols = 31, .pitch_x = 1e-3, .pitch_y = 1e-3});
  support::addPatch(sensor, {{0.03, 0, 0}, axisAngle({0, 1, 0}, 0.1)});
  sensor.psf = gaussianPsf(0.6, 3);
  Random random(9);
  std::vector<std::vector<double>> forces;
  for (int i = 0; i < 11; ++i) forces.push_back(randomImage(random, sensor));
  const auto modelWith = [&](int workgroup) { return Model(support::sharedDevice(), {.sensor = sensor, .image_workgroup = workgroup}); };
  const Model model = modelWith(0);
  const auto expected = bitsUnder(model, forces);
  for (const int workgroup : {4, 16, 256}) EXPECT_EQ(bitsUnder(modelWith(workgroup), forces), expected) << workgroup;
  for (std::size_t i = 0; i < forces.size(); ++i) EXPECT_EQ(bitsUnder(model, {forces[i]})[0], expected[i]) << i;
}

TEST(ContactFeaturesOnEveryDriver, MeasuredFeaturesAreHeldBetweenSensorFrames) {
  Sensor sensor = support::gridSensor();
  sensor.frame_rate = 50;
  Simulator simulator = support::makeSimulator(sensor, {Object(Sphere{0.005})}, {.outputs = kContactFeatures, .max_regions = 1});
  std::vector<std::vector<std::uint32_t>> measured;
  std::vector<float> clean;
  for (const double depth : {0.5e-3, 0.7e-3, 0.9e-3}) {
    const FrameView frame = support::stepOnce(simulator, {{{0}, {{.position = {0, 0, 0.005 - depth}}}}}, 0.01);
    measured.push_back(support::measuredBitsOf(frame, 0, 1));
    clean.push_back(frame.ground_truth.contact.total_force[0]);
  }
  EXPECT_EQ(measured[0], measured[1]);
  EXPECT_NE(measured[1], measured[2]);
  EXPECT_NE(clean[0], clean[1]);
}

TEST(ContactFeaturesOnEveryDriver, EmptyUnlessRequested) {
  const Model model(support::sharedDevice(), {.sensor = support::gridSensor(), .objects = {Object(Sphere{0.005})}});
  Simulator without(model, {}), with(model, {.outputs = {.contact_features = true}});
  for (Simulator* simulator : {&without, &with}) {
    support::setTouches(*simulator, {{{0}, {{.position = {0, 0, 0.0045}}}}});
    simulator->step(kImageStep);
  }
  const FrameView a = without.read(), b = with.read();
  EXPECT_EQ(a.contact.num_rows, 0);
  EXPECT_TRUE(a.contact.total_force.empty());
  EXPECT_EQ(b.contact.num_rows, 2);
  EXPECT_EQ(b.contact.num_patches, 1);
  EXPECT_TRUE(b.ground_truth.contact.total_force.empty());
  FrameView rest = b;
  rest.contact = {};
  EXPECT_EQ(support::bitsOf(a, 0, 1), support::bitsOf(rest, 0, 1));
  EXPECT_GT(Simulator::plan(model, {.outputs = {.contact_features = true}}).bytes_per_instance,
            Simulator::plan(model, {}).bytes_per_instance);
}

TEST(ContactFeaturesOnEveryDriver, RejectsInvalidMaxRegions) {
  const Model model(support::sharedDevice(), {.sensor = support::gridSensor(), .objects = {Object(Sphere{0.005})}});
  for (const SimulatorOptions& options :
       {SimulatorOptions{.outputs = kContactFeatures, .max_regions = -1}, SimulatorOptions{.outputs = kContactFeatures, .max_regions = 9},
        SimulatorOptions{.max_regions = 1}}) {
    EXPECT_THAT(support::inputError([&] { Simulator simulator(model, options); }),
                ::testing::HasSubstr("max_regions: " + std::to_string(options.max_regions)));
  }
}

}  // namespace
}  // namespace taxelsim
