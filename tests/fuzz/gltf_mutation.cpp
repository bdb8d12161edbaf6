#include "fuzz/gltf_mutation.h"

#include <array>
#include <cstdint>
#include <nlohmann/json.hpp>
#include <utility>
#include <vector>

#include "geometry/binary_file.h"

namespace taxelsim::fuzz {
namespace {

using Json = nlohmann::json;

constexpr std::size_t kMaxJsonBytes = 20'000;  // of a result; larger ones are slow and find no more
constexpr std::size_t kMaxDepth = 80;          // of values; readers allow 64
constexpr std::size_t kHeader = 20;            // bytes: magic, version, length; length and type of the first chunk
constexpr const char* kTriangle =
    R"({"asset":{"version":"2.0"},"scenes":[{"nodes":[0]}],"nodes":[{"mesh":0}],"meshes":[{"primitives":[{"attributes":{"POSITION":0}}]}],)"
    R"("buffers":[{"byteLength":36}],"bufferViews":[{"buffer":0,"byteLength":36}],)"
    R"("accessors":[{"bufferView":0,"componentType":5126,"count":3,"type":"VEC3"}]})";

// Values that limits, types and references of glTF are near to.
constexpr std::array<std::uint64_t, 28> kNumbers{0,    1,     2,        3,        4,          5,          6,          7,         8,    12,
                                                 36,   96,    252,      255,      256,        5120,       5121,       5122,      5123, 5125,
                                                 5126, 65535, 1u << 30, 1u << 31, UINT32_MAX, 1ull << 32, 1ull << 63, UINT64_MAX};

struct Glb {
  Json json;
  std::string binary;
};

Glb parsed(std::string_view bytes) {
  Glb glb{.json = Json::parse(kTriangle), .binary = std::string(36, '\x3f')};
  if (bytes.size() < kHeader || !bytes.starts_with("glTF")) return glb;
  const std::size_t size = readLittleEndian32(bytes.substr(12));
  if (size > bytes.size() - kHeader) return glb;
  Json json = Json::parse(bytes.substr(kHeader, size), nullptr, false);
  if (!json.is_object()) return glb;
  constexpr std::size_t kChunkHeader = 8;
  glb.binary = bytes.substr(std::min(kHeader + size + kChunkHeader, bytes.size()));
  glb.json = std::move(json);
  return glb;
}

void append(std::string& bytes, std::size_t number) {
  for (int shift = 0; shift < 32; shift += 8) bytes += static_cast<char>(number >> shift);
}

std::string written(std::string json, std::string binary) {
  json.resize((json.size() + 3) / 4 * 4, ' ');
  binary.resize((binary.size() + 3) / 4 * 4, '\0');
  std::string bytes = "glTF";
  append(bytes, 2);
  append(bytes, kHeader + json.size() + 8 + binary.size());
  append(bytes, json.size());
  bytes.append("JSON").append(json);
  append(bytes, binary.size());
  return bytes.append("BIN\0", 4).append(binary);
}

class Mutator {
 public:
  Mutator(Glb glb, std::mt19937& random) : glb_(std::move(glb)), random_(random) {}

  std::string run() {
    for (std::size_t change = 1 + below(4); change > 0; --change) {
      if (below(8) == 0)
        changeBinary();
      else
        changeJson();
      if (!collect()) return {};
    }
    std::string text = glb_.json.dump(-1, ' ', false, Json::error_handler_t::replace);
    if (below(16) == 0) repeatKey(text);
    return text.size() > kMaxJsonBytes ? std::string() : written(std::move(text), std::move(glb_.binary));
  }

 private:
  std::size_t below(std::size_t end) { return random_() % end; }
  template <typename List>
  auto& oneOf(List& list) {
    return list[below(std::size(list))];
  }

  // All values below the outermost. Returns false if they nest too deep.
  bool collect() {
    values_.clear();
    std::vector<std::pair<Json*, std::size_t>> pending{{&glb_.json, 0}};
    while (!pending.empty()) {
      const auto [value, depth] = pending.back();
      pending.pop_back();
      if (depth > kMaxDepth) return false;
      if (depth > 0) values_.push_back(value);
      for (Json& child : *value) {
        if (value->is_structured()) pending.emplace_back(&child, depth + 1);
      }
    }
    return true;
  }

