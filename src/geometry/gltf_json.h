// The JSON of glTF files: parsing within limits, and checked access to values by path.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <nlohmann/json_fwd.hpp>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace taxelsim {

struct GltfProblem {
  std::string text;  // a sentence about the file
};

// Throws GltfProblem for text that is not a JSON object, nests deeper than 64 levels, has more than 2^23 values, or has a key twice in one
// object: readers of JSON disagree about which value counts.
nlohmann::json parseGltfJson(std::string_view text);

// The start of text from the file, for messages.
std::string shownGltfText(std::string_view text);

// An object in the JSON. Refers to the JSON. Members throw GltfProblem with the path of the value: "accessors[3].count: -1 is not allowed:
// a whole number from 1 to 8".
class GltfItem {
 public:
  // The outermost object.
  explicit GltfItem(const nlohmann::json& root) : value_(&root) {}

  const std::string& path() const { return path_; }
  bool has(const char* key) const;

  // Throw also where the key is missing and there is no fallback.
  std::uint64_t whole(const char* key, std::uint64_t max, std::optional<std::uint64_t> fallback = {}) const;
  std::string text(const char* key) const;
  bool flag(const char* key, bool fallback) const;

  // Throws unless the value is a list of `fallback.size()` numbers. The fallback if the key is missing.
  std::vector<float> numbers(const char* key, std::vector<float> fallback) const;

  // Values are indices of the list `list` with `size` entries. An empty list if the key of indices() is missing.
  std::size_t index(const char* key, const char* list, std::size_t size, std::optional<std::size_t> fallback = {}) const;
  std::vector<std::size_t> indices(const char* key, const char* list, std::size_t size) const;

  // Number of entries of a list; 0 if the key is missing.
  std::size_t size(const char* list) const;
  // The texts of a list; none if the key is missing.
  std::vector<std::string> texts(const char* list) const;
  // Entry `i`, below size(list).
  GltfItem entry(const char* list, std::size_t i) const;
  // The value of a key that must be there.
  GltfItem object(const char* key) const;
  std::vector<std::string> keys() const;

  [[noreturn]] void refuse(const char* key, const std::string& allowed) const;

 private:
  GltfItem(const nlohmann::json& value, std::string path);

  const nlohmann::json* find(const char* key) const;
  const nlohmann::json* findList(const char* key) const;
  std::string pathOf(const char* key) const;

  const nlohmann::json* value_;
  std::string path_;
};

}  // namespace taxelsim
