// Keys of dataset.yaml: typed reading, and text that survives YAML.
#pragma once

#include <yaml-cpp/yaml.h>

#include <filesystem>
#include <string>
#include <vector>

#include "taxelsim/error.h"

namespace taxelsim::dataset {

// Typed access to the keys of a YAML mapping. Errors name file and line.
class Fields {
 public:
  // `file` must outlive this. Throws Error(kInput) if the node is not a mapping.
  Fields(const std::filesystem::path& file, const YAML::Node& node) : file_(file), node_(node) {
    if (!node.IsMap()) fail(node, "is not a mapping");
  }

  bool has(const char* key) const { return static_cast<bool>(node_[key]); }

  template <typename T>
  T get(const char* key) const {
    const YAML::Node value = at(key);
    try {
      return value.as<T>();
    } catch (const YAML::Exception&) {
      fail(value, std::string("key ") + key + " has a value of the wrong type");
    }
  }

  template <typename T>
  T get(const char* key, const T& otherwise) const {
    return has(key) ? get<T>(key) : otherwise;
  }

  YAML::Node at(const char* key) const {
    const YAML::Node value = node_[key];
    if (!value) fail(node_, std::string("key ") + key + " is missing");
    return value;
  }

  [[noreturn]] void fail(const YAML::Node& where, const std::string& what) const {
    throw Error(ErrorKind::kInput, file_.string() + ":" + std::to_string(where.Mark().line + 1) + ": " + what);
  }

 private:
  const std::filesystem::path& file_;
  YAML::Node node_;
};

// A double-quoted YAML scalar.
std::string quoted(const std::string& text);

// A YAML list of double-quoted scalars.
std::string quotedList(const std::vector<std::string>& texts);

// A literal YAML block if that preserves every byte, since it is readable; a quoted scalar otherwise.
std::string block(const std::string& text);

}  // namespace taxelsim::dataset
