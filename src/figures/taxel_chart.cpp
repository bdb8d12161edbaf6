#include "figures/taxel_chart.h"

#include <yaml-cpp/yaml.h>

#include <algorithm>
#include <cmath>
#include <string>

#include "base/vector3.h"
#include "taxelsim/error.h"

namespace taxelsim::figures {
namespace {

constexpr double kLevel = 1e-9;      // sine: smaller leans count as 0
constexpr double kLeastSine = 0.05;  // smaller near the far pole, where the direction is undefined

using Point = std::array<double, 2>;

// Pose of the chart in S: z along the mean normal, origin in the middle of the taxels that face this way.
Pose chartFrame(const std::vector<Vector3>& positions, const std::vector<Vector3>& normals) {
  Vector3 mean{0, 0, 0};
  for (const Vector3& n : normals) mean = add(mean, n);
  if (length(mean) < kLeastSine * static_cast<double>(normals.size())) mean = {0, 0, 1};
  const Pose turned = taxelPatch("", {0, 0, 0}, mean, {1, 1}).X_SP;
  const Vector3 z = unit(mean);
  double nearest = -1;
  for (const Vector3& n : normals) nearest = std::max(nearest, dot(n, z));
  Vector3 middle{0, 0, 0};
  double count = 0;
  for (std::size_t t = 0; t < normals.size(); ++t) {
    if (dot(normals[t], z) < nearest - 1e-6) continue;
    middle = add(middle, positions[t]);
    ++count;
  }
  return {scale(1 / count, middle), turned.rotation};
}

// Corners of a taxel with pose X_CP in the chart.
TaxelOutline outlineOf(const Pose& X_CP, const std::array<double, 2>& size) {
  const Vector3 n = rotate(X_CP.rotation, {0, 0, 1});
  const double sine = std::hypot(n[0], n[1]), lean = std::atan2(sine, n[2]);
  const Point out = sine > kLevel ? Point{n[0] / sine, n[1] / sine} : Point{1, 0}, across{-out[1], out[0]};
  const Point p{X_CP.position[0], X_CP.position[1]};
  const double stretch = (sine > kLevel ? lean / std::max(sine, kLeastSine) : 1) - 1, along = p[0] * out[0] + p[1] * out[1];
  const Point middle{p[0] + out[0] * along * stretch, p[1] + out[1] * along * stretch};
  // Maps a direction in the plane of the taxel to the chart.
  const auto flat = [&](const Vector3& direction_P, double length) -> Point {
    const Vector3 v = scale(length, rotate(X_CP.rotation, direction_P));
    const double outwards = std::cos(lean) * (v[0] * out[0] + v[1] * out[1]) - std::sin(lean) * v[2];
    const double sideways = v[0] * across[0] + v[1] * across[1];
    return {outwards * out[0] + sideways * across[0], outwards * out[1] + sideways * across[1]};
  };
  const Point x = flat({1, 0, 0}, size[0] / 2), y = flat({0, 1, 0}, size[1] / 2);
  TaxelOutline outline;
  for (std::size_t axis = 0; axis < 2; ++axis) {
    outline[0][axis] = middle[axis] - x[axis] - y[axis];
    outline[1][axis] = middle[axis] - x[axis] + y[axis];
    outline[2][axis] = middle[axis] + x[axis] + y[axis];
    outline[3][axis] = middle[axis] + x[axis] - y[axis];
  }
  return outline;
}

Vector3 vectorOf(const YAML::Node& node) {
  return {node[0].as<double>(), node[1].as<double>(), node[2].as<double>()};
}

}  // namespace

std::vector<TaxelOutline> unrolled(const Sensor& sensor) {
  const Pose X_CS = inverse(chartFrame(taxelPositions(sensor), taxelNormals(sensor)));
  std::vector<TaxelOutline> outlines;
  for (const GridPatch& patch : sensor.patches) outlines.push_back(outlineOf(X_CS * patch.X_SP, patch.pitch));
  return outlines;
}

std::vector<std::array<Vector3, 4>> tilesOf(const Sensor& sensor) {
  constexpr int kCorners[4][2] = {{0, 0}, {0, 1}, {1, 1}, {1, 0}};
  std::vector<std::array<Vector3, 4>> tiles;
  for (const GridPatch& patch : sensor.patches) {
    for (int i = 0; i < patch.num_rows; ++i) {
      for (int j = 0; j < patch.num_cols; ++j) {
        std::array<Vector3, 4>& tile = tiles.emplace_back();
        for (std::size_t c = 0; c < tile.size(); ++c) {
          tile[c] = patch.X_SP * Vector3{(i + kCorners[c][0] - 0.5 * patch.num_rows) * patch.pitch[0],
                                         (j + kCorners[c][1] - 0.5 * patch.num_cols) * patch.pitch[1], 0};
        }
      }
    }
  }
  return tiles;
}

std::vector<TaxelOutline> outlinesOf(const Sensor& sensor) {
  if (isTaxelList(sensor)) return unrolled(sensor);
  std::vector<TaxelOutline> outlines;
  for (const auto& tile : tilesOf(sensor)) {
    TaxelOutline& outline = outlines.emplace_back();
    for (std::size_t c = 0; c < outline.size(); ++c) outline[c] = {tile[c][0], tile[c][1]};
  }
  return outlines;
}

std::optional<Sensor> listedTaxels(const Manifest& manifest) {
  Sensor sensor;
  try {
    const YAML::Node taxels = YAML::Load(manifest.scene)["sensor"]["taxels"];
    if (!taxels || !taxels.IsSequence()) return std::nullopt;
    for (const YAML::Node& taxel : taxels) {
      std::optional<Vector3> x_axis;
      if (taxel["x_axis"]) x_axis = vectorOf(taxel["x_axis"]);
      const std::array<double, 2> size{taxel["size"][0].as<double>(), taxel["size"][1].as<double>()};
      sensor.patches.push_back(taxelPatch("", vectorOf(taxel["position"]), vectorOf(taxel["normal"]), size, x_axis));
    }
  } catch (const YAML::Exception&) {
    return std::nullopt;  // the checksum was right; only the positions are unknown
  } catch (const Error&) {
    return std::nullopt;
  }
  if (!isTaxelList(sensor)) return std::nullopt;
  return sensor;
}

}  // namespace taxelsim::figures
