// Writers of small mesh files for tests of the loader.
#pragma once

#include "support/input_error.h"
#include "support/temporary_directory.h"
#include "support/test.h"
#include "taxelsim/object.h"

namespace taxelsim {

using support::inputError;

// A box of 0.5 x 0.25 x 2 with its lower corner at the origin; bits 0, 1, 2 of a vertex index select its x, y, z. The side lengths are
// exact in float32 and in few decimal digits.
inline Mesh brick() {
  Mesh mesh;
  for (int i = 0; i < 8; ++i) {
    mesh.vertices.push_back({(i & 1) ? 0.5f : 0.0f, (i & 2) ? 0.25f : 0.0f, (i & 4) ? 2.0f : 0.0f});
  }
  mesh.triangles = {{0, 2, 1}, {1, 2, 3}, {4, 5, 6}, {5, 7, 6}, {0, 1, 4}, {1, 5, 4},
                    {2, 6, 3}, {3, 6, 7}, {0, 4, 2}, {2, 4, 6}, {1, 3, 5}, {3, 7, 5}};
  return mesh;
}

// The triangles by position, each starting at its smallest corner, sorted. Equal for meshes that differ only in the order of
// vertices or triangles.
using Corner = std::array<float, 3>;
inline std::vector<std::array<Corner, 3>> canonical(const Mesh& mesh) {
  std::vector<std::array<Corner, 3>> triangles;
  for (const auto& t : mesh.triangles) {
    std::array<Corner, 3> corners{mesh.vertices.at(t[0]), mesh.vertices.at(t[1]), mesh.vertices.at(t[2])};
    std::rotate(corners.begin(), std::min_element(corners.begin(), corners.end()), corners.end());
    triangles.push_back(corners);
  }
  std::sort(triangles.begin(), triangles.end());
  return triangles;
}

template <typename T>
void append(std::string& bytes, T value) {
  char raw[sizeof(T)];
  std::memcpy(raw, &value, sizeof(T));
  bytes.append(raw, sizeof(T));
}

inline std::string vertexText(const Corner& v) {
  return std::to_string(v[0]) + " " + std::to_string(v[1]) + " " + std::to_string(v[2]) + "\n";
}

inline std::string objText(const Mesh& mesh) {
  std::string text = "# a brick\n";
  for (const Corner& v : mesh.vertices) text += "v " + vertexText(v);
  for (const auto& t : mesh.triangles) {
    text += "f " + std::to_string(t[0] + 1) + " " + std::to_string(t[1] + 1) + " " + std::to_string(t[2] + 1) + "\n";
  }
  return text;
}

inline std::string stlText(const Mesh& mesh) {
  std::string text = "solid brick\n";
  for (const auto& t : mesh.triangles) {
    text += "facet normal 0 0 0\nouter loop\n";
    for (const std::uint32_t index : t) text += "vertex " + vertexText(mesh.vertices[index]);
    text += "endloop\nendfacet\n";
  }
  return text + "endsolid brick\n";
}

inline std::string stlBytes(const Mesh& mesh) {
  std::string bytes(80, ' ');
  append(bytes, static_cast<std::uint32_t>(mesh.triangles.size()));
  for (const auto& t : mesh.triangles) {
    bytes.append(12, '\0');
    for (const std::uint32_t index : t) {
      for (const float c : mesh.vertices[index]) append(bytes, c);
    }
    bytes.append(2, '\0');
  }
  return bytes;
}

inline std::string plyHeader(const std::string& format, std::size_t num_vertices, std::size_t num_faces) {
  return "ply\nformat " + format + " 1.0\ncomment a brick\nelement vertex " + std::to_string(num_vertices) +
         "\nproperty float x\nproperty float y\nproperty float z\nelement face " + std::to_string(num_faces) +
         "\nproperty list uchar int vertex_indices\nend_header\n";
}

inline std::string plyText(const Mesh& mesh) {
  std::string text = plyHeader("ascii", mesh.vertices.size(), mesh.triangles.size());
  for (const Corner& v : mesh.vertices) text += vertexText(v);
  for (const auto& t : mesh.triangles) text += "3 " + std::to_string(t[0]) + " " + std::to_string(t[1]) + " " + std::to_string(t[2]) + "\n";
  return text;
}

inline std::string plyBytes(const Mesh& mesh) {
  std::string bytes = plyHeader("binary_little_endian", mesh.vertices.size(), mesh.triangles.size());
  for (const Corner& v : mesh.vertices) {
    for (const float c : v) append(bytes, c);
  }
  for (const auto& t : mesh.triangles) {
    bytes += '\3';
    for (const std::uint32_t index : t) append(bytes, index);
  }
  return bytes;
}

// Buffer of a glTF file: vertices, then 32-bit indices.
inline std::string gltfBuffer(const Mesh& mesh) {
  std::string bytes;
  for (const Corner& v : mesh.vertices) {
    for (const float c : v) append(bytes, c);
  }
  for (const auto& t : mesh.triangles) {
    for (const std::uint32_t index : t) append(bytes, index);
  }
  return bytes;
}

// JSON of a glTF file with one mesh. `uri`: file of the buffer, empty for the binary chunk of a .glb. `nodes`: JSON array; node 0 is the
// root. `num_indices` replaces the correct number of indices, if given.
inline std::string gltfJson(const Mesh& mesh, const std::string& uri, const std::string& nodes, const std::string& num_indices = {}) {
  const std::size_t num_vertices = mesh.vertices.size();
  const std::size_t vertex_bytes = 12 * num_vertices;
  const std::size_t index_bytes = 12 * mesh.triangles.size();
  return R"({"asset":{"version":"2.0"},"scene":0,"scenes":[{"nodes":[0]}],"nodes":)" + nodes +
         R"(,"meshes":[{"primitives":[{"attributes":{"POSITION":0},"indices":1}]}],"buffers":[{"byteLength":)" +
         std::to_string(vertex_bytes + index_bytes) + (uri.empty() ? "" : R"(,"uri":")" + uri + "\"") +
         R"(}],"bufferViews":[{"buffer":0,"byteOffset":0,"byteLength":)" + std::to_string(vertex_bytes) + R"(},{"buffer":0,"byteOffset":)" +
         std::to_string(vertex_bytes) + R"(,"byteLength":)" + std::to_string(index_bytes) +
         R"(}],"accessors":[{"bufferView":0,"componentType":5126,"count":)" + std::to_string(num_vertices) +
         R"(,"type":"VEC3","min":[0,0,0],"max":[0.5,0.25,2]},{"bufferView":1,"componentType":5125,"count":)" +
         (num_indices.empty() ? std::to_string(3 * mesh.triangles.size()) : num_indices) + R"(,"type":"SCALAR"}]})";
}

// `uri`: see gltfJson(). The binary chunk is there in any case.
inline std::string glbBytes(const Mesh& mesh, const std::string& nodes, const std::string& uri = {}) {
  std::string json = gltfJson(mesh, uri, nodes);
  json.resize((json.size() + 3) / 4 * 4, ' ');
  const std::string buffer = gltfBuffer(mesh);
  std::string bytes = "glTF";
  append(bytes, std::uint32_t{2});
  append(bytes, static_cast<std::uint32_t>(12 + 8 + json.size() + 8 + buffer.size()));
  append(bytes, static_cast<std::uint32_t>(json.size()));
  bytes += "JSON" + json;
  append(bytes, static_cast<std::uint32_t>(buffer.size()));
  bytes += std::string("BIN\0", 4) + buffer;
  return bytes;
}

}  // namespace taxelsim
