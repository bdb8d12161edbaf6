#include "support/random_scene.h"

#include "base/vector3.h"
#include "reference/load.h"
#include "support/test.h"

namespace taxelsim::support {
namespace {

std::array<float, 3> toFloat(const Vector3& p) {
  return {static_cast<float>(p[0]), static_cast<float>(p[1]), static_cast<float>(p[2])};
}

std::vector<double> randomKernel(Random& random, int size) {
  std::vector<double> kernel;
  for (int n = 0; n < size * size; ++n) {
    kernel.push_back(random.uniform(0.01, 1));
  }
  return kernel;
}

}  // namespace

Quaternion Random::rotation() {
  Quaternion q;
  double norm = 0;
  do {
    q = {uniform(-1, 1), uniform(-1, 1), uniform(-1, 1), uniform(-1, 1)};
    norm = std::sqrt(q[0] * q[0] + q[1] * q[1] + q[2] * q[2] + q[3] * q[3]);
  } while (norm > 1 || norm < 0.1);
  return {q[0] / norm, q[1] / norm, q[2] / norm, q[3] / norm};
}

Quaternion Random::tilt(double max_angle) {
  const double direction = uniform(-std::numbers::pi, std::numbers::pi);
  const Quaternion yaw = axisAngle({0, 0, 1}, uniform(-std::numbers::pi, std::numbers::pi));
  return axisAngle({std::cos(direction), std::sin(direction), 0}, uniform(0, max_angle)) * yaw;
}

Sensor gridSensor(const GridOptions& options) {
  Sensor sensor;
  sensor.name = "grid";
  sensor.patches = {{"grid", options.num_rows, options.num_cols, {options.pitch_x, options.pitch_y}, {}}};
  sensor.samples_per_taxel = options.samples_per_taxel;
  sensor.skin = {options.thickness, options.law};
  return sensor;
}

void addPatch(Sensor& sensor, const Pose& X_SP) {
  GridPatch patch = sensor.patches[0];
  patch.name = "patch " + std::to_string(sensor.patches.size());
  patch.X_SP = X_SP;
  sensor.patches.push_back(patch);
}

Readout paperReadout() {
  Readout readout;
  readout.curve = {3840 / 1.6};
  readout.trigger = 0.2;
  return readout;
}

Sensor randomSensor(Random& random, const SensorRange& range) {
  Sensor sensor;
  sensor.name = "random";
  const int num_patches = random.integer(1, range.max_patches);
  int num_taxels = 0;
  double x = 0;
  for (int p = 0; p < num_patches; ++p) {
    GridPatch patch;
    patch.name = "patch " + std::to_string(p);
    patch.num_rows = random.integer(1, range.max_rows);
    patch.num_cols = random.integer(1, range.max_cols);
    patch.pitch = {random.uniform(1e-3, 5e-3), random.uniform(1e-3, 5e-3)};
    const double width = patch.num_rows * patch.pitch[0];
    patch.X_SP.position = {num_patches == 1 ? 0 : x + width / 2, random.uniform(-2e-3, 2e-3), random.uniform(-1e-3, 1e-3)};
    patch.X_SP.rotation = random.tilt(range.max_patch_tilt);
    x += width + 1e-3;
    num_taxels += patch.num_rows * patch.num_cols;
    sensor.patches.push_back(patch);
  }
  sensor.samples_per_taxel = random.integer(1, 8);
  sensor.skin.thickness = random.uniform(0.5e-3, 3e-3);
  const double exponent = random.chance(0.5) ? 1 : random.uniform(1, 3);
  // About 1e5 Pa at full depth, whatever the exponent.
  sensor.skin.law = Winkler{1e5 / std::pow(sensor.skin.thickness, exponent), exponent, 0};
  sensor.psf.size = 2 * random.integer(0, range.max_kernel / 2) + 1;
  sensor.psf.kernel = randomKernel(random, sensor.psf.size);
  sensor.psf.normalization = random.chance(0.5) ? Psf::Normalization::kPerSource : Psf::Normalization::kNone;
  Readout& readout = sensor.readout;
  readout.adc_bits = random.integer(6, 16);
  readout.saturation = (1 << readout.adc_bits) - 1 - random.integer(0, 8);
  readout.curve = {readout.saturation / random.uniform(0.2, 4)};
  for (int m = random.integer(0, 4); m > 0; --m) {
    readout.curve.push_back(readout.curve.back() * random.uniform(0, 0.5));
  }
  readout.output_scale = random.uniform(0.5, 2);
  readout.trigger = random.chance(0.5) ? 0 : random.uniform(0, 0.1);
  if (random.chance(0.5)) {
    for (int t = 0; t < num_taxels; ++t) {
      readout.taxel_gain.push_back(random.uniform(0, 1.5));
      readout.taxel_trigger.push_back(random.uniform(0, 0.1));
    }
  }
  Random other = random;  // what is drawn after this stays as it was
  if (other.chance(0.3)) readout.curve_limit = other.uniform(1.1, 5) * readout.saturation / readout.output_scale;
  if (readout.curve_limit == 0 && other.chance(0.3)) {
    readout.curve = {1};
    CurvePoint point;
    const int num_points = other.integer(1, kMaxCurvePoints);
    const double force = other.uniform(0.2, 4) / num_points;  // N, to about saturation
    for (int k = 0; k < num_points; ++k) {
      point.force += other.uniform(0.3, 1.7) * force;
      point.counts += other.uniform(0.1, 1.9) * readout.saturation / readout.output_scale / num_points;
      readout.curve_points.push_back(point);
    }
  }
  return sensor;
}

Mesh boxMesh(const Vector3& size) {
  Mesh mesh;
  for (int corner = 0; corner < 8; ++corner) {
    mesh.vertices.push_back(
        toFloat({(corner & 1 ? 0.5 : -0.5) * size[0], (corner & 2 ? 0.5 : -0.5) * size[1], (corner & 4 ? 0.5 : -0.5) * size[2]}));
  }
  mesh.triangles = {{0, 2, 3}, {0, 3, 1}, {4, 5, 7}, {4, 7, 6}, {0, 1, 5}, {0, 5, 4},
                    {2, 6, 7}, {2, 7, 3}, {0, 4, 6}, {0, 6, 2}, {1, 3, 7}, {1, 7, 5}};
  return mesh;
}

Mesh icosphere(double radius, int num_subdivisions, double noise, Random& random) {
  const double g = std::numbers::phi;
  std::vector<Vector3> vertices{{-1, g, 0},  {1, g, 0},  {-1, -g, 0}, {1, -g, 0}, {0, -1, g},  {0, 1, g},
                                {0, -1, -g}, {0, 1, -g}, {g, 0, -1},  {g, 0, 1},  {-g, 0, -1}, {-g, 0, 1}};
  std::vector<std::array<std::uint32_t, 3>> triangles{{0, 11, 5},  {0, 5, 1},  {0, 1, 7},  {0, 7, 10}, {0, 10, 11}, {1, 5, 9}, {5, 11, 4},
                                                      {11, 10, 2}, {10, 7, 6}, {7, 1, 8},  {3, 9, 4},  {3, 4, 2},   {3, 2, 6}, {3, 6, 8},
                                                      {3, 8, 9},   {4, 9, 5},  {2, 4, 11}, {6, 2, 10}, {8, 6, 7},   {9, 8, 1}};
  for (int level = 0; level < num_subdivisions; ++level) {
    std::map<std::pair<std::uint32_t, std::uint32_t>, std::uint32_t> middles;
    const auto middleOf = [&](std::uint32_t a, std::uint32_t b) {
      const auto [entry, is_new] = middles.try_emplace(std::minmax(a, b), static_cast<std::uint32_t>(vertices.size()));
      if (is_new) {
        vertices.push_back(scale(0.5, add(scale(1 / length(vertices[a]), vertices[a]), scale(1 / length(vertices[b]), vertices[b]))));
      }
      return entry->second;
    };
    std::vector<std::array<std::uint32_t, 3>> finer;
    for (const auto& [a, b, c] : triangles) {
      const std::uint32_t ab = middleOf(a, b), bc = middleOf(b, c), ca = middleOf(c, a);
      finer.insert(finer.end(), {{a, ab, ca}, {ab, b, bc}, {ca, bc, c}, {ab, bc, ca}});
    }
    triangles = finer;
  }
  Mesh mesh;
  for (const Vector3& v : vertices) {
    mesh.vertices.push_back(toFloat(scale(radius * (1 + noise * random.uniform(-1, 1)) / length(v), v)));
  }
  mesh.triangles = triangles;
  return mesh;
}

Mesh prism(const std::vector<std::array<double, 2>>& outline_xz, double length_y) {
  Mesh mesh;
  const auto n = static_cast<std::uint32_t>(outline_xz.size());
  for (const double y : {-length_y / 2, length_y / 2}) {
    for (const auto& [x, z] : outline_xz) {
      mesh.vertices.push_back(toFloat({x, y, z}));
    }
  }
  for (std::uint32_t i = 0; i < n; ++i) {
    const std::uint32_t next = (i + 1) % n;
    mesh.triangles.push_back({i, next, n + next});
    mesh.triangles.push_back({i, n + next, n + i});
    if (i >= 2) {
      mesh.triangles.push_back({0, i, i - 1});
      mesh.triangles.push_back({n, n + i - 1, n + i});
    }
  }
  return mesh;
}

Mesh triangleSoup(int num_triangles, double size, Random& random) {
  Mesh mesh;
  for (int t = 0; t < num_triangles; ++t) {
    const Vector3 middle{random.uniform(-size, size), random.uniform(-size, size), random.uniform(-size, size)};
    for (int corner = 0; corner < 3; ++corner) {
      const double spread = size / 2;
      mesh.vertices.push_back(
          toFloat(add(middle, {random.uniform(-spread, spread), random.uniform(-spread, spread), random.uniform(-spread, spread)})));
    }
    const auto first = static_cast<std::uint32_t>(3 * t);
    mesh.triangles.push_back({first, first + 1, first + 2});
  }
  return mesh;
}

Mesh sheetWithHoles(int num_cells, double size, double roughness, double hole_probability, Random& random) {
  Mesh mesh;
  for (int i = 0; i <= num_cells; ++i) {
    for (int j = 0; j <= num_cells; ++j) {
      mesh.vertices.push_back(toFloat({(static_cast<double>(i) / num_cells - 0.5) * size, (static_cast<double>(j) / num_cells - 0.5) * size,
                                       roughness * random.uniform(-1, 1)}));
    }
  }
  for (int i = 0; i < num_cells; ++i) {
    for (int j = 0; j < num_cells; ++j) {
      const auto corner = static_cast<std::uint32_t>(i * (num_cells + 1) + j), next_row = corner + num_cells + 1;
      if ((i > 0 || j > 0) && random.chance(hole_probability)) {
        continue;
      }
      mesh.triangles.push_back({corner, corner + 1, next_row + 1});
      mesh.triangles.push_back({corner, next_row + 1, next_row});
    }
  }
  return mesh;
}

Object randomMeshObject(Random& random, double size) {
  switch (random.integer(0, 4)) {
    case 0:
      return Object("bumpy sphere", icosphere(size / 2, random.integer(0, 3), random.uniform(0, 0.1), random));
    case 1: {
      std::vector<std::array<double, 2>> outline;
      const int num_corners = random.integer(3, 12);
      for (int n = 0; n < num_corners; ++n) {
        const double angle = 2 * std::numbers::pi * n / num_corners;
        outline.push_back({size / 2 * std::cos(angle), size / 2 * std::sin(angle)});
      }
      return Object("prism", prism(outline, random.uniform(0.2, 2) * size));
    }
    case 2:
      return Object("soup", triangleSoup(random.integer(1, 60), size / 2, random));
    case 3:
      return Object("sheet", sheetWithHoles(random.integer(1, 12), size, size / 20, 0.3, random));
    default:
      return Object("box", boxMesh({random.uniform(0.2, 1) * size, random.uniform(0.2, 1) * size, random.uniform(0.2, 1) * size}));
  }
}

Object randomPolyhedron(Random& random, double size) {
  std::vector<std::array<double, 2>> outline;
  const int num_corners = random.integer(3, 14);
  const double stretch = random.uniform(0.3, 1);
  for (int n = 0; n < num_corners; ++n) {
    const double angle = 2 * std::numbers::pi * (n + random.uniform(-0.3, 0.3)) / num_corners;
    outline.push_back({size / 2 * std::cos(angle), stretch * size / 2 * std::sin(angle)});
  }
  return Object("polyhedron", prism(outline, random.uniform(0.1, 2) * size));
}

Object randomSolid(Random& random, double size) {
  switch (random.integer(0, 6)) {
    case 0:
      return Object("sphere", Sphere{random.uniform(0.1, 1) * size});
    case 1:
      return Object("cylinder", Cylinder{random.uniform(0.1, 1) * size, random.uniform(0.1, 2) * size});
    case 2:
      return Object("capsule", Capsule{random.uniform(0.1, 0.5) * size, random.uniform(0, 1) * size});
    case 3:
      return Object("box", Box{{random.uniform(0.1, 1) * size, random.uniform(0.1, 1) * size, random.uniform(0.1, 1) * size}});
    case 4:
      return Object("half_space", HalfSpace{});
    case 5:
      return Object("cone", Cone{random.uniform(0.1, 1) * size, random.uniform(0.1, 1) * size});
    default: {
      const double major = random.uniform(0.2, 1) * size;
      return Object("torus", Torus{major, random.uniform(0.1, 0.9) * major});
    }
  }
}

Quaternion randomRotation(Random& random, const Object& object) {
  return std::holds_alternative<HalfSpace>(object.shape) ? random.tilt(0.5) : random.rotation();
}

Pose poseAtDepth(const Sensor& sensor, const Object& object, const Quaternion& R_SO, double x, double y, double depth) {
  Pose X_SO{{x, y, 0}, R_SO};
  const reference::PlacedObject placed{&object, X_SO};
  Sensor points = sensor;
  points.depth_sampling = DepthSampling::kPoint;  // faster, and near enough
  const reference::LoadResult touch = reference::findLoad(points, {&placed, 1}, 0);
  if (touch.reached) {
    X_SO.position[2] = touch.first_touch - depth;
  } else {
    X_SO.position = sensor.patches.front().X_SP.position;
  }
  return X_SO;
}

Pose randomContact(Random& random, const Sensor& sensor, const Object& object) {
  const GridPatch& patch = sensor.patches[random.integer(0, static_cast<int>(sensor.patches.size()) - 1)];
  const Vector3 place = patch.X_SP * Vector3{random.uniform(-0.5, 0.5) * patch.num_rows * patch.pitch[0],
                                             random.uniform(-0.5, 0.5) * patch.num_cols * patch.pitch[1], 0};
  const Quaternion R_SO = randomRotation(random, object);
  return poseAtDepth(sensor, object, R_SO, place[0], place[1], random.uniform(0, 1.2) * sensor.skin.thickness);
}

std::vector<Object> randomObjects(Random& random, int count, double size, double solid_share, bool all_convex) {
  std::vector<Object> objects;
  for (int n = 0; n < count; ++n) {
    objects.push_back(random.chance(solid_share) ? randomSolid(random, size)
                      : all_convex               ? randomPolyhedron(random, size)
                                                 : randomMeshObject(random, size));
  }
  return objects;
}

int randomWorkgroup(Random& random) {
  constexpr std::array kSizes{0, 4, 8, 16, 32, 64, 128, 256};
  return kSizes[static_cast<std::size_t>(random.integer(0, kSizes.size() - 1))];
}

}  // namespace taxelsim::support
