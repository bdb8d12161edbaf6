// Buffers and accessors of glTF files. No access reads outside of the bytes that the file and its buffers have.
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "geometry/gltf_json.h"
#include "geometry/number_type.h"

namespace taxelsim {

// Buffers, loaded when they are first used. Refers to the outermost object and to the binary chunk.
class GltfBuffers {
 public:
  // `binary_chunk`: of a .glb, which can name no other file; none for a .gltf.
  GltfBuffers(const GltfItem& root, std::filesystem::path file, std::optional<std::string_view> binary_chunk);

  // The bytes of a buffer; valid as long as this object. Throws GltfProblem if it has fewer than its byteLength, or is in a file that may
  // not be read.
  std::string_view bytes(std::size_t buffer);

 private:
  std::string load(const GltfItem& buffer, const std::string& uri, std::size_t size);
  std::string loadFile(const GltfItem& buffer, const std::string& uri, std::size_t size);

  const GltfItem& root_;
  std::filesystem::path file_;
  std::optional<std::string_view> binary_chunk_;
  std::vector<std::optional<std::string>> loaded_;
  std::uintmax_t num_file_bytes_ = 0;  // read from other files
};

// Numbers of a bufferView: `count` elements of the same length.
class GltfAccessor {
 public:
  // Throws GltfProblem unless all elements are inside of the buffer, and for a sparse accessor.
  GltfAccessor(const GltfItem& root, std::size_t accessor, GltfBuffers& buffers);

  std::size_t count() const { return count_; }
  NumberType number() const { return number_; }
  bool isNormalized() const { return is_normalized_; }
  const std::string& type() const { return type_; }
  const GltfItem& item() const { return item_; }

  // Number `component` of an element, in [-1, 1] if the accessor is normalized. Both are in range.
  double value(std::size_t element, std::size_t component) const;

 private:
  GltfItem item_;
  std::size_t count_;
  NumberType number_;
  std::string type_;  // "SCALAR", "VEC3", ...
  bool is_normalized_;
  std::size_t stride_ = 0;  // bytes
  std::string_view bytes_;  // from the first element on
};

}  // namespace taxelsim
