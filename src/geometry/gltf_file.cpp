#include "geometry/gltf_file.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <nlohmann/json.hpp>
#include <optional>
#include <string_view>
#include <utility>
#include <vector>

#include "geometry/binary_file.h"
#include "geometry/gltf_accessor.h"
#include "geometry/gltf_json.h"

namespace taxelsim {
namespace {

// Of all nodes together: nodes can share a mesh, so that a small file can have many.
constexpr std::size_t kMaxGltfVertices = std::size_t{1} << 24;
constexpr std::size_t kMaxGltfTriangles = std::size_t{1} << 24;
constexpr float kMaxQuaternionError = 0.01f;  // of the length of a rotation, which is often written with few digits

enum class Mode : std::uint64_t { kTriangles = 4, kStrip = 5, kFan = 6 };  // below: points and lines

using Matrix = std::array<double, 12>;  // (3 x 4), row-major: rotation and scale, then translation
constexpr Matrix kIdentity{1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0};

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

Matrix matrixOf(const GltfItem& node) {
  const std::vector<float> m = node.numbers("matrix", std::vector<float>(16));
  if (m[3] != 0 || m[7] != 0 || m[11] != 0 || m[15] != 1) node.refuse("matrix", "the last row 0, 0, 0, 1");
  for (const char* key : {"translation", "rotation", "scale"}) {
    if (node.has(key)) node.refuse(key, "either this or a matrix");
  }
  return {m[0], m[4], m[8], m[12], m[1], m[5], m[9], m[13], m[2], m[6], m[10], m[14]};
}

// In float32, as Assimp computed it.
Matrix transformOf(const GltfItem& node) {
  if (node.has("matrix")) return matrixOf(node);
  const std::vector<float> t = node.numbers("translation", {0, 0, 0}), q = node.numbers("rotation", {0, 0, 0, 1}),
                           s = node.numbers("scale", {1, 1, 1});
  const float x = q[0], y = q[1], z = q[2], w = q[3];
  if (!(std::abs(std::sqrt(x * x + y * y + z * z + w * w) - 1) <= kMaxQuaternionError)) node.refuse("rotation", "a quaternion of length 1");
  const std::array<float, 9> r{1 - 2 * (y * y + z * z), 2 * (x * y - z * w),     2 * (x * z + y * w),
                               2 * (x * y + z * w),     1 - 2 * (x * x + z * z), 2 * (y * z - x * w),
                               2 * (x * z - y * w),     2 * (y * z + x * w),     1 - 2 * (x * x + y * y)};
  Matrix matrix;
  for (std::size_t row = 0; row < 3; ++row) {
    for (std::size_t column = 0; column < 3; ++column) matrix[row * 4 + column] = r[row * 3 + column] * s[column];
    matrix[row * 4 + 3] = t[row];
  }
  return matrix;
}

struct Container {
  std::string_view json;
  std::optional<std::string_view> binary_chunk;  // of a .glb
};

// Bytes of a .glb: a header of magic, version and length; then chunks of length, type and content, JSON first.
Container openContainer(std::string_view bytes) {
  constexpr std::size_t kHeader = 12, kChunkHeader = 8;
  if (!bytes.starts_with("glTF") || bytes.size() < kHeader) throw GltfProblem{"it is not binary glTF"};
  if (const std::uint32_t version = readLittleEndian32(bytes.substr(4)); version != 2)
    throw GltfProblem{"it is binary glTF of version " + std::to_string(version) + "; 2 is allowed"};
  const std::uint32_t length = readLittleEndian32(bytes.substr(8));
  if (length > bytes.size() || length < kHeader)
    throw GltfProblem{"its header claims " + std::to_string(length) + " bytes, but it has " + std::to_string(bytes.size())};
  bytes = bytes.substr(kHeader, length - kHeader);
  std::vector<std::string_view> types, chunks;
  while (bytes.size() >= kChunkHeader && chunks.size() < 2) {  // others follow
    const std::uint32_t size = readLittleEndian32(bytes);
    types.push_back(bytes.substr(4, 4));
    bytes.remove_prefix(kChunkHeader);
    if (size > bytes.size()) throw GltfProblem{"its chunk " + std::to_string(chunks.size()) + " is longer than the file"};
    chunks.push_back(bytes.substr(0, size));
    bytes.remove_prefix(size);
  }
  if (types.empty() || types[0] != "JSON") throw GltfProblem{"its first chunk is not JSON"};
  const bool has_binary = types.size() == 2 && types[1] == std::string_view("BIN\0", 4);
  chunks[0] = chunks[0].substr(0, chunks[0].find_last_not_of('\0') + 1);  // padding of some writers
  return {.json = chunks[0], .binary_chunk = has_binary ? chunks[1] : std::string_view()};
}

class GltfReader {
 public:
  GltfReader(const nlohmann::json& json, const std::filesystem::path& file, std::optional<std::string_view> binary_chunk,
             const PlaceVertex& place, Mesh& mesh)
      : root_(json), buffers_(root_, file, binary_chunk), place_(place), mesh_(mesh), parts_(root_.size("meshes")) {}

