#include "peers/cases.h"

#include <unistd.h>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <numbers>
#include <optional>
#include <random>

#include "bench_objects.h"
#include "report.h"
#include "taxelsim/error.h"

namespace taxelsim::bench {
namespace {

constexpr std::uint64_t kPoseSeed = 1;
constexpr double kMaxDepthError = MeshOptions{}.max_depth_error;
constexpr Vector3 kEllipsoid{0.020, 0.014, 0.012};  // m
constexpr Cylinder kCylinder{.radius = 0.008, .length = 0.04};
constexpr int kStrips = 1024;  // of the cylinder's mesh for Embree
constexpr double kPi = std::numbers::pi;
constexpr const char* kSliding = "_sliding";
constexpr int kSlidingFrames = 8;     // per turn
constexpr double kSlide = 20e-6;      // m per frame: 20 mm/s at 1 kHz
constexpr double kTurning = 0.5e-3;   // rad per frame about z
constexpr double kGoldenAngle = 2.4;  // rad: instances slide in all directions
constexpr PoseSpread kAnySide{.rolls = true};

// A mesh in scenes/objects/; THIRD_PARTY.md has its source and licence.
struct ShippedMesh {
  const char* name;  // of the case
  const char* file;
  double scale;  // m per unit of the file
  UpAxis up_axis;
};
constexpr ShippedMesh kShipped[] = {
    {"drill", "YcbPowerDrill.obj", 1, UpAxis::kZ}, {"banana", "YcbBanana.obj", 1, UpAxis::kZ}, {"bunny", "bunny.obj", 0.005, UpAxis::kY}};
constexpr ShippedMesh kPrism{"prism", "hex_prism.obj", 1, UpAxis::kZ};

Mesh slab(double side, double height) {
  const auto a = static_cast<float>(side / 2), h = static_cast<float>(height / 2);
  Mesh mesh;
  for (int c = 0; c < 8; ++c) mesh.vertices.push_back({c & 1 ? a : -a, c & 2 ? a : -a, c & 4 ? h : -h});
  mesh.triangles = {{0, 2, 3}, {0, 3, 1}, {4, 5, 7}, {4, 7, 6}, {0, 1, 5}, {0, 5, 4},
                    {2, 6, 7}, {2, 7, 3}, {0, 4, 6}, {0, 6, 2}, {1, 3, 7}, {1, 7, 5}};
  return mesh;
}

// The mesh after a round trip through a file: simplified within `max_depth_error` (m).
Mesh asLoaded(const Mesh& mesh, double max_depth_error) {
  const std::filesystem::path file = std::filesystem::temp_directory_path() / ("taxelsim_bench_" + std::to_string(getpid()) + ".obj");
  {
    std::ofstream out(file);
    out.precision(9);
    for (const auto& [x, y, z] : mesh.vertices) out << "v " << x << ' ' << y << ' ' << z << '\n';
    for (const auto& [a, b, c] : mesh.triangles) out << "f " << a + 1 << ' ' << b + 1 << ' ' << c + 1 << '\n';
  }
  Mesh loaded = loadMesh(file, {.max_depth_error = max_depth_error});
  std::filesystem::remove(file);
  return loaded;
}

double halfDiagonal(const Sensor& sensor) {
  const GridPatch& patch = sensor.patches.at(0);
  return std::hypot(patch.num_rows * patch.pitch[0], patch.num_cols * patch.pitch[1]) / 2;
}

// The slab covers the whole array: 0.5 to 1.5 mm deep in the middle. Its tilt keeps every sample between 0.3 and 1.7 mm.
std::vector<Pose> slabPoses(const Sensor& sensor, double height, int count) {
  constexpr double kMinDepth = 0.5e-3, kMaxDepth = 1.5e-3, kMaxRise = 0.2e-3;  // m
  const double max_tilt = std::atan(kMaxRise / halfDiagonal(sensor));
  std::mt19937_64 engine(kPoseSeed);
  const auto uniform = [&](double low, double high) { return low + (high - low) * static_cast<double>(engine() >> 11) * 0x1p-53; };
  std::vector<Pose> poses;
  for (int i = 0; i < count; ++i) {
    const double direction = uniform(-kPi, kPi);
    const Quaternion R =
        axisAngle({std::cos(direction), std::sin(direction), 0}, uniform(0, max_tilt)) * axisAngle({0, 0, 1}, uniform(-kPi, kPi));
    const Vector3 face = rotate(R, {0, 0, -height / 2});
    poses.push_back({{-face[0], -face[1], -uniform(kMinDepth, kMaxDepth) - face[2]}, R});
  }
  return poses;
}

void append(Case& work, Object object, std::shared_ptr<const Mesh> mesh) {
  work.num_triangles += mesh->triangles.size();
  work.objects.push_back(std::move(object));
  work.meshes.push_back(std::move(mesh));
}

void appendCylinder(Case& work) {
  work.objects.push_back(Object("cylinder", kCylinder));
  work.meshes.push_back(std::make_shared<Mesh>(tessellatedCylinder(kCylinder.radius, kCylinder.length, kStrips)));
  work.note = "Embree has the cylinder in 1024 flat strips";
}

PoseSpread spreadOf(const Object& object) {
  return object.name == "cylinder" ? PoseSpread{.laid = axisAngle({0, 1, 0}, kPi / 2)} : kAnySide;
}

// Instance i gets object i modulo the number of objects.
void placeInTurn(Case& work, int num_instances) {
  const std::size_t num_objects = work.objects.size();
  std::vector<std::vector<Pose>> poses;
  for (const Object& object : work.objects)
    poses.push_back(randomPoses(object, spreadOf(object),
                                static_cast<int>((static_cast<std::size_t>(num_instances) + num_objects - 1) / num_objects), kPoseSeed));
  for (std::size_t i = 0; i < static_cast<std::size_t>(num_instances); ++i) {
    work.poses.ids.push_back(static_cast<int>(i % num_objects));
    work.poses.X_SO.push_back(poses[i % num_objects][i / num_objects]);
  }
}

// The pose after `frame` frames of sliding and turning about the point of the skin below the object.
Pose slid(const Pose& X_SO, std::size_t instance, int frame) {
  const double direction = kGoldenAngle * static_cast<double>(instance), way = kSlide * frame;
  const Vector3& p = X_SO.position;
  return {{p[0] + way * std::cos(direction), p[1] + way * std::sin(direction), p[2]},
          axisAngle({0, 0, 1}, kTurning * frame) * X_SO.rotation};
}

}  // namespace

std::vector<std::string> caseNames() {
  return {"cylinder_analytic",
          "prism_24",
          "ellipsoid_5120",
          "ellipsoid_81920",
          "ellipsoid_81920_10um",
          "ellipsoid_81920_10um_full",
          "ellipsoid_1310720_10um",
          "ellipsoid_1310720_10um_full",
          "drill",
          "banana",
          "bunny",
          "full_pad",
          "mixed",
          "ellipsoid_5120_sliding",
          "ellipsoid_81920_sliding",
          "ellipsoid_81920_10um_sliding",
          "ellipsoid_1310720_10um_sliding"};
}

std::vector<Poses> framesOf(const Case& work, int turn) {
  const std::size_t n = work.numInstances();
  std::vector<Poses> frames(work.slides ? kSlidingFrames : 1);
  for (std::size_t f = 0; f < frames.size(); ++f) {
    Poses& frame = frames[f];
    frame.ids.reserve(n);
    frame.X_SO.reserve(n);
    for (std::size_t i = 0; i < n; ++i) {
      const std::size_t from = work.slides ? i : (i + static_cast<std::size_t>(turn)) % n;
      const Pose& X_SO = work.poses.X_SO[from];
      frame.ids.push_back(work.poses.ids[from]);
      frame.X_SO.push_back(work.slides ? slid(X_SO, i, turn * kSlidingFrames + static_cast<int>(f)) : X_SO);
    }
  }
  return frames;
}

Sensor withArray(const Sensor& sensor, const std::string& array) {
  const auto number = [](std::string_view text) -> std::optional<int> {
    int value = 0;
    const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
    return error == std::errc() && end == text.data() + text.size() && value > 0 ? std::optional(value) : std::nullopt;
  };
  const std::size_t cross = array.find('x');
  const auto rows = cross == std::string::npos ? std::nullopt : number(std::string_view(array).substr(0, cross));
  const auto cols = cross == std::string::npos ? std::nullopt : number(std::string_view(array).substr(cross + 1));
  if (!rows || !cols) throw Error(ErrorKind::kInput, "--array " + array + ": not rows and columns as in 6x14");
  Sensor made = sensor;
  if (made.patches.size() != 1) throw Error(ErrorKind::kInput, sensor.name + ": the peers do sensors of one grid patch only");
  made.patches[0].num_rows = *rows;
  made.patches[0].num_cols = *cols;
  checkSensor(made);
  return made;
}

const CaseMaker::Kept& CaseMaker::shipped(const std::string& file, const MeshOptions& options) {
  Kept& kept = kept_[file];
  if (!kept.mesh) {
    const Stopwatch watch;
    kept.mesh = std::make_shared<Mesh>(loadMesh(objects_ + "/" + file, options));
    kept.load_seconds = watch.seconds();
  }
  return kept;
}

const CaseMaker::Kept& CaseMaker::ellipsoid(int levels) {
  Kept& kept = kept_["ellipsoid " + std::to_string(levels)];
  if (!kept.mesh) kept.mesh = std::make_shared<Mesh>(bench::ellipsoid(kEllipsoid, levels));
  return kept;
}

const CaseMaker::Kept& CaseMaker::simplified(int levels) {
  Kept& kept = kept_["simplified " + std::to_string(levels)];
  if (!kept.mesh) {
    const Mesh& full = *ellipsoid(levels).mesh;
    const Stopwatch watch;
    kept.mesh = std::make_shared<Mesh>(asLoaded(full, kMaxDepthError));
    kept.load_seconds = watch.seconds();
  }
  return kept;
}

void CaseMaker::addPrism(Case& work) {
  const Kept& kept = shipped(kPrism.file, {});
  append(work, Object(kPrism.name, *kept.mesh), kept.mesh);
}

void CaseMaker::addEllipsoid(Case& work, const char* name, int levels) {
  const Kept& kept = ellipsoid(levels);
  append(work, Object(name, *kept.mesh), kept.mesh);
}

void CaseMaker::addSimplified(Case& work, int levels, bool full_for_embree) {
  const Kept& kept = simplified(levels);
  const std::size_t before = ellipsoid(levels).mesh->triangles.size();
  append(work, Object("simplified_ellipsoid", *kept.mesh), kept.mesh);
  work.load_seconds = kept.load_seconds;
  work.note += (work.note.empty() ? "" : "; the finest object: ") + std::to_string(kept.mesh->triangles.size()) +
               " triangles, as loadMesh() leaves of " + std::to_string(before);
  if (!full_for_embree) return;
  work.meshes.back() = ellipsoid(levels).mesh;
  work.note += "; Embree has all of them";
  work.depth_tolerance = kMaxDepthError;
  work.embree_only = true;
}

bool CaseMaker::addShipped(Case& work, const std::string& name) {
  const auto* mesh =
      std::find_if(std::begin(kShipped), std::end(kShipped), [&](const ShippedMesh& shipped) { return shipped.name == name; });
  if (mesh == std::end(kShipped)) return false;
  const Kept& kept = shipped(mesh->file, {.scale = mesh->scale, .up_axis = mesh->up_axis});
  append(work, Object(name, *kept.mesh), kept.mesh);
  work.load_seconds = kept.load_seconds;
  return true;
}

void CaseMaker::addObjects(Case& work, const std::string& name) {
  if (name == "cylinder_analytic") {
    appendCylinder(work);
  } else if (name == "prism_24") {
    addPrism(work);
  } else if (name == "ellipsoid_5120") {
    addEllipsoid(work, "ellipsoid", 4);
  } else if (name == "ellipsoid_81920") {
    addEllipsoid(work, "fine_ellipsoid", 6);
  } else if (name == "ellipsoid_81920_10um" || name == "ellipsoid_81920_10um_full") {
    addSimplified(work, 6, name.ends_with("_full"));
  } else if (name == "ellipsoid_1310720_10um" || name == "ellipsoid_1310720_10um_full") {
    addSimplified(work, 8, name.ends_with("_full"));
  } else if (name == "mixed") {
    appendCylinder(work);
    addPrism(work);
    addEllipsoid(work, "ellipsoid", 4);
    addEllipsoid(work, "fine_ellipsoid", 6);
    addSimplified(work, 8, false);
  } else if (!addShipped(work, name)) {
    std::string known;
    for (const std::string& other : caseNames()) known += (known.empty() ? "" : ", ") + other;
    throw Error(ErrorKind::kInput, "--case " + work.name + ": not one of " + known);
  }
}

Case CaseMaker::make(const std::string& full_name, const Sensor& sensor, int num_instances) {
  Case work;
  work.name = full_name;
  work.slides = full_name.ends_with(kSliding);
  if (full_name == "full_pad") {
    constexpr double kHeight = 0.02;  // m
    const auto mesh = std::make_shared<Mesh>(slab(3 * halfDiagonal(sensor), kHeight));
    append(work, Object("slab", *mesh), mesh);
    work.poses.ids.assign(static_cast<std::size_t>(num_instances), 0);
    work.poses.X_SO = slabPoses(sensor, kHeight, num_instances);
    return work;
  }
  addObjects(work, work.slides ? full_name.substr(0, full_name.size() - std::string_view(kSliding).size()) : full_name);
  placeInTurn(work, num_instances);
  return work;
}

}  // namespace taxelsim::bench
