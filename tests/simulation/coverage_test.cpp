// Sample coverage of triangles against exact integer arithmetic. Vertices lie on fractions of the sample spacing that the device represents
// exactly, so no sample may differ except those on an edge.
#include <ostream>

#include "simulation/comparison.h"
#include "simulation/raster.h"
#include "support/random_scene.h"
#include "support/test.h"

namespace taxelsim {
namespace {

using support::Random;

constexpr int kRows = 24, kCols = 56;  // one sample per taxel
constexpr double kSpacing = 0x1p-10;   // m: positions of samples and vertices are exact in binary
constexpr int kFractionBits = 7;       // of the spacing, on which vertices lie
constexpr std::int64_t kUnit = 1 << kFractionBits;
constexpr double kThickness = 0x1p-9;  // m, about 2 mm
// Vertices are rounded to 2^-21 of the object, which is as large as the sensor. The slope of a plane has the error of several roundings of
// the rise over the width of the triangle; slivers are at most 80 samples long and two units wide, and a sample may be that far from the
// corner.
constexpr double kHeightRounding = 0x1p-21 * 2 * kCols * kSpacing + 4 * support::kUlp * kThickness * (80 * kUnit / 2);

struct Point {
  std::int64_t u, v;  // in units, from the first sample
  double z;           // m
};
using Triangle = std::array<Point, 3>;

// Twice the area of a, b and p.
std::int64_t edge(const Point& a, const Point& b, std::int64_t u, std::int64_t v) {
  return (b.u - a.u) * (v - a.v) - (b.v - a.v) * (u - a.u);
}

// The exact result of one sample.
struct Oracle {
  double height = std::numeric_limits<double>::infinity();  // the lowest over it
  bool on_edge = false;
};

Oracle look(const std::vector<Triangle>& triangles, int row, int col) {
  Oracle seen;
  const std::int64_t u = row * kUnit, v = col * kUnit;
  for (const auto& [a, b, c] : triangles) {
    const std::int64_t area = edge(a, b, c.u, c.v);
    if (area == 0) continue;
    const std::int64_t sign = area > 0 ? 1 : -1;
    const std::array<std::int64_t, 3> weights{sign * edge(b, c, u, v), sign * edge(c, a, u, v), sign * edge(a, b, u, v)};
    const auto lowest = *std::min_element(weights.begin(), weights.end());
    if (lowest < 0) continue;
    seen.on_edge = seen.on_edge || lowest == 0;
    const auto w = [&](int k) { return static_cast<double>(weights[static_cast<std::size_t>(k)]); };
    seen.height = std::min(seen.height, (w(0) * a.z + w(1) * b.z + w(2) * c.z) / static_cast<double>(sign * area));
  }
  return seen;
}

Mesh meshOf(const std::vector<Triangle>& triangles) {
  Mesh mesh;
  const auto place = [](std::int64_t units, int count) {
    return static_cast<float>((static_cast<double>(units) / kUnit - (count - 1) / 2.0) * kSpacing);
  };
  for (const Triangle& triangle : triangles) {
    const auto first = static_cast<std::uint32_t>(mesh.vertices.size());
    for (const Point& p : triangle) mesh.vertices.push_back({place(p.u, kRows), place(p.v, kCols), static_cast<float>(p.z)});
    mesh.triangles.push_back({first, first + 1, first + 2});
  }
  return mesh;
}

Sensor sensorOfSamples() {
  Sensor sensor = support::gridSensor({.num_rows = kRows, .num_cols = kCols, .samples_per_taxel = 1, .law = {1.73e8, 1, 0}});
  sensor.patches[0].pitch = {kSpacing, kSpacing};
  sensor.skin.thickness = kThickness;
  return sensor;
}

// Depths of all samples of all meshes, m. Shape (meshes x samples).
std::vector<float> depthsOf(const Sensor& sensor, const std::vector<std::vector<Triangle>>& drawn) {
  std::vector<Object> objects;
  std::vector<int> ids;
  for (const std::vector<Triangle>& triangles : drawn) {
    ids.push_back(static_cast<int>(objects.size()));
    objects.emplace_back("triangles " + std::to_string(ids.back()), meshOf(triangles));
  }
  Simulator simulator = support::makeSimulator(sensor, objects, {.num_instances = static_cast<int>(ids.size())});
  simulator.setObjects(ids, std::vector<Pose>(ids.size()));
  const auto depths = support::stepOnce(simulator, 1e-3).ground_truth.penetration_depth;
  return {depths.begin(), depths.end()};
}

// A third of the triangles are slivers: their third vertex is within two units of the line through the others.
std::vector<Triangle> randomTriangles(Random& random, int count, double size) {
  const auto units = [&](double samples) { return static_cast<std::int64_t>(std::lround(samples * kUnit)); };
  std::vector<Triangle> triangles;
  for (int n = 0; n < count; ++n) {
    const Point a{units(random.uniform(-2, kRows + 1)), units(random.uniform(-2, kCols + 1)), random.uniform(-0.9, -0.1) * kThickness};
    Triangle triangle{a, a, a};
    for (Point* p : {&triangle[1], &triangle[2]}) {
      *p = {a.u + units(random.uniform(-size, size)), a.v + units(random.uniform(-size, size)), random.uniform(-0.9, -0.1) * kThickness};
    }
    if (n % 3 == 0) {
      const double share = random.uniform(0, 1);
      const Point& b = triangle[1];
      triangle[2].u = a.u + std::llround(share * static_cast<double>(b.u - a.u)) + random.integer(-2, 2);
      triangle[2].v = a.v + std::llround(share * static_cast<double>(b.v - a.v)) + random.integer(-2, 2);
    }
    triangles.push_back(triangle);
  }
  return triangles;
}

struct Kind {
  const char* name;
  int count;
  double size;  // of triangles, in samples
  bool large;