  void changeBinary() {
    std::string& bytes = glb_.binary;
    const std::size_t at = below(bytes.size() + 1);
    if (below(3) == 0)
      bytes.resize(at);
    else if (at < bytes.size())
      bytes[at] = static_cast<char>(random_());
  }

  void changeJson() {
    collect();
    if (values_.empty()) {
      glb_.json = Json::parse(kTriangle);
      return;
    }
    Json& value = *oneOf(values_);
    switch (below(5)) {
      case 0:
        value = Json(*oneOf(values_));
        break;
      case 1:
        resize(value);
        break;
      case 2:
        if (value.is_object())
          addKey(value);
        else
          value = otherValue();
        break;
      default:
        value = value.is_number_unsigned() ? nearby(value.get<std::uint64_t>()) : otherValue();
    }
  }

  Json nearby(std::uint64_t number) { return below(2) == 0 ? Json(oneOf(kNumbers)) : Json(number + below(9) - 4); }

  Json otherValue() {
    static const std::array kOthers{Json(nullptr),
                                    Json(-1),
                                    Json(0.5),
                                    Json(1e30),
                                    Json(true),
                                    Json("SCALAR"),
                                    Json("VEC2"),
                                    Json("VEC3"),
                                    Json("MAT4"),
                                    Json("data:application/octet-stream;base64,AAAAAAAAgD8AAIA/AAAAAAAAAAAAAIA/AACAPwAAAAAAAAAA"),
                                    Json("data:,x"),
                                    Json("mesh.glb"),
                                    Json("/dev/zero"),
                                    Json::array(),
                                    Json::object(),
                                    Json::array({0, 1}),
                                    Json::array({0, 0, 0, 1}),
                                    Json::array({1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1})};
    return below(2) == 0 ? Json(oneOf(kNumbers)) : oneOf(kOthers);
  }

  // Removes or repeats an entry.
  void resize(Json& value) {
    if (value.empty() || !value.is_structured()) return;
    const auto at = std::next(value.begin(), static_cast<std::ptrdiff_t>(below(value.size())));
    if (value.is_array() && below(2) == 0)
      value.push_back(Json(*at));
    else
      value.erase(at);
  }

  void addKey(Json& object) {
    static const std::array kKeys{"bufferView",    "buffer",    "byteOffset",  "byteLength", "byteStride", "count", "normalized",
                                  "componentType", "type",      "min",         "indices",    "mode",       "mesh",  "children",
                                  "matrix",        "rotation",  "translation", "scale",      "scene",      "uri",   "weights",
                                  "JOINTS_0",      "WEIGHTS_0", "POSITION",    "targets"};
    switch (below(4)) {
      case 0:
        object["sparse"] = {{"count", oneOf(kNumbers)},
                            {"indices", {{"bufferView", 0}, {"byteOffset", oneOf(kNumbers)}, {"componentType", 5123}}},
                            {"values", {{"bufferView", 0}, {"byteOffset", oneOf(kNumbers)}}}};
        break;
      case 1:
        glb_.json["extensionsRequired"] = {below(4) == 0 ? "KHR_draco_mesh_compression" : "KHR_mesh_quantization"};
        break;
      default:
        object[oneOf(kKeys)] = below(2) == 0 ? Json(*oneOf(values_)) : otherValue();
    }
  }

  // Puts a second value for a key of an object before the first one. A JSON library keeps only one of them.
  void repeatKey(std::string& text) {
    std::vector<std::size_t> keys;
    for (std::size_t i = 1; i + 1 < text.size(); ++i) {
      if (text[i] == '"' && (text[i - 1] == '{' || text[i - 1] == ',') && text.find("\":", i) < text.find_first_of(",[]{}", i))
        keys.push_back(i);
    }
    if (keys.empty()) return;
    const std::size_t begin = oneOf(keys), end = text.find("\":", begin) + 2;
    text.insert(begin, text.substr(begin, end - begin) + otherValue().dump() + ",");
  }

  Glb glb_;
  std::mt19937& random_;
  std::vector<Json*> values_;
};

}  // namespace

std::string mutatedGlb(std::string_view bytes, std::mt19937& random) {
  const std::string changed = Mutator(parsed(bytes), random).run();
  return changed.empty() ? std::string(bytes) : changed;
}

}  // namespace taxelsim::fuzz