  void read() {
    checkVersion();
    checkExtensions();
    placeNodes(root_.entry("scenes", root_.index("scene", "scenes", root_.size("scenes"), 0)));
  }

 private:
  struct Part {  // a primitive with triangles
    GltfAccessor positions;
    std::optional<GltfAccessor> indices;
    Mode mode;
    std::string path;
  };

  struct PlacedNode {
    std::size_t node;
    Matrix parent;
  };

  void checkVersion() const {
    const GltfItem asset = root_.object("asset");
    if (!asset.text("version").starts_with("2.")) asset.refuse("version", "2.0");
    if (asset.has("minVersion") && asset.text("minVersion") != "2.0") asset.refuse("minVersion", "2.0");
  }

  void checkExtensions() {
    for (const std::string& name : root_.texts("extensionsRequired")) {
      const bool is_appearance = name.starts_with("KHR_materials_") || name.starts_with("KHR_texture_") || name.starts_with("EXT_texture_");
      if (name == "KHR_mesh_quantization")
        has_quantization_ = true;
      else if (!is_appearance)
        throw GltfProblem{"it requires the extension " + shownGltfText(name) + ", which is not read: save the mesh without it"};
    }
  }

  // Depth first. Each node at most once: a node with two parents could make the tree exponentially large.
  void placeNodes(const GltfItem& scene) {
    const std::size_t num_nodes = root_.size("nodes");
    std::vector<bool> is_placed(num_nodes);
    std::vector<PlacedNode> pending;
    const auto push = [&](const GltfItem& parent, const char* key, const Matrix& transform) {
      const std::vector<std::size_t> nodes = parent.indices(key, "nodes", num_nodes);
      for (std::size_t i = nodes.size(); i-- > 0;) {
        if (is_placed[nodes[i]]) throw GltfProblem{"its nodes are not a tree: two lists name node " + std::to_string(nodes[i])};
        is_placed[nodes[i]] = true;
        pending.push_back({nodes[i], transform});
      }
    };
    push(scene, "nodes", kIdentity);
    while (!pending.empty()) {
      const PlacedNode placed = pending.back();
      pending.pop_back();
      const GltfItem node = root_.entry("nodes", placed.node);
      const Matrix transform = product(placed.parent, transformOf(node));
      checkNode(node);
      if (node.has("mesh")) {
        for (const Part& part : partsOf(node.index("mesh", "meshes", parts_.size()))) add(part, transform);
      }
      push(node, "children", transform);
    }
  }

  void checkNode(const GltfItem& node) const {
    refuseMorphTargets(node);
    if (node.has("extensions") && node.object("extensions").has("EXT_mesh_gpu_instancing"))
      node.object("extensions").refuse("EXT_mesh_gpu_instancing", "a node for each instance");
  }

  void refuseMorphTargets(const GltfItem& item) const {
    const std::vector<float> weights = item.numbers("weights", std::vector<float>(item.size("weights")));
    if (std::ranges::any_of(weights, [](float weight) { return weight != 0; })) item.refuse("weights", "zeros: apply the morph targets");
  }

  const std::vector<Part>& partsOf(std::size_t mesh) {
    if (parts_[mesh]) return *parts_[mesh];
    const GltfItem item = root_.entry("meshes", mesh);
    refuseMorphTargets(item);
    std::vector<Part>& parts = parts_[mesh].emplace();
    for (std::size_t i = 0; i < item.size("primitives"); ++i) {
      const GltfItem primitive = item.entry("primitives", i);
      const std::uint64_t mode = primitive.whole("mode", 6, static_cast<std::uint64_t>(Mode::kTriangles));
      if (mode >= static_cast<std::uint64_t>(Mode::kTriangles)) parts.push_back(partOf(primitive, static_cast<Mode>(mode)));
    }
    return parts;
  }

