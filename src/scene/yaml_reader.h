// Strict reading of our YAML files. A YamlMap states once which keys a block may have; each getter checks one value, puts its default in
// place and writes it to the canonical text, so that no setting can be read and then forgotten there. Every message is one line:
//   scenes/x.yaml:12:5: randomisation.load: -1 is not allowed: a number >= 0 N
//
// A key written "pitch[_mm]" may be given as `pitch` in SI units or as `pitch_mm` in the thousandth of the metre, "yaw[_deg]" as `yaw` or
// `yaw_deg`; getters take the bare name and return SI units.
#pragma once

#include <algorithm>
#include <array>
#include <cstdint>
#include <initializer_list>
#include <limits>
#include <optional>
#include <stdexcept>
#include <string>
#include <string_view>
#include <vector>

#include "scene/canonical.h"
#include "scene/yaml_parse.h"

namespace taxelsim {

// Numbers a key takes, in SI units. Anything larger than 1e30, or nonzero and smaller than 1e-30, is refused beside: the device
// computes in float32.
struct Allowed {
  double min = -std::numeric_limits<double>::infinity();
  double max = std::numeric_limits<double>::infinity();
  bool above_min = false;  // min itself is not allowed
  std::string_view unit = "";

  static Allowed any(std::string_view unit) { return {.unit = unit}; }
  static Allowed atLeast(double min, std::string_view unit) { return {.min = min, .unit = unit}; }
  static Allowed above(double min, std::string_view unit) { return {.min = min, .above_min = true, .unit = unit}; }
  static Allowed within(double min, double max, std::string_view unit) { return {.min = min, .max = max, .unit = unit}; }
};

// One value of a file: where it stands, how it is reached, in which unit its numbers are. Refers to a tree and a name that must outlive it.
class YamlNode {
 public:
  enum class Unit { kSi, kMilli, kDegree };

  YamlNode(const YamlTree& tree, const std::string& file) : tree_(&tree), file_(&file), line_(tree.line), column_(tree.column) {}

  // Throws Error(kInput) with this node's position and path.
  [[noreturn]] void fail(const std::string& message) const;
  // The same, for a value that is not among the allowed ones.
  [[noreturn]] void refuse(const std::string& allowed) const;

  bool isScalar() const { return tree_->kind == YamlTree::Kind::kScalar; }
  bool isList() const { return tree_->kind == YamlTree::Kind::kSequence; }
  bool isMap() const { return tree_->kind == YamlTree::Kind::kMap; }

  std::optional<YamlNode> child(std::string_view key) const;   // of a mapping
  std::vector<YamlNode> items(const std::string& what) const;  // of a list; anything else is refused, "`what`" being allowed
  double number(const Allowed& allowed) const;                 // SI
  std::vector<double> numbers(const Allowed& allowed, std::size_t count) const;
  std::uint64_t integer(std::uint64_t min, std::uint64_t max) const;
  std::string text(const std::string& what) const;  // one line, 1 to 200 bytes
  std::string choice(std::initializer_list<std::string_view> words) const;

 private:
  friend class YamlMap;

  const YamlTree* tree_;
  const std::string* file_;
  std::string path_;
  int line_;
  int column_;
  Unit unit_ = Unit::kSi;
};

class YamlMap {
 public:
  using Keys = std::vector<std::string_view>;

  // The mapping `node` itself; throws for one that is no mapping or has a key that is not allowed.
  YamlMap(const YamlNode& node, Keys allowed, Canonical& canonical);
  // The block `key` of `parent`; one that is not there is empty. What it holds stands below `key` in the canonical text.
  YamlMap(const YamlMap& parent, std::string_view key, Keys allowed);
  // An item of the list that was opened in `canonical`.
  static YamlMap item(const YamlNode& node, Keys allowed, Canonical& canonical);
  ~YamlMap();
  YamlMap(const YamlMap&) = delete;
  YamlMap& operator=(const YamlMap&) = delete;

  const YamlNode& node() const { return node_; }
  Canonical& canonical() const { return *canonical_; }

  // The value of a key, if given, without writing it; `require` throws when it is missing, with what it should be.
  std::optional<YamlNode> find(std::string_view key) const;
  YamlNode require(std::string_view key, const std::string& what) const;
  bool has(std::string_view key) const { return find(key).has_value(); }

  // Checked values. Without a default the key must be there.
  double number(std::string_view key, const Allowed& allowed, std::optional<double> otherwise = {}) const;
  std::uint64_t integer(std::string_view key, std::uint64_t min, std::uint64_t max, std::optional<std::uint64_t> otherwise = {}) const;
  std::string text(std::string_view key, const std::string& what, std::optional<std::string> otherwise = {}) const;
  std::string choice(std::string_view key, std::initializer_list<std::string_view> words, std::string_view otherwise = {}) const;

  template <std::size_t N>
  std::array<double, N> numbers(std::string_view key, const Allowed& allowed, std::optional<std::array<double, N>> otherwise = {}) const {
    const std::optional<YamlNode> value = find(key);
    if (!value && !otherwise) fail(key, "a list of " + std::to_string(N) + " numbers");
    std::array<double, N> result{};
    if (value) {
      const std::vector<double> numbers = value->numbers(allowed, N);
      std::copy(numbers.begin(), numbers.end(), result.begin());
    } else {
      result = *otherwise;
    }
    canonical_->line(key, canonicalList(result));
    return result;
  }

 private:
  YamlMap(const YamlNode& node, Keys allowed, Canonical& canonical, bool closes);
  static YamlNode blockOf(const YamlMap& parent, std::string_view key);
  void checkKeys() const;
  [[noreturn]] void fail(std::string_view key, const std::string& what) const;  // missing

  YamlNode node_;
  std::vector<std::string_view> allowed_;
  Canonical* canonical_;
  bool closes_ = false;
};

// Runs `check` and throws what it throws as Error(kInput) at the position of `node`.
template <typename Function>
auto atNode(const YamlNode& node, Function&& check) {
  try {
    return check();
  } catch (const std::runtime_error& error) {
    node.fail(error.what());
  }
}

}  // namespace taxelsim