  friend void PrintTo(const Kind& kind, std::ostream* out) { *out << kind.name; }
};

class Coverage : public ::testing::TestWithParam<Kind> {};

// The crossing of an edge and a row is closer to a sample than float32 resolves once in about ten thousand.
TEST_P(Coverage, IsExactForLooseTriangles) {
  constexpr int kDraws = 48;
  const Kind& kind = GetParam();
  const Sensor sensor = sensorOfSamples();
  std::vector<std::vector<Triangle>> drawn;
  for (int draw = 0; draw < kDraws; ++draw) {
    Random random(static_cast<std::uint64_t>(100 + draw));
    drawn.push_back(randomTriangles(random, kind.count, kind.size));
    const Raster raster = chooseRaster(meshOf(drawn.back()), {kSpacing, kCols});
    ASSERT_EQ(raster.large, kind.large);
    ASSERT_GE(raster.subpixel_bits, kFractionBits);
  }
  const std::vector<float> depths = depthsOf(sensor, drawn);
  int num_covered = 0, num_wrong = 0;
  for (std::size_t k = 0; k < depths.size(); ++k) {
    const auto draw = static_cast<int>(k) / (kRows * kCols), sample = static_cast<int>(k) % (kRows * kCols);
    const Oracle seen = look(drawn[static_cast<std::size_t>(draw)], sample / kCols, sample % kCols);
    if (seen.on_edge) continue;
    const double expected = std::isinf(seen.height) ? 0 : -seen.height;
    num_covered += expected > 0;
    num_wrong += std::abs(depths[k] - expected) > kHeightRounding;
  }
  EXPECT_EQ(num_wrong, 0);
  EXPECT_GT(num_covered, 5000);
}

// A grid of two triangles per cell with displaced corners; every fourth corner lies on a sample. Every sample must be covered.
TEST_P(Coverage, HasNoGapInASheet) {
  constexpr int kDraws = 8;
  const Kind& kind = GetParam();
  const auto cell = static_cast<int>(std::ceil(kind.size));
  const int rows = (kRows + 4 * cell) / cell, cols = (kCols + 4 * cell) / cell;
  std::vector<std::vector<Triangle>> drawn;
  for (int draw = 0; draw < kDraws; ++draw) {
    Random random(static_cast<std::uint64_t>(200 + draw));
    std::vector<Point> corners;
    for (int n = 0; n < (rows + 1) * (cols + 1); ++n) {
      const bool on_sample = random.integer(0, 3) == 0;
      const int most = on_sample ? 0 : static_cast<int>(0.3 * kind.size * kUnit);
      const auto moved = [&](int index) { return (index - 1) * cell * kUnit + random.integer(-most, most); };
      corners.push_back({moved(n / (cols + 1)), moved(n % (cols + 1)), random.uniform(-0.9, -0.1) * kThickness});
    }
    std::vector<Triangle>& triangles = drawn.emplace_back();
    for (int n = 0; n < rows * cols; ++n) {
      const auto at = static_cast<std::size_t>(n / cols * (cols + 1) + n % cols), below = at + static_cast<std::size_t>(cols + 1);
      triangles.push_back({corners[at], corners[below], corners[at + 1]});
      triangles.push_back({corners[at + 1], corners[below], corners[below + 1]});
    }
  }
  const std::vector<float> depths = depthsOf(sensorOfSamples(), drawn);
  EXPECT_EQ(std::count(depths.begin(), depths.end(), 0.0f), 0);
}

// A triangle without neighbours covers the samples on all of its edges.
TEST(LoneTriangle, CoversTheSamplesOnItsEdges) {
  constexpr int kSide = 2;
  constexpr double kDepth = 0.5 * kThickness;
  std::vector<std::vector<Triangle>> drawn;
  for (const bool turned : {false, true}) {
    for (std::size_t first = 0; first < 3; ++first) {
      std::vector<Triangle>& triangles = drawn.emplace_back();
      for (int row = 0; row + kSide < kRows; row += kSide + 2) {
        for (int col = 0; col + kSide < kCols; col += kSide + 2) {
          const Triangle corners{Point{row * kUnit, col * kUnit, -kDepth}, Point{(row + kSide) * kUnit, col * kUnit, -kDepth},
                                 Point{row * kUnit, (col + kSide) * kUnit, -kDepth}};
          Triangle triangle{corners[first], corners[(first + 1) % 3], corners[(first + 2) % 3]};
          if (turned) std::swap(triangle[0], triangle[1]);
          triangles.push_back(triangle);
        }
      }
      ASSERT_FALSE(chooseRaster(meshOf(triangles), {kSpacing, kCols}).large);
    }
  }
  const std::vector<float> depths = depthsOf(sensorOfSamples(), drawn);
  for (std::size_t k = 0; k < depths.size(); ++k) {
    const int sample = static_cast<int>(k) % (kRows * kCols), row = sample / kCols, col = sample % kCols;
    const int in_row = row % (kSide + 2), in_col = col % (kSide + 2);
    const bool there = row - in_row + kSide < kRows && col - in_col + kSide < kCols;
    ASSERT_NEAR(depths[k], there && in_row + in_col <= kSide ? kDepth : 0, kHeightRounding)
        << "mesh " << k / (kRows * kCols) << ", sample " << sample;
  }
}

INSTANTIATE_TEST_SUITE_P(OnEveryDriver, Coverage,
                         ::testing::Values(Kind{"Small", 400, 2.5, false}, Kind{"Tiny", 3000, 0.7, false}, Kind{"Large", 30, 40, true}),
                         [](const auto& of) { return std::string(of.param.name); });

}  // namespace
}  // namespace taxelsim
