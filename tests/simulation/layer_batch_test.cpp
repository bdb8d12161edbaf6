// The law `elastic_layer`: the bits of an instance do not depend on its batch, on the workgroup and on earlier episodes.
#include "simulation/friction_paths.h"
#include "simulation/layer_scene.h"
#include "support/test.h"

namespace taxelsim {
namespace {

using support::LayerOptions;
using support::Touch;

struct LayerKind {
  std::string name;
  LayerOptions skin{.margin = 2e-3, .iterations = 10, .tolerance = 1e-3};
  Friction friction{};
  std::vector<RelaxationTerm> relaxation{};
  bool has_cells = false;  // area sampling
  int num_slots = 1;
  OutputOptions outputs{};
};

void PrintTo(const LayerKind& kind, std::ostream* out) {
  *out << kind.name;
}

Sensor sensorOf(const LayerKind& kind) {
  Sensor sensor = kind.has_cells ? support::layerSensor(kind.skin, {.num_rows = 3, .num_cols = 4, .samples_per_taxel = 4})
                                 : support::layerSensor(kind.skin, {.samples_per_taxel = 2});
  if (kind.has_cells) sensor.depth_sampling = DepthSampling::kArea;
  sensor.skin.friction = kind.friction;
  sensor.skin.relaxation = kind.relaxation;
  return sensor;
}

class ElasticLayerBatch : public ::testing::TestWithParam<LayerKind> {};

TEST_P(ElasticLayerBatch, IndependentOfBatchAndWorkgroup) {
  const Sensor sensor = sensorOf(GetParam());
  support::expectIndependentOfBatch(sensor, support::layerPaths(sensor, GetParam().num_slots), {{8, 0}, {4, 0}, {32, 0}, {64, 0}},
                                    GetParam().outputs);
}

constexpr OutputOptions kJacobians{.clean_tactile_jacobian = true, .taxel_jacobian = true};
const Friction kFriction{1e9, 0.6};
const std::vector<RelaxationTerm> kTerms{{0.3, 1e-3}, {0.4, 0.01}, {0.1, 1}};

INSTANTIATE_TEST_SUITE_P(
    Kinds, ElasticLayerBatch,
    ::testing::Values(LayerKind{"plain", {.margin = 2e-3, .iterations = 6, .tolerance = 1e-3}},
                      LayerKind{.name = "shear", .friction = kFriction},
                      LayerKind{.name = "shear in two slots", .friction = kFriction, .num_slots = 2},
                      LayerKind{.name = "relaxation", .friction = kFriction, .relaxation = kTerms},
                      LayerKind{.name = "Jacobians", .outputs = {.tactile_jacobian = true, .clean_tactile_jacobian = true}},
                      LayerKind{.name = "cells", .has_cells = true},
                      LayerKind{.name = "relaxing cells with Jacobians", .relaxation = kTerms, .has_cells = true, .outputs = kJacobians}));

TEST(ElasticLayerJacobian, ChangesNoForceAndEndsWithContact) {
  constexpr double kDt = 1e-3;  // s
  for (const bool has_cells : {false, true}) {
    const Sensor sensor = sensorOf({.name = "", .has_cells = has_cells});
    const support::ObjectPaths paths = support::layerPaths(sensor, 1);
    const int n = static_cast<int>(paths.loads.size());
    const Model model(support::sharedDevice(), {.sensor = sensor, .objects = paths.objects});
    Simulator plain(model, {.num_instances = n}), asked(model, {.num_instances = n, .outputs = kJacobians});
    for (const std::vector<Touch>& touches : paths.touches) {
      const GroundTruthView expected = support::stepOnce(plain, touches, kDt, paths.loads).ground_truth;
      const GroundTruthView found = support::stepOnce(asked, touches, kDt, paths.loads).ground_truth;
      EXPECT_TRUE(std::ranges::equal(found.tactile_normal_force, expected.tactile_normal_force));
      EXPECT_THAT(found.jacobian.contact_wrench, ::testing::Contains(::testing::Ne(0)));
    }
    const std::vector<Touch> away(paths.loads.size(), Touch{{0}, {{.position = {0, 0, 1}}}});
    const auto rows = support::stepOnce(asked, away, kDt, std::vector<float>(away.size(), kPoseDriven)).ground_truth.jacobian;
    for (const std::span<const float> values : {rows.center_of_pressure, rows.total_force, rows.edge_angle, rows.contact_wrench}) {
      EXPECT_THAT(values, ::testing::Each(0));
    }
  }
}

TEST(ElasticLayerShear, IndependentOfSpeed) {
  for (const int num_slots : {1, 2}) {
    const LayerKind kind{.name = "", .friction = kFriction, .num_slots = num_slots};
    const Sensor sensor = sensorOf(kind);
    const support::ObjectPaths paths = support::layerPaths(sensor, num_slots);
    const Model model(support::sharedDevice(), {.sensor = sensor, .objects = paths.objects});
    EXPECT_EQ(support::runPaths(model, paths, {0, 1, 2}, {3.0}), support::runPaths(model, paths, {0, 1, 2}));
  }
}

}  // namespace
}  // namespace taxelsim
