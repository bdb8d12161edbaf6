// Contact features do not depend on batch, workgroup or other outputs, and are held between the frames of the sensor.
#include "simulation/comparison.h"
#include "simulation/contact_feature_images.h"
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

std::vector<std::uint32_t> bitsOf(const ContactFeatureView& view, int instance) {
  std::vector<std::uint32_t> bits{static_cast<std::uint32_t>(view.num_regions[instance])};
  for (const auto& [values, width] : std::vector<std::pair<std::span<const float>, std::size_t>>{{view.total_force, 1},
                                                                                                 {view.peak_force, 1},
                                                                                                 {view.center_of_pressure, 3},
                                                                                                 {view.second_moments, 3},
                                                                                                 {view.eigenvalues, 2},
                                                                                                 {view.edge_angle, 1},
                                                                                                 {view.edge_confidence, 1},
                                                                                                 {view.contact_area, 1},
                                                                                                 {view.windowed_edge_angle, 1},
                                                                                                 {view.windowed_edge_confidence, 1},
                                                                                                 {view.tilt, 2},
                                                                                                 {view.tilt_confidence, 1}}) {
    const std::size_t per_instance = static_cast<std::size_t>(view.num_rows) * width;
    for (const float value : values.subspan(static_cast<std::size_t>(instance) * per_instance, per_instance)) {
      bits.push_back(std::bit_cast<std::uint32_t>(value));
    }
  }
  const auto first = static_cast<std::size_t>(instance * view.num_rows), num_rows = static_cast<std::size_t>(view.num_rows);
  for (const ContactType type : view.contact_type.subspan(first, num_rows)) bits.push_back(static_cast<std::uint32_t>(type));
  for (const std::int32_t patch : view.patch.subspan(first, num_rows)) bits.push_back(static_cast<std::uint32_t>(patch));
  return bits;
}

std::vector<std::vector<std::uint32_t>> bitsOfAll(const Model& model, const std::vector<std::vector<double>>& forces) {
  const int n = static_cast<int>(forces.size());
  Simulator simulator(model, {.num_instances = n, .outputs = kContactFeatures, .max_contacts = 3000, .max_regions = 5});
  const FrameView frame = press(simulator, forces);
  std::vector<std::vector<std::uint32_t>> bits;
  for (int i = 0; i < n; ++i) {
    bits.push_back(bitsOf(frame.contact, i));
    const std::vector<std::uint32_t> clean = bitsOf(frame.ground_truth.contact, i);
    bits.back().insert(bits.back().end(), clean.begin(), clean.end());
  }
  return bits;
}

TEST(ContactFeaturesOnEveryDriver, IndependentOfBatchAndWorkgroup) {
  Sensor sensor = support::gridSensor({.num_rows = 23, .num_cols = 31, .pitch_x = 1e-3, .pitch_y = 1e-3});
  sensor.patches.push_back(sensor.patches[0]);
  sensor.patches[1].X_SP = {{0.03, 0, 0}, axisAngle({0, 1, 0}, 0.1)};
  sensor.psf = gaussianPsf(0.6, 3);
  Random random(9);
  std::vector<std::vector<double>> forces;
  for (int i = 0; i < 11; ++i) forces.push_back(randomImage(random, sensor));
  const auto modelWith = [&](int workgroup) { return Model(support::sharedDevice(), {.sensor = sensor, .image_workgroup = workgroup}); };
  const Model model = modelWith(0);
  const auto expected = bitsOfAll(model, forces);
  for (const int workgroup : {4, 16, 256}) EXPECT_EQ(bitsOfAll(modelWith(workgroup), forces), expected) << workgroup;
  for (std::size_t i = 0; i < forces.size(); ++i) EXPECT_EQ(bitsOfAll(model, {forces[i]})[0], expected[i]) << i;
}

TEST(ContactFeaturesOnEveryDriver, MeasuredFeaturesAreHeldBetweenSensorFrames) {
  Sensor sensor = support::gridSensor();
  sensor.frame_rate = 50;
  const Model model(support::sharedDevice(), {.sensor = sensor, .objects = {Object(Sphere{0.005})}});
  Simulator simulator(model, {.outputs = kContactFeatures, .max_regions = 1});
  std::vector<std::vector<std::uint32_t>> measured, clean;
  for (const double depth : {0.5e-3, 0.7e-3, 0.9e-3}) {
    support::setTouches(simulator, {{{0}, {{.position = {0, 0, 0.005 - depth}}}}});
    simulator.step(0.01);
    const FrameView frame = simulator.read();
    measured.push_back(bitsOf(frame.contact, 0));
    clean.push_back(bitsOf(frame.ground_truth.contact, 0));
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
    try {
      Simulator simulator(model, options);
      ADD_FAILURE() << options.max_regions;
    } catch (const Error& error) {
      EXPECT_EQ(error.kind(), ErrorKind::kInput);
      EXPECT_NE(std::string(error.what()).find("max_regions: " + std::to_string(options.max_regions)), std::string::npos) << error.what();
    }
  }
}

}  // namespace
}  // namespace taxelsim
