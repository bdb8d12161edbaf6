#include <algorithm>
#include <array>
#include <cctype>
#include <cmath>
#include <new>
#include <stdexcept>
#include <string>
#include <system_error>
#include <utility>

#include "base/field_checks.h"
#include "base/log.h"
#include "base/text.h"
#include "geometry/binary_file.h"
#include "geometry/gltf_file.h"
#include "geometry/mesh_bounds.h"
#include "geometry/obj_file.h"
#include "geometry/object_fields.h"
#include "geometry/ply_file.h"
#include "geometry/simplification_cache.h"
#include "geometry/stl_file.h"
#include "geometry/unit_check.h"
#include "geometry/weld.h"
#include "taxelsim/error.h"
#include "taxelsim/object.h"

namespace taxelsim {
namespace {

[[noreturn]] void fail(const std::filesystem::path& file, const std::string& reason) {
  throw Error(ErrorKind::kInput, oneLine(file.string()) + ": " + oneLine(reason));
}

enum class MeshFormat { kObj, kStl, kPly, kGltf, kGlb };

MeshFormat formatOf(const std::filesystem::path& file) {
  std::string extension = file.extension().string();
  for (char& c : extension) c = static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
  if (extension == ".obj") return MeshFormat::kObj;
  if (extension == ".stl") return MeshFormat::kStl;
  if (extension == ".ply") return MeshFormat::kPly;
  if (extension == ".gltf") return MeshFormat::kGltf;
  if (extension == ".glb") return MeshFormat::kGlb;
  fail(file, "unsupported mesh format: the name must end in .obj, .stl, .ply, .glb or .gltf");
}

void checkFile(const std::filesystem::path& file) {
  std::error_code error;
  const std::filesystem::file_status status = std::filesystem::status(file, error);
  if (!std::filesystem::exists(status)) fail(file, "no such file");
  if (std::filesystem::is_directory(status)) fail(file, "is a directory, not a mesh file");
  if (!std::filesystem::is_regular_file(status)) fail(file, "is not a regular file");
  const std::uintmax_t size = std::filesystem::file_size(file, error);
  if (error) fail(file, "cannot be read: " + error.message());
  if (size == 0) fail(file, "is empty");
  if (size > kMaxMeshFileBytes) {
    fail(file, "has " + std::to_string(size) + " bytes; at most " + std::to_string(kMaxMeshFileBytes) + " are allowed");
  }
}

// Index of the file's coordinate that becomes x, y, z.
std::array<std::size_t, 3> axisOrder(UpAxis up_axis) {
  switch (up_axis) {
    case UpAxis::kX:
      return {1, 2, 0};
    case UpAxis::kY:
      return {2, 0, 1};
    case UpAxis::kZ:
      break;
  }
  return {0, 1, 2};
}

// Scales a point of the file and permutes its axes as the options say.
class Placement {
 public:
  Placement(const std::filesystem::path& file, const MeshOptions& options)
      : file_(file), scale_(options.scale), order_(axisOrder(options.up_axis)) {}

  std::array<float, 3> operator()(const std::array<double, 3>& p, std::size_t vertex) const {
    std::array<float, 3> placed;
    for (std::size_t axis = 0; axis < 3; ++axis) {
      placed[axis] = static_cast<float>(scale_ * p[order_[axis]]);
      if (!std::isfinite(placed[axis])) {
        fail(file_, "vertex " + std::to_string(vertex) + " is not finite: (" + numberText(p[0]) + ", " + numberText(p[1]) + ", " +
                        numberText(p[2]) + ") x scale " + numberText(scale_));
      }
    }
    return placed;
  }

 private:
  const std::filesystem::path& file_;
  double scale_;
  std::array<std::size_t, 3> order_;
};

// Points of the file in metres, with the axes that the options say.
Mesh readMesh(const std::filesystem::path& file, MeshFormat format, const MeshOptions& options) {
  const Placement place(file, options);
  const bool is_gltf = format == MeshFormat::kGltf || format == MeshFormat::kGlb;
  Mesh mesh;
  std::string problem;
  if (is_gltf) {
    problem = readGltf(file, format == MeshFormat::kGlb, place, mesh);
  } else if (format == MeshFormat::kStl) {
    problem = readStl(file, mesh);
  } else {
    const std::string bytes = readStart(file, static_cast<std::size_t>(kMaxMeshFileBytes));
    problem = format == MeshFormat::kObj ? readObj(bytes, mesh) : readPly(bytes, mesh);
  }
  if (!problem.empty()) fail(file, "is not a mesh: " + problem);
  for (std::size_t i = 0; i < mesh.vertices.size() && !is_gltf; ++i) {
    const std::array<float, 3>& v = mesh.vertices[i];
    mesh.vertices[i] = place({v[0], v[1], v[2]}, i);
  }
  return weld(mesh);
}

// The mesh, scaled to a bounding box whose longest side is `size`, m.
Mesh resized(Mesh mesh, double size) {
  const Bounds bounds = meshBounds(mesh);
  double longest = 0;
  for (std::size_t axis = 0; axis < 3; ++axis) longest = std::max(longest, bounds.max[axis] - bounds.min[axis]);
  for (std::array<float, 3>& vertex : mesh.vertices) {
    for (float& coordinate : vertex) coordinate = static_cast<float>(coordinate * (size / longest));
  }
  return weld(mesh);
}

}  // namespace

Mesh loadMesh(const std::filesystem::path& file, const MeshOptions& options) {
  try {
    checkFields("", kMeshScaleFields, options);
    checkFields("", kMeshSizeFields, options);
    checkFields("", kMeshErrorFields, options);
  } catch (const Error& error) {
    fail(file, error.what());
  }
  checkFile(file);
  const MeshFormat format = formatOf(file);
  Mesh mesh;
  try {
    Mesh full = readMesh(file, format, options);
    if (options.size) full = resized(std::move(full), *options.size);
    const std::string size = implausibleSize(meshBounds(full), "is the file in millimetres? scale: " + numberText(options.scale / 1000),
                                             "was it scaled twice? scale: " + numberText(options.scale * 1000));
    if (!size.empty()) logWarning(oneLine(file.string()) + ": the mesh " + size);
    mesh = simplifyMeshOnce(full, options.max_depth_error);
    if (mesh.triangles.size() < full.triangles.size()) {
      logDebug(oneLine(file.string()) + ": " + std::to_string(mesh.triangles.size()) + " of " + std::to_string(full.triangles.size()) +
               " triangles after simplification to " + numberText(options.max_depth_error) + " m");
    }
  } catch (const std::bad_alloc&) {
    fail(file, "not enough memory to load it");
  } catch (const std::length_error&) {
    fail(file, "not enough memory to load it");
  }
  if (mesh.triangles.empty()) fail(file, "has no triangle with an area");
  return mesh;
}

}  // namespace taxelsim
