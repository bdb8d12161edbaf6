// Parses a YAML file into a tree of nodes with positions. Reads the part of YAML that scenes, sensor files and manifests need and refuses
// the rest (anchors, aliases, tags, several documents), so that no input makes it large, deep or slow. Keys are checked by
// scene/yaml_reader.h and dataset/manifest_fields.h.
#pragma once

#include <cstddef>
#include <filesystem>
#include <string>
#include <vector>

namespace taxelsim {

inline constexpr std::uintmax_t kMaxYamlBytes = std::uintmax_t{16} << 20;
inline constexpr std::size_t kMaxYamlDepth = 64;
inline constexpr std::size_t kMaxYamlNodes = 1'000'000;

// Lines and columns count from 1; a column is a byte.
struct YamlTree {
  enum class Kind { kNull, kScalar, kSequence, kMap };
  struct Key {
    std::string text;
    int line = 1;
    int column = 1;
  };

  Kind kind = Kind::kNull;
  std::string text;     // of a scalar
  bool quoted = false;  // a scalar in quotes or a block is never a number
  int line = 1;
  int column = 1;
  std::vector<Key> keys;           // of a map: one per child, all different
  std::vector<YamlTree> children;  // of a sequence or a map
};

// The whole file. Throws Error(kInput) when it is missing, not a regular file, or larger than kMaxYamlBytes.
std::string readYamlFile(const std::filesystem::path& file);

// `file`: begin of messages. Throws Error(kInput), "file:line:column: what", for anything that is not one document of
// plain YAML in UTF-8 with different keys, at most kMaxYamlDepth deep and of at most `max_nodes` values.
YamlTree parseYaml(std::string text, const std::string& file, std::size_t max_nodes = kMaxYamlNodes);

}  // namespace taxelsim
