#include <assimp/postprocess.h>
#include <assimp/scene.h>

#include <assimp/BaseImporter.h>
#include <assimp/DefaultIOSystem.h>
#include <algorithm>
#include <array>
#include <assimp/Importer.hpp>
#include <cctype>
#include <cmath>
#include <new>
#include <optional>
#include <set>
#include <string>
#include <system_error>
#include <utility>
#include <vector>

#include "base/field_checks.h"
#include "base/log.h"
#include "base/text.h"
#include "geometry/binary_file.h"
#include "geometry/gltf_validation.h"
#include "geometry/mesh_bounds.h"
#include "geometry/obj_file.h"
#include "geometry/object_fields.h"
#include "geometry/ply_file.h"
#include "geometry/simplification_cache.h"
#include "geometry/stl_file.h"
#include "geometry/triangulate.h"
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

struct Extension {
  std::string text;  // lower case, without the dot
  MeshFormat format;
};

Extension extensionOf(const std::filesystem::path& file) {
  std::string text = file.extension().string();
  for (char& c : text) c = static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
  if (text == ".obj") return {"obj", MeshFormat::kObj};
  if (text == ".stl") return {"stl", MeshFormat::kStl};
  if (text == ".ply") return {"ply", MeshFormat::kPly};
  if (text == ".gltf") return {"gltf", MeshFormat::kGltf};
  if (text == ".glb") return {"glb", MeshFormat::kGlb};
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

// Restricts the files that Assimp may open to the mesh itself and, for .gltf, the regular files that it names for its buffers. Material and
// texture files are not opened. A .glb has all of its geometry, so that its SHA-256 covers it. A pipe or device cannot block the program.
class RestrictedIOSystem : public Assimp::DefaultIOSystem {
 public:
  RestrictedIOSystem(std::filesystem::path file, bool allow_buffers) : file_(std::move(file)), allow_buffers_(allow_buffers) {}

  Assimp::IOStream* Open(const char* name, const char* mode) override {
    const std::filesystem::path requested(name);
    std::error_code error;
    if (requested != file_ && !allow_buffers_) return nullptr;
    if (!std::filesystem::is_regular_file(requested, error)) return nullptr;
    const std::uintmax_t size = std::filesystem::file_size(requested, error);
    if (error || size > kMaxMeshFileBytes) return nullptr;
    return DefaultIOSystem::Open(name, mode);
  }

 private:
  std::filesystem::path file_;
  bool allow_buffers_;
};

// Removes all other importers. Without this, Assimp tries them on a file that the importer for its extension rejects.
void keepOnlyImporterFor(Assimp::Importer& importer, const std::string& extension) {
  std::vector<Assimp::BaseImporter*> others;
  for (std::size_t i = 0; i < importer.GetImporterCount(); ++i) {
    std::set<std::string> extensions;
    importer.GetImporter(i)->GetExtensionList(extensions);
    if (!extensions.contains(extension)) others.push_back(importer.GetImporter(i));
  }
  for (Assimp::BaseImporter* other : others) {
    importer.UnregisterLoader(other);
    delete other;
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

using Matrix = std::array<double, 12>;  // (3 x 4), row-major: rotation and scale, then translation

Matrix matrixOf(const aiMatrix4x4& m) {
  return {m.a1, m.a2, m.a3, m.a4, m.b1, m.b2, m.b3, m.b4, m.c1, m.c2, m.c3, m.c4};
}

Matrix product(const Matrix& a, const Matrix& b) {
  Matrix result{};
  for (std::size_t row = 0; row < 3; ++row) {
    for (std::size_t column = 0; column < 4; ++column) {
      double sum = column == 3 ? a[row * 4 + 3] : 0;
      for (std::size_t k = 0; k < 3; ++k) sum += a[row * 4 + k] * b[k * 4 + column];
      result[row * 4 + column] = sum;
    }
  }
  return result;
}

// Flattens the node tree of an imported scene into one mesh.
class SceneFlattener {
 public:
  SceneFlattener(const std::filesystem::path& file, const MeshOptions& options) : file_(file), place_(file, options) {}

  // All meshes, once per node that uses them, in the root frame of the file. Vertices are scaled and their axes permuted as
  // the options say.
  Mesh flatten(const aiScene& scene) {
    std::vector<std::pair<const aiNode*, Matrix>> pending{{scene.mRootNode, matrixOf(scene.mRootNode->mTransformation)}};
    while (!pending.empty()) {
      const auto [node, transform] = pending.back();
      pending.pop_back();
      for (unsigned int i = 0; i < node->mNumMeshes; ++i) add(*scene.mMeshes[node->mMeshes[i]], transform);
      for (unsigned int i = node->mNumChildren; i-- > 0;) {
        pending.emplace_back(node->mChildren[i], product(transform, matrixOf(node->mChildren[i]->mTransformation)));
      }
    }
    return std::move(mesh_);
  }

 private:
  void add(const aiMesh& part, const Matrix& transform) {
    const std::size_t first = mesh_.vertices.size();
    if (first + part.mNumVertices >= std::size_t{1} << 31) fail(file_, "has more vertices than 2^31");
    for (unsigned int i = 0; i < part.mNumVertices; ++i) {
      const aiVector3D& v = part.mVertices[i];
      std::array<double, 3> p;
      for (std::size_t row = 0; row < 3; ++row) {
        p[row] = transform[row * 4] * v.x + transform[row * 4 + 1] * v.y + transform[row * 4 + 2] * v.z + transform[row * 4 + 3];
      }
      mesh_.vertices.push_back(place_(p, first + i));
    }
    for (unsigned int i = 0; i < part.mNumFaces; ++i) {
      const aiFace& face = part.mFaces[i];
      if (face.mNumIndices != 3) continue;  // points and lines
      std::array<std::uint32_t, 3> triangle;
      for (unsigned int corner = 0; corner < 3; ++corner) {
        if (face.mIndices[corner] >= part.mNumVertices) {
          fail(file_, "a face uses vertex " + std::to_string(face.mIndices[corner]) + " of " + std::to_string(part.mNumVertices));
        }
        triangle[corner] = static_cast<std::uint32_t>(first + face.mIndices[corner]);
      }
      mesh_.triangles.push_back(triangle);
    }
  }

  const std::filesystem::path& file_;
  Placement place_;
  Mesh mesh_;
};

// Checks what the triangulation relies on: finite coordinates, indices in range, a limit on corners, no face without one.
void checkScene(const aiScene& scene, const std::filesystem::path& file) {
  for (unsigned int m = 0; m < scene.mNumMeshes; ++m) {
    const aiMesh& mesh = *scene.mMeshes[m];
    for (unsigned int i = 0; i < mesh.mNumVertices; ++i) {
      const aiVector3D& v = mesh.mVertices[i];
      if (!(std::isfinite(v.x) && std::isfinite(v.y) && std::isfinite(v.z))) {
        fail(file, "vertex " + std::to_string(i) + " of part " + std::to_string(m) + " is not finite: (" + numberText(v.x) + ", " +
                       numberText(v.y) + ", " + numberText(v.z) + ")");
      }
    }
    for (unsigned int i = 0; i < mesh.mNumFaces; ++i) {
      const aiFace& face = mesh.mFaces[i];
      if (face.mNumIndices == 0)
        fail(file, "face " + std::to_string(i) + " has no corners; 1 to " + std::to_string(kMaxPolygonCorners) + " are allowed");
      if (face.mNumIndices > kMaxPolygonCorners) {
        fail(file, "face " + std::to_string(i) + " has " + std::to_string(face.mNumIndices) + " corners; at most " +
                       std::to_string(kMaxPolygonCorners) + " are allowed");
      }
      for (unsigned int corner = 0; corner < face.mNumIndices; ++corner) {
        if (face.mIndices[corner] >= mesh.mNumVertices) {
          fail(file, "face " + std::to_string(i) + " uses vertex " + std::to_string(face.mIndices[corner]) + " of " +
                         std::to_string(mesh.mNumVertices));
        }
      }
    }
  }
}

void checkTriangleCount(const aiScene& scene, const std::filesystem::path& file, MeshFormat format) {
  const std::optional<std::uint64_t> expected = countGltfTriangles(file, format == MeshFormat::kGlb);
  std::uint64_t found = 0;
  for (unsigned int m = 0; m < scene.mNumMeshes; ++m) found += scene.mMeshes[m]->mNumFaces;
  if (expected && found < *expected) {
    fail(file, std::to_string(*expected - found) + " of its " + std::to_string(*expected) + " triangles use vertices out of range");
  }
}

// glTF.
Mesh importMesh(const std::filesystem::path& file, const Extension& extension, const MeshOptions& options) {
  if (const std::string problem = validateGltf(file, extension.format == MeshFormat::kGlb); !problem.empty())
    fail(file, "is not a mesh: " + problem);
  Assimp::Importer importer;
  keepOnlyImporterFor(importer, extension.text);
  importer.SetIOHandler(new RestrictedIOSystem(file, extension.format == MeshFormat::kGltf));  // owned by the importer
  const aiScene* scene = importer.ReadFile(file.string(), 0);
  if (scene == nullptr) fail(file, std::string("is not a mesh: ") + importer.GetErrorString());
  checkScene(*scene, file);
  checkTriangleCount(*scene, file, extension.format);
  scene = importer.ApplyPostProcessing(aiProcess_Triangulate);
  if (scene == nullptr || scene->mRootNode == nullptr) fail(file, "is not a mesh: its polygons cannot be triangulated");
  return weld(SceneFlattener(file, options).flatten(*scene));
}

// OBJ, STL and PLY.
Mesh readMesh(const std::filesystem::path& file, MeshFormat format, const MeshOptions& options) {
  Mesh mesh;
  std::string problem;
  if (format == MeshFormat::kStl) {
    problem = readStl(file, mesh);
  } else {
    const std::string bytes = readStart(file, static_cast<std::size_t>(kMaxMeshFileBytes));
    problem = format == MeshFormat::kObj ? readObj(bytes, mesh) : readPly(bytes, mesh);
  }
  if (!problem.empty()) fail(file, "is not a mesh: " + problem);
  const Placement place(file, options);
  for (std::size_t i = 0; i < mesh.vertices.size(); ++i) {
    const std::array<float, 3>& v = mesh.vertices[i];
    mesh.vertices[i] = place({v[0], v[1], v[2]}, i);
  }
  return weld(mesh);
}

}  // namespace

Mesh loadMesh(const std::filesystem::path& file, const MeshOptions& options) {
  try {
    checkFields("", kMeshScaleFields, options);
    checkFields("", kMeshErrorFields, options);
  } catch (const Error& error) {
    fail(file, error.what());
  }
  checkFile(file);
  const Extension extension = extensionOf(file);
  Mesh mesh;
  try {
    const bool is_gltf = extension.format == MeshFormat::kGltf || extension.format == MeshFormat::kGlb;
    const Mesh full = is_gltf ? importMesh(file, extension, options) : readMesh(file, extension.format, options);
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
