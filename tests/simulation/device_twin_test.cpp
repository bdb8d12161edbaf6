// The device against the double-precision reference on random scenes, every stage of every instance.
#include "simulation/comparison.h"
#include "support/cases.h"
#include "support/random_scene.h"
#include "support/test.h"

namespace taxelsim {
namespace {

using support::Random;
using support::Touch;

constexpr double kObjectSize = 0.02;  // m
constexpr double kDt = 1e-3;          // s
// Mean width of an envelope in skin thicknesses; a wider one would prove little. Silhouettes are lines, not areas.
constexpr double kLoosestEnvelope = 0.02;

struct SceneKind {
  support::SensorRange sensor;
  bool all_convex = false;  // every mesh is a convex polyhedron
  double solid_share = 0;
  int num_objects = 1;
  int num_slots = 1;
};

// Compares every instance of a random batch.
void runScene(const SceneKind& kind, int seed) {
  Random random(static_cast<std::uint64_t>(seed));
  const Sensor sensor = support::randomSensor(random, kind.sensor);
  const std::vector<Object> objects = support::randomObjects(random, kind.num_objects, kObjectSize, kind.solid_share, kind.all_convex);
  std::vector<Touch> touches;
  const int num_instances = random.integer(1, 6);
  for (int i = 0; i < num_instances; ++i) {
    Touch touch;
    for (int slot = 0; slot < kind.num_slots; ++slot) {
      const bool is_empty = kind.num_slots > 1 && random.chance(0.25);
      const int id = is_empty ? kNoObject : random.integer(0, kind.num_objects - 1);
      touch.ids.push_back(id);
      touch.X_SO.push_back(is_empty ? Pose{} : support::randomContact(random, sensor, objects[id]));
    }
    touches.push_back(touch);
  }
  const Model model(support::sharedDevice(), {.sensor = sensor,
                                              .objects = objects,
                                              .contact_workgroup = support::randomWorkgroup(random),
                                              .image_workgroup = support::randomWorkgroup(random)});
  Simulator simulator(model, {.num_instances = num_instances, .num_slots = kind.num_slots});
  const FrameView frame = support::stepOnce(simulator, touches, kDt);
  support::expectWellFormed(frame, sensor, num_instances);
  for (int i = 0; i < num_instances; ++i) {
    const auto placed = touches[i].placed(objects);
    const support::FrameEnvelope envelope = support::frameEnvelope(sensor, placed, support::roundingFor(sensor, placed));
    EXPECT_LT(support::looseness(sensor, envelope), kLoosestEnvelope);
    support::expectMatches(frame, i, sensor, envelope);
    EXPECT_EQ(frame.ground_truth.load_offset[i], 0);
    EXPECT_EQ(frame.ground_truth.load_reached[i], 1);
  }
}

class TwinSeeds : public ::testing::TestWithParam<int> {};

TEST_P(TwinSeeds, MeshOnOnePatch) {
  runScene({.sensor = {}}, GetParam());
}

TEST_P(TwinSeeds, PolyhedronOnOnePatch) {
  runScene({.sensor = {}, .all_convex = true}, 4000 + GetParam());
}

TEST_P(TwinSeeds, PolyhedraAmongSolids) {
  runScene({.sensor = {.max_rows = 8, .max_cols = 8, .max_patches = 1 + GetParam() % 3, .max_patch_tilt = 0.3},
            .all_convex = true,
            .solid_share = 0.3,
            .num_objects = 3,
            .num_slots = 1 + GetParam() % 3},
           5000 + GetParam());
}

TEST_P(TwinSeeds, SolidOnOnePatch) {
  runScene({.sensor = {}, .solid_share = 1}, 1000 + GetParam());
}

TEST_P(TwinSeeds, SeveralObjectsInSlots) {
  runScene({.sensor = {}, .solid_share = 0.5, .num_objects = 4, .num_slots = 1 + GetParam() % kMaxSlots}, 2000 + GetParam());
}

TEST_P(TwinSeeds, SeveralTiltedPatches) {
  runScene({.sensor = {.max_rows = 8, .max_cols = 8, .max_patches = 4, .max_patch_tilt = 0.5},
            .solid_share = 0.5,
            .num_objects = 2,
            .num_slots = 2},
           3000 + GetParam());
}

INSTANTIATE_TEST_SUITE_P(OnEveryDriver, TwinSeeds, support::seeds(5, 16));

// Compares one sensor under one bumpy sphere; for sizes and settings that random scenes seldom have.
void runSensor(const Sensor& sensor, double radius, int num_subdivisions = 3, int num_instances = 2) {
  Random random(5);
  const std::vector<Object> objects{Object("bumpy sphere", support::icosphere(radius, num_subdivisions, 0.02, random))};
  std::vector<Touch> touches;
  for (int i = 0; i < num_instances; ++i) touches.push_back({{0}, {support::randomContact(random, sensor, objects[0])}});
  Simulator simulator = support::makeSimulator(sensor, objects, {.num_instances = num_instances});
  const FrameView frame = support::stepOnce(simulator, touches, kDt);
  support::expectWellFormed(frame, sensor, num_instances);
  for (int i = 0; i < num_instances; ++i) {
    support::expectMatches(
        frame, i, sensor,
        support::frameEnvelope(sensor, touches[i].placed(objects), support::roundingFor(sensor, touches[i].placed(objects))));
  }
}

// More groups of clusters than one batch culls on any driver: 20,480 and 81,920 triangles.
TEST(SensorSizeOnEveryDriver, MeshesWithManyGroups) {
  for (const int num_subdivisions : {5, 6}) {
    constexpr int kAllOver = 16;  // contacts, by chance on all sides
    runSensor(support::gridSensor({.num_rows = 4, .num_cols = 4, .samples_per_taxel = 2}), 0.01, num_subdivisions, kAllOver);
  }
}

// 1, 3 and all samples a side by default; every number has a pipeline of its own.
std::vector<int> sampleCounts() {
  if (!support::runsAllCases()) return {1, 3, kMaxSamplesPerTaxel};
  std::vector<int> counts(kMaxSamplesPerTaxel);
  std::iota(counts.begin(), counts.end(), 1);
  return counts;
}

TEST(SensorSize, OneTaxel) {
  for (const int s : sampleCounts()) {
    runSensor(support::gridSensor({.num_rows = 1, .num_cols = 1, .samples_per_taxel = s}), 0.01);
  }
}

TEST(SensorSize, EverySampleCount) {
  for (const int s : sampleCounts()) {
    runSensor(support::gridSensor({.samples_per_taxel = s}), 0.01);
  }
}

TEST(SensorSizeOnEveryDriver, LongAndThin) {
  runSensor(support::gridSensor({.num_rows = 1, .num_cols = 128, .pitch_x = 1e-3, .pitch_y = 0.5e-3}), 0.02);
  runSensor(support::gridSensor({.num_rows = 128, .num_cols = 1, .pitch_x = 0.5e-3, .pitch_y = 1e-3}), 0.02);
}

TEST(SensorSizeOnEveryDriver, Largest) {
  runSensor(support::gridSensor({.num_rows = 128, .num_cols = 128, .pitch_x = 0.5e-3, .pitch_y = 0.5e-3, .samples_per_taxel = 1}), 0.03);
}

// 2048 x 512 samples: 4 MiB of depth, more than any workgroup can share.
TEST(SensorSizeOnEveryDriver, LargestWithAllSamples) {
  runSensor(support::gridSensor(
                {.num_rows = 128, .num_cols = 32, .pitch_x = 0.5e-3, .pitch_y = 0.5e-3, .samples_per_taxel = kMaxSamplesPerTaxel}),
            0.03);
}

// By default every kernel size on one grid with one normalization.
TEST(PsfOnDevice, EveryKernelSizeAndNormalization) {
  int number = 0;
  for (int size = 1; size <= kMaxKernelSize; size += 2) {
    for (const auto normalization : {Psf::Normalization::kPerSource, Psf::Normalization::kNone}) {
      for (const auto& [rows, cols] : {std::pair{6, 14}, {2, 3}, {17, 33}}) {
        if (!support::runsAllCases() && number++ % 7 != 0) continue;
        Sensor sensor = support::gridSensor({.num_rows = rows, .num_cols = cols});
        sensor.psf = gaussianPsf(0.3 + 0.2 * size, size, normalization);
        runSensor(sensor, 0.015);
      }
    }
  }
}

TEST(ReadoutOnEveryDriver, PolynomialsGainsTriggersAndBits) {
  for (int seed = 0; seed < 12; seed += support::runsAllCases() ? 1 : 3) {
    Random random(static_cast<std::uint64_t>(seed));
    Sensor sensor = support::gridSensor({.samples_per_taxel = 2});
    Readout& readout = sensor.readout;
    readout.adc_bits = 1 + (seed * 4) % kMaxAdcBits;
    readout.saturation = (1 << readout.adc_bits) - 1;
    readout.curve.assign(1 + seed % kMaxCurveDegree, 0);
    for (double& coefficient : readout.curve) {
      coefficient = readout.saturation / 2.0 * random.uniform(0.2, 1);
    }
    readout.output_scale = random.uniform(0.2, 3);
    for (int t = 0; t < numTaxels(sensor); ++t) {
      readout.taxel_gain.push_back(random.uniform(0, 2));
      readout.taxel_trigger.push_back(random.uniform(-0.1, 0.3));
    }
    runSensor(sensor, 0.01);
  }
}

// 1 to 16 points, saturation below and above the last one, forces below the first.
TEST(ReadoutOnEveryDriver, StraightPieces) {
  for (int seed = support::runsAllCases() ? 0 : 2; seed < 12; seed += support::runsAllCases() ? 1 : 3) {
    Random random(static_cast<std::uint64_t>(seed));
    Sensor sensor = support::gridSensor({.samples_per_taxel = 2});
    Readout& readout = sensor.readout;
    readout.adc_bits = 8 + seed % 9;
    readout.saturation = (1 << readout.adc_bits) - 1;
    readout.output_scale = random.uniform(0.2, 3);
    const int num_points = 1 + seed * 15 / 11;
    const double force = random.uniform(0.2, 2), counts = random.uniform(0.3, 1.5) * readout.saturation / readout.output_scale;
    CurvePoint point;
    for (int k = 0; k < num_points; ++k) {
      point.force += random.uniform(0.1, 1.9) * force / num_points;
      point.counts += random.uniform(0.1, 1.9) * counts / num_points;
      readout.curve_points.push_back(point);
    }
    for (int t = 0; t < numTaxels(sensor); ++t) {
      readout.taxel_gain.push_back(random.uniform(0, 2));
      readout.taxel_trigger.push_back(random.uniform(0, 0.3));
    }
    runSensor(sensor, 0.01);
  }
}

}  // namespace
}  // namespace taxelsim
