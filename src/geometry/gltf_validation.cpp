#include "geometry/gltf_validation.h"

#include <array>
#include <nlohmann/json.hpp>
#include <stdexcept>
#include <string_view>
#include <utility>
#include <vector>

#include "base/text.h"
#include "geometry/binary_file.h"
#include "taxelsim/object.h"

namespace taxelsim {
namespace {

using Json = nlohmann::json;

constexpr int kMaxJsonDepth = 64;
constexpr std::size_t kMaxNodeDepth = 256;
constexpr std::size_t kMaxShown = 40;  // bytes of a value that a message repeats

bool nestsTooDeep(std::string_view json) {
  int depth = 0;
  bool in_string = false;
  for (std::size_t i = 0; i < json.size(); ++i) {
    const char c = json[i];
    if (in_string) {
      if (c == '\\') ++i;
      if (c == '"') in_string = false;
    } else if (c == '"') {
      in_string = true;
    } else if (c == '[' || c == '{') {
      if (++depth > kMaxJsonDepth) return true;
    } else if (c == ']' || c == '}') {
      --depth;
    }
  }
  return false;
}

// Breadth-first search over the node tree. Also returns true for an invalid child index, a node with two parents, or a cycle.
bool isNodeTreeInvalid(const Json& nodes) {
  std::vector<std::size_t> num_parents(nodes.size(), 0);
  std::vector<std::vector<std::size_t>> children(nodes.size());
  for (std::size_t i = 0; i < nodes.size(); ++i) {
    if (!nodes[i].is_object() || !nodes[i].contains("children") || !nodes[i]["children"].is_array()) continue;
    for (const Json& child : nodes[i]["children"]) {
      if (!child.is_number_unsigned() || child.get<std::size_t>() >= nodes.size()) return true;
      children[i].push_back(child.get<std::size_t>());
      if (++num_parents[children[i].back()] > 1) return true;
    }
  }
  std::vector<std::size_t> level;
  for (std::size_t i = 0; i < nodes.size(); ++i) {
    if (num_parents[i] == 0) level.push_back(i);
  }
  std::size_t num_visited = level.size();
  for (std::size_t depth = 0; !level.empty(); ++depth) {
    if (depth > kMaxNodeDepth) return true;
    std::vector<std::size_t> next;
    for (const std::size_t node : level) next.insert(next.end(), children[node].begin(), children[node].end());
    num_visited += next.size();
    level = std::move(next);
  }
  return num_visited != nodes.size();
}

struct GltfText {
  std::string problem;
  Json json;
};

GltfText readJson(const std::filesystem::path& file, bool is_binary) {
  const std::string bytes = readStart(file, static_cast<std::size_t>(kMaxMeshFileBytes));
  std::string_view text = bytes;
  if (is_binary) {
    constexpr std::size_t kHeader = 20;  // magic, version, length; length and type of the first chunk
    if (bytes.size() < kHeader || text.substr(0, 4) != "glTF") return {"it is not binary glTF", {}};
    const std::uint32_t chunk = readLittleEndian32(text.substr(12));
    if (chunk > bytes.size() - kHeader) return {"its first chunk is longer than the file", {}};
    text = text.substr(kHeader, chunk);
  }
  if (nestsTooDeep(text)) return {"its JSON nests deeper than " + std::to_string(kMaxJsonDepth) + " levels", {}};
  Json json = Json::parse(text.begin(), text.end(), nullptr, false);
  if (!json.is_object()) return {"it is not glTF: no JSON object", {}};
  return {{}, std::move(json)};
}

// json[list][from[key]]
const Json& entry(const Json& json, const char* list, const Json& from, const char* key) {
  return json.at(list).at(from.at(key).get<std::size_t>());
}

std::optional<std::uint64_t> countTriangles(const Json& json) {
  const Json& scene = json.at("scenes").at(json.value("scene", std::size_t{0}));
  std::vector<std::size_t> pending = scene.at("nodes").get<std::vector<std::size_t>>();
  std::vector<bool> is_used(json.at("meshes").size(), false);
  while (!pending.empty()) {
    const Json& node = json.at("nodes").at(pending.back());
    pending.pop_back();
    if (node.contains("mesh")) is_used.at(node["mesh"].get<std::size_t>()) = true;
    if (!node.contains("children")) continue;
    for (const Json& child : node["children"]) pending.push_back(child.get<std::size_t>());
  }
  std::uint64_t count = 0;
  for (std::size_t i = 0; i < is_used.size(); ++i) {
    if (!is_used[i]) continue;
    for (const Json& primitive : json["meshes"][i].at("primitives")) {
      constexpr int kTriangleList = 4;
      if (primitive.value("mode", kTriangleList) != kTriangleList) return {};
      const Json& accessor = primitive.contains("indices") ? entry(json, "accessors", primitive, "indices")
                                                           : entry(json, "accessors", primitive.at("attributes"), "POSITION");
      count += accessor.at("count").get<std::uint64_t>() / 3;
    }
  }
  return count;
}

// Whether item[key] is an index of json[list].
bool refersTo(const Json& json, const char* list, const Json& item, const char* key) {
  return item.contains(key) && item[key].is_number_unsigned() && json.contains(list) && json[list].is_array() &&
         item[key].get<std::uint64_t>() < json[list].size();
}

// Assimp reads from address zero where a buffer is missing.
std::string missingData(const Json& json) {
  for (const auto& [list, key, target] : {std::array{"accessors", "bufferView", "bufferViews"}, {"bufferViews", "buffer", "buffers"}}) {
    if (!json.contains(list) || !json[list].is_array()) continue;
    for (std::size_t i = 0; i < json[list].size(); ++i) {
      if (!refersTo(json, target, json[list][i], key))
        return "entry " + std::to_string(i) + " of its " + list + " names no " + key + " that it has";
    }
  }
  return {};
}

// The first buffer of a .glb that is not in it; empty if there is none.
std::string externalBuffer(const Json& buffers) {
  for (std::size_t i = 0; i < buffers.size(); ++i) {
    if (!buffers[i].contains("uri")) continue;
    const Json& uri = buffers[i]["uri"];
    if (uri.is_string() && uri.get_ref<const std::string&>().starts_with("data:")) continue;
    return "its buffer " + std::to_string(i) + " is in another file (" + oneLine(uri.dump()).substr(0, kMaxShown) +
           "), which its SHA-256 does not cover: save it with all buffers inside";
  }
  return {};
}

}  // namespace

std::string validateGltf(const std::filesystem::path& file, bool is_binary) {
  const GltfText text = readJson(file, is_binary);
  if (!text.problem.empty()) return text.problem;
  const Json& json = text.json;
  if (json.contains("nodes") && json["nodes"].is_array() && isNodeTreeInvalid(json["nodes"])) {
    return "its nodes are not a tree, or nest deeper than " + std::to_string(kMaxNodeDepth) + " levels";
  }
  for (const char* list : {"accessors", "buffers", "bufferViews"}) {
    if (!json.contains(list) || !json[list].is_array()) continue;
    for (const Json& item : json[list]) {
      if (!item.is_object()) return std::string("it has an entry that is not an object in ") + list;
      for (const char* key : {"count", "byteLength", "byteOffset", "byteStride"}) {
        if (!item.contains(key)) continue;
        if (!item[key].is_number_unsigned() || item[key].get<std::uint64_t>() > kMaxMeshFileBytes) {
          return std::string("a ") + key + " in its " + list + " is out of range: " + oneLine(item[key].dump()).substr(0, kMaxShown);
        }
      }
    }
  }
  if (const std::string problem = missingData(json); !problem.empty()) return problem;
  if (is_binary && json.contains("buffers") && json["buffers"].is_array()) return externalBuffer(json["buffers"]);
  return {};
}

std::optional<std::uint64_t> countGltfTriangles(const std::filesystem::path& file, bool is_binary) {
  try {
    return countTriangles(readJson(file, is_binary).json);
  } catch (const Json::exception&) {
    return {};
  } catch (const std::out_of_range&) {
    return {};
  }
}

}  // namespace taxelsim
