#include "sweep/cases.h"

#include <algorithm>
#include <numbers>

#include "taxelsim/error.h"

namespace taxelsim::bench {
namespace {

constexpr Vector3 kEllipsoid{0.020, 0.014, 0.012};  // m
constexpr int kBatch = 4096;
constexpr int kLargeBatch = 32768;
constexpr PoseSpread kAnySide{.rolls = true};

Sensor squareArray(int side, int samples) {
  Sensor sensor = wts0614();
  sensor.name = std::to_string(side) + "x" + std::to_string(side);
  sensor.patches[0].num_rows = sensor.patches[0].num_cols = side;
  sensor.samples_per_taxel = samples;
  return sensor;
}

SweepCase ofEllipsoid(std::string name, const Sensor& sensor, int levels, int num_instances, std::string published = {}) {
  return {.name = std::move(name),
          .sensor = sensor,
          .object = Object("ellipsoid", ellipsoid(kEllipsoid, levels)),
          .spread = kAnySide,
          .num_instances = num_instances,
          .has_clusters = true,
          .published = std::move(published)};
}

}  // namespace

Sensor wts0614() {
  Sensor sensor;
  sensor.name = "wts0614";
  sensor.patches = {{.name = "patch", .num_rows = 6, .num_cols = 14, .pitch = {0.0034, 0.0034}, .X_SP = {}}};
  sensor.samples_per_taxel = 4;
  sensor.skin = {.thickness = 0.002, .law = Winkler{.normal_contact_stiffness = 1.73e8}};
  sensor.psf = gaussianPsf(0.5, 3);
  sensor.readout.curve = {2400};
  sensor.readout.trigger = 0.02;
  return sensor;
}

std::vector<SweepCase> sweepCases() {
  // Its tactile part alone, on a GPU: Akinola et al., TacSL, arXiv 2408.06506, table III.
  const std::string small = "TacSL's tactile part: 0.461 us a frame at 32,768 (arXiv 2408.06506, table III)";
  const std::string large = "TacSL: 1.03 G taxels/s at 4,096, out of memory above (arXiv 2408.06506, table III)";
  std::vector<SweepCase> cases{
      {.name = "wts0614_cylinder",
       .sensor = wts0614(),
       .object = Object("cylinder", Cylinder{.radius = 0.008, .length = 0.04}),
       .spread = {.laid = axisAngle({0, 1, 0}, std::numbers::pi / 2)},
       .num_instances = kBatch},
      {.name = "wts0614_prism", .sensor = wts0614(), .object = Object("prism", hexPrism()), .spread = kAnySide, .num_instances = kBatch},
      ofEllipsoid("wts0614_ellipsoid_5120", wts0614(), 4, kBatch),
      ofEllipsoid("wts0614_ellipsoid_81920", wts0614(), 6, kBatch),
  };
  for (const int samples : {4, 1}) {
    const std::string suffix = samples == 1 ? "_1x1" : "";
    cases.push_back(ofEllipsoid("10x10" + suffix, squareArray(10, samples), 4, kLargeBatch, small));
    cases.push_back(ofEllipsoid("100x100" + suffix, squareArray(100, samples), 4, kLargeBatch, large));
  }
  return cases;
}

std::vector<SweepCase> casesNamed(const std::vector<std::string>& names) {
  std::vector<SweepCase> cases = sweepCases();
  for (const std::string& name : names) {
    if (std::any_of(cases.begin(), cases.end(), [&](const SweepCase& work) { return work.name == name; })) continue;
    std::string known;
    for (const SweepCase& work : cases) known += (known.empty() ? "" : ", ") + work.name;
    throw Error(ErrorKind::kInput, "--cases " + name + ": not one of " + known);
  }
  if (!names.empty()) {
    std::erase_if(cases, [&](const SweepCase& work) { return std::find(names.begin(), names.end(), work.name) == names.end(); });
  }
  return cases;
}

}  // namespace taxelsim::bench
