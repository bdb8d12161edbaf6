// Least time of a frame by option: counts of what a frame touches against closed forms, and the arithmetic of the limits.
#include "option_limits.h"

#include "bench_objects.h"
#include "frame_counts.h"
#include "support/test.h"
#include "taxelsim/simulator.h"

namespace taxelsim::bench {
namespace {

Sensor wts() {
  return loadSensor(TAXELSIM_SOURCE_DIR "/bench/sensors/wts0614.yaml");
}

// A sphere over (x, y) of the sensor, `depth` (m) in the skin.
struct PressedSphere {
  double radius, depth, x, y;

  Object object() const { return {"sphere", Sphere{.radius = radius}}; }
  Pose pose() const { return {.position = {x, y, radius - depth}}; }
  bool isOver(double px, double py) const { return std::hypot(px - x, py - y) < std::sqrt(2 * radius * depth - depth * depth); }
};

// What the sphere touches on a grid of samples centred on the origin, by the closed form of its section with the skin's surface.
FrameCounts closedForm(const PressedSphere& sphere, const Sensor& sensor, int per_taxel) {
  const GridPatch& patch = sensor.patches.front();
  const auto position = [&](int sample, int taxels, std::size_t axis) {
    return (sample + 0.5 - 0.5 * taxels * per_taxel) * patch.pitch[axis] / per_taxel;
  };
  FrameCounts counts;
  std::set<std::pair<int, int>> touched, spread;
  for (int row = 0; row < patch.num_rows * per_taxel; ++row) {
    for (int col = 0; col < patch.num_cols * per_taxel; ++col) {
      if (!sphere.isOver(position(row, patch.num_rows, 0), position(col, patch.num_cols, 1))) continue;
      ++counts.touched_samples;
      touched.insert({row / per_taxel, col / per_taxel});
    }
  }
  for (const auto& [i, j] : touched) {
    for (int a = std::max(i - 1, 0); a <= std::min(i + 1, patch.num_rows - 1); ++a) {
      for (int b = std::max(j - 1, 0); b <= std::min(j + 1, patch.num_cols - 1); ++b) spread.insert({a, b});
    }
  }
  counts.touched_taxels = static_cast<double>(touched.size());
  counts.spread_taxels = static_cast<double>(spread.size());
  counts.samples = counts.touched_taxels * per_taxel * per_taxel;
  return counts;
}

// One taxel of 4 x 4 samples under a cylinder.
FrameCounts oneTaxel() {
  FrameCounts counts;
  counts.taxels = 84;
  counts.touched_taxels = 1;
  counts.spread_taxels = 9;
  counts.reporting_taxels = 4;
  counts.samples = counts.touched_samples = 16;
  counts.edge_samples = 12;
  return counts;
}

class FrameCounterOnDevice : public testing::Test {
 protected:
  Device device_ = Device::open({});
};

TEST_F(FrameCounterOnDevice, CountsWhatASphereTouches) {
  const PressedSphere sphere{.radius = 0.01, .depth = 1e-3, .x = 0.4e-3, .y = 21.3e-3};  // over the border of the array
  FrameCounter counter(device_, sphere.object(), {sphere.pose(), sphere.pose(), sphere.pose()});
  for (const int per_taxel : {2, 4, 10}) {  // 10: more samples along y than a patch may have taxels
    Sensor sensor = wts();
    sensor.samples_per_taxel = per_taxel;
    const FrameCounts counts = counter.count(sensor).value(), expected = closedForm(sphere, sensor, per_taxel);
    EXPECT_GT(expected.touched_samples, 10);
    EXPECT_EQ(counts.taxels, 84);
    EXPECT_EQ(counts.touched_samples, expected.touched_samples);
    EXPECT_EQ(counts.touched_taxels, expected.touched_taxels);
    EXPECT_EQ(counts.spread_taxels, expected.spread_taxels);
    EXPECT_EQ(counts.samples, expected.samples);
    EXPECT_GT(counts.edge_samples, 0);
    EXPECT_LT(counts.edge_samples, counts.touched_samples);
    EXPECT_EQ(counts.triangles, 0);
  }
}

// A box as a mesh: two of its triangles look down, and eight upright ones have a part under the skin.
TEST_F(FrameCounterOnDevice, CountsTrianglesAndTheirCells) {
  Mesh box;
  const auto x = 5.3e-3F, y = 3.1e-3F, z = 4e-3F;
  for (const float sign : {-1.0F, 1.0F}) {
    for (const auto& corner : {std::array{-x, -y}, {x, -y}, {x, y}, {-x, y}}) box.vertices.push_back({corner[0], corner[1], sign * z});
  }
  box.triangles = {{0, 2, 1}, {0, 3, 2}, {4, 5, 6}, {4, 6, 7}};
  for (std::uint32_t k = 0; k < 4; ++k) {
    const std::uint32_t next = (k + 1) % 4;
    box.triangles.push_back({k, next, next + 4});
    box.triangles.push_back({k, next + 4, k + 4});
  }
  Sensor sensor = wts();
  sensor.depth_sampling = DepthSampling::kArea;
  FrameCounter counter(device_, {"box", box}, {Pose{.position = {0, 0, z - 0.5e-3}}, Pose{.position = {0, 0, z + 1e-3}}});
  const FrameCounts counts = counter.count(sensor).value();
  EXPECT_EQ(counts.triangles, 10 / 2.0);  // the second frame has no contact
  // Cells of 0.85 mm: the box reaches 6.24 and 3.65 of them from the middle, and covers 14 x 8 in part or wholly.
  const double covered = 14 * 8;
  EXPECT_EQ(counts.touched_samples, covered / 2);
  // The diagonal passes through at most as many cells as there are rows and columns.
  EXPECT_GT(counts.facet_samples, covered / 2);
  EXPECT_LE(counts.facet_samples, (covered + 14 + 8) / 2);
  sensor.depth_sampling = DepthSampling::kPoint;
  EXPECT_EQ(counter.count(sensor)->facet_samples, 0);
}

TEST_F(FrameCounterOnDevice, CountsNodesOfALayer) {
  const PressedSphere sphere{.radius = 0.01, .depth = 1e-3, .x = 0.4e-3, .y = 3e-3};
  Sensor sensor = wts();
  sensor.samples_per_taxel = 2;
  sensor.skin = {.thickness = sensor.skin.thickness, .law = ElasticLayer{.elastic_modulus = 1e6, .base = ElasticLayer::Base::kHalfSpace}};
  FrameCounter counter(device_, sphere.object(), {sphere.pose()});
  const FrameCounts counts = counter.count(sensor).value();
  // Hertz: the contact has half of the area of the section with the undeformed surface (K. L. Johnson, Contact Mechanics, section 4.2).
  // Nodes are 1.7 mm apart and the contact has a radius of 3.2 mm, so that its border has a third of them.
  EXPECT_NEAR(counts.pressed_nodes / counts.touched_samples, 0.5, 0.17);
  EXPECT_EQ(counts.products, counts.samples * counts.pressed_nodes);
  sensor.skin = {
      .thickness = sensor.skin.thickness, .law = ElasticLayer{.elastic_modulus = 1e6, .base = ElasticLayer::Base::kBonded}, .margin = 4e-3};
  EXPECT_GE(counter.count(sensor)->samples, counts.samples);
  sensor.samples_per_taxel = 12;  // 168 nodes along y
  EXPECT_FALSE(counter.count(sensor).has_value());
}

// 1 operation/s and no bytes, or 1 byte/s and no operations.
const MachineRates kOnlyOperations{.bandwidth = 1e30, .arithmetic = 1}, kOnlyBytes{.bandwidth = 1, .arithmetic = 1e30};

TEST(OptionLimits, PlainFrameIsTheSumByHand) {
  const std::vector<StageWork> stages = plainFrame(oneTaxel());
  // Pose 64 and instance 32 bytes; nine counts and 36 features of 4 bytes.
  EXPECT_NEAR(limitOf(stages, kOnlyBytes), 64 + 32 + 9 * 4 + 36 * 4, 1e-9);
  // Pose 60; heights of a cylinder 29 and forces 10 per sample, 7 per taxel; 54 per taxel of the image; features 154.
  EXPECT_NEAR(limitOf(stages, kOnlyOperations), 60 + 16 * (29 + 10) + 7 + 9 * 54 + 154, 1e-9);
  // The longer of both times, stage by stage: 1 byte takes as long as 6 operations.
  const double pose = 96 * 6, depths = 16 * 29, forces = 16 * 10 + 7, image = 9 * 54, features = 144 * 6;
  EXPECT_NEAR(limitOf(stages, {.bandwidth = 1, .arithmetic = 6}), (pose + depths + forces + image + features) / 6, 1e-9);
  EXPECT_FALSE(isBoundByBytes(stages, {.bandwidth = 1, .arithmetic = 4}));
  EXPECT_TRUE(isBoundByBytes(stages, {.bandwidth = 1, .arithmetic = 6}));
}

TEST(OptionLimits, FrictionAddsItsStatesByHand) {
  Sensor sensor = wts();
  sensor.skin.friction = {.tangential_stiffness = 1e8, .friction_coefficient = 0.5};
  const std::vector<StageWork> stages = frameWork(sensor, {}, 0, oneTaxel());
  ASSERT_EQ(stages.back().stage, "friction");
  // A motion of 64 bytes, a rectangle of 16 and two words per sample, both read and written.
  EXPECT_NEAR(stages.back().bytes, 64 + 2 * 16 + 16 * 2 * 2 * 4, 1e-9);
  EXPECT_NEAR(stages.back().operations, 16 * (30 + 18) + 10, 1e-9);
}

struct Option {
  std::string name;
  std::function<void(Sensor&, OutputOptions&)> change;
};

// Long function: a list.
std::vector<Option> options() {
  return {
      {"damping", [](Sensor& s, OutputOptions&) { std::get<Winkler>(s.skin.law).normal_damping = 1e4; }},
      {"area", [](Sensor& s, OutputOptions&) { s.depth_sampling = DepthSampling::kArea; }},
      {"mass_spring_damper", [](Sensor& s, OutputOptions&) { s.skin.law = MassSpringDamper{.normal_contact_stiffness = 1e8}; }},
      {"deformation_mask", [](Sensor& s, OutputOptions&) { s.skin.law = DeformationMask{}; }},
      {"elastic_layer", [](Sensor& s, OutputOptions&) { s.skin.law = ElasticLayer{.elastic_modulus = 1e6}; }},
      {"lugre", [](Sensor& s, OutputOptions&) { s.skin.law = LuGre{.normal_contact_stiffness = 1e8}; }},
      {"friction", [](Sensor& s, OutputOptions&) { s.skin.friction = {.tangential_stiffness = 1e8, .friction_coefficient = 0.5}; }},
      {"relaxation", [](Sensor& s, OutputOptions&) { s.skin.relaxation = {{.fraction = 0.2, .time = 0.1}}; }},
      {"low-pass", [](Sensor& s, OutputOptions&) { s.readout.low_pass_time = 0.01; }},
      {"delay", [](Sensor& s, OutputOptions&) { s.readout.delay = 2e-3; }},
      {"noise", [](Sensor& s, OutputOptions&) { s.readout.noise = 17; }},
      {"gain spread", [](Sensor& s, OutputOptions&) { s.readout.gain_spread = 0.05; }},
      {"contact features", [](Sensor&, OutputOptions& o) { o.contact_features = true; }},
      {"tactile Jacobian", [](Sensor&, OutputOptions& o) { o.tactile_jacobian = true; }},
  };
}

// Under an analytic solid and under a mesh.
TEST(OptionLimits, EveryOptionAddsToThePlainFrame) {
  FrameCounts solid = oneTaxel();
  solid.pressed_nodes = 8, solid.products = 128, solid.iterations = 5;
  FrameCounts mesh = solid;
  mesh.triangles = 40, mesh.triangles_over_samples = 20, mesh.facet_samples = 60;
  const MachineRates rates;
  for (const FrameCounts& counts : {solid, mesh}) {
    const double plain = limitOf(plainFrame(counts), rates);
    EXPECT_GT(plain, 0);
    EXPECT_EQ(limitOf(frameWork(wts(), {}, 0, counts), rates), plain);
    for (const Option& option : options()) {
      Sensor sensor = wts();
      OutputOptions outputs;
      option.change(sensor, outputs);
      const std::vector<StageWork> stages = frameWork(sensor, outputs, 0, counts);
      EXPECT_GT(limitOf(stages, rates), plain) << option.name;
      for (const StageWork& work : stages) {
        EXPECT_GE(work.bytes, 0) << option.name << ": " << work.stage;
        EXPECT_GE(work.operations, 0) << option.name << ": " << work.stage;
      }
    }
  }
}

// A region adds a row of features and a scan of its taxels.
TEST(OptionLimits, RegionsAddRows) {
  FrameCounts counts = oneTaxel();
  const OutputOptions outputs{.contact_features = true};
  const MachineRates rates;
  counts.regions = 1;
  const double none = limitOf(frameWork(wts(), outputs, 0, counts), rates), four = limitOf(frameWork(wts(), outputs, 4, counts), rates);
  EXPECT_GT(four, none);
  counts.regions = 2;
  EXPECT_GT(limitOf(frameWork(wts(), outputs, 4, counts), rates), four);
}

}  // namespace
}  // namespace taxelsim::bench
