// Keys of dataset.yaml: typed reading, and text that survives YAML.
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "base/yaml_parse.h"

namespace taxelsim::dataset {

// Typed access to the keys of a mapping. Errors name file, line and key. Refers to the name of the file and the tree, which must outlive
// it.
class Fields {
 public:
  // Throws Error(kInput) if the node is not a mapping.
  Fields(const std::string& file, const YamlTree& map);

  // The value of a key; null if there is none.
  const YamlTree* find(std::string_view key) const;
  // Throws Error(kInput) if there is none.
  const YamlTree& at(std::string_view key) const;

  std::string text(std::string_view key) const;
  // A decimal number that its type can hold.
  std::uint64_t integer(std::string_view key, std::uint64_t max) const;
  std::vector<std::uint64_t> integers(std::string_view key) const;
  std::vector<double> numbers(std::string_view key, std::size_t count) const;
  std::vector<std::string> texts(std::string_view key) const;
  // The items of a list.
  const std::vector<YamlTree>& list(std::string_view key) const;

  [[noreturn]] void fail(const YamlTree& where, const std::string& what) const;

 private:
  [[noreturn]] void refuse(std::string_view key, const YamlTree& value, const std::string& allowed) const;
  std::uint64_t integerOf(std::string_view key, const YamlTree& value, std::uint64_t max) const;
  const std::string& textOf(std::string_view key, const YamlTree& value) const;

  const std::string& file_;
  const YamlTree& map_;
};

// A double-quoted YAML scalar.
std::string quoted(const std::string& text);

// A YAML list of double-quoted scalars.
std::string quotedList(const std::vector<std::string>& texts);

// A literal YAML block if that preserves every byte, since it is readable; a quoted scalar otherwise.
std::string block(const std::string& text);

}  // namespace taxelsim::dataset