  Part partOf(const GltfItem& primitive, Mode mode) {
    const GltfItem attributes = primitive.object("attributes");
    Part part{.positions = accessor(attributes, "POSITION"), .indices = {}, .mode = mode, .path = primitive.path()};
    const GltfItem& positions = part.positions.item();
    if (part.positions.type() != "VEC3") positions.refuse("type", "VEC3 for POSITION");
    const NumberType number = part.positions.number();
    if (number != NumberType::kFloat32 && !(has_quantization_ && sizeOf(number) <= 2))
      positions.refuse("componentType", has_quantization_ ? "5120 to 5123 or 5126 for POSITION"
                                                          : "5126 for POSITION, others if extensionsRequired has KHR_mesh_quantization");
    for (const std::string& key : attributes.keys()) {
      const GltfItem other = root_.entry("accessors", attributes.index(key.c_str(), "accessors", root_.size("accessors")));
      if (other.whole("count", kMaxMeshFileBytes) != part.positions.count())
        other.refuse("count", std::to_string(part.positions.count()) + ", the count of " + attributes.path() + ".POSITION");
    }
    if (primitive.has("indices")) part.indices = indicesOf(primitive);
    const std::size_t num_corners = part.indices ? part.indices->count() : part.positions.count();
    if (mode == Mode::kTriangles && num_corners % 3 != 0)
      (part.indices ? part.indices->item() : positions).refuse("count", "a multiple of 3 for triangles");
    return part;
  }

  GltfAccessor indicesOf(const GltfItem& primitive) {
    GltfAccessor indices = accessor(primitive, "indices");
    const NumberType number = indices.number();
    if (indices.type() != "SCALAR") indices.item().refuse("type", "SCALAR for indices");
    if (number != NumberType::kUint8 && number != NumberType::kUint16 && number != NumberType::kUint32)
      indices.item().refuse("componentType", "5121, 5123 or 5125 for indices");
    if (indices.isNormalized()) indices.item().refuse("normalized", "false for indices");
    return indices;
  }

  GltfAccessor accessor(const GltfItem& item, const char* key) {
    return {root_, item.index(key, "accessors", root_.size("accessors")), buffers_};
  }

  void add(const Part& part, const Matrix& m) {
    const std::size_t first = mesh_.vertices.size(), num_vertices = part.positions.count();
    const std::size_t num_corners = part.indices ? part.indices->count() : num_vertices;
    const std::size_t num_triangles = part.mode == Mode::kTriangles ? num_corners / 3 : std::max<std::size_t>(num_corners, 2) - 2;
    if (first + num_vertices > kMaxGltfVertices || mesh_.triangles.size() + num_triangles > kMaxGltfTriangles)
      throw GltfProblem{"its nodes have more than " + std::to_string(kMaxGltfVertices) + " vertices or " +
                        std::to_string(kMaxGltfTriangles) + " triangles in all"};
    for (std::size_t i = 0; i < num_vertices; ++i) {
      const double x = part.positions.value(i, 0), y = part.positions.value(i, 1), z = part.positions.value(i, 2);
      mesh_.vertices.push_back(
          place_({m[0] * x + m[1] * y + m[2] * z + m[3], m[4] * x + m[5] * y + m[6] * z + m[7], m[8] * x + m[9] * y + m[10] * z + m[11]},
                 first + i));
    }
    const auto corner = [&](std::size_t i) {
      const std::size_t vertex = part.indices ? static_cast<std::size_t>(part.indices->value(i, 0)) : i;
      if (vertex >= num_vertices)
        throw GltfProblem{part.path + ": index " + std::to_string(vertex) + " is not allowed: it has " + std::to_string(num_vertices) +
                          " vertices"};
      return static_cast<std::uint32_t>(first + vertex);
    };
    for (std::size_t i = 0; i < num_triangles; ++i) {
      const std::size_t odd = i % 2;
      if (part.mode == Mode::kTriangles)
        mesh_.triangles.push_back({corner(3 * i), corner(3 * i + 1), corner(3 * i + 2)});
      else if (part.mode == Mode::kStrip)  // with alternating orientation
        mesh_.triangles.push_back({corner(i + odd), corner(i + 1 - odd), corner(i + 2)});
      else
        mesh_.triangles.push_back({corner(0), corner(i + 1), corner(i + 2)});
    }
  }

  GltfItem root_;
  GltfBuffers buffers_;
  const PlaceVertex& place_;
  Mesh& mesh_;
  std::vector<std::optional<std::vector<Part>>> parts_;  // of each mesh, read when a node first uses it
  bool has_quantization_ = false;
};

}  // namespace

std::string readGltf(const std::filesystem::path& file, bool is_binary, const PlaceVertex& place, Mesh& mesh) {
  try {
    const std::string bytes = readStart(file, static_cast<std::size_t>(kMaxMeshFileBytes));
    const Container container = is_binary ? openContainer(bytes) : Container{.json = bytes, .binary_chunk = {}};
    const nlohmann::json json = parseGltfJson(container.json);
    GltfReader(json, file, container.binary_chunk, place, mesh).read();
  } catch (const GltfProblem& problem) {
    return problem.text;
  }
  return {};
}

}  // namespace taxelsim
