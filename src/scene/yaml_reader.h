// Strict reading of YAML files. A YamlMap has the keys that a block may have, from a table of keys (scene/keys/block.h) or a list. Each
// getter checks one value, or takes its default, and writes it to the canonical text, so that no setting is missing there. Every message is
// one line:
//   scenes/x.yaml:12:5: randomization.load: -1 is not allowed: a number from 0 to 1e+06 N
// Numbers larger than 1e30, or nonzero and smaller than 1e-30, are refused: the device computes in float32.
//
// Keys: "pitch[_mm]" may be given as `pitch` in SI units or as `pitch_mm` in millimetres, "yaw[_deg]" as `yaw` or `yaw_deg`;
// "randomization(randomisation)" may also be given by its former spelling, with a warning. Getters take the bare name and return SI units.
#pragma once

#include <algorithm>
#include <array>
#include <cstdint>
#include <initializer_list>
#include <limits>
#include <optional>
#include <span>
#include <stdexcept>
#include <string>
#include <string_view>
#include <type_traits>
#include <vector>

#include "base/field.h"
#include "base/yaml_parse.h"
#include "scene/canonical.h"
#include "scene/file_unit.h"
#include "scene/keys/block.h"
#include "taxelsim/error.h"

namespace taxelsim {

// One value of a file: its position, its path of keys, the unit of its numbers. Refers to a tree and a name that must outlive it.
class YamlNode {
 public:
  YamlNode(const YamlTree& tree, const std::string& file) : tree_(&tree), file_(&file), line_(tree.line), column_(tree.column) {}

  // Throws Error(kInput) with this node's position and path.
  [[noreturn]] void fail(const std::string& message) const;
  // Log a warning, or a note of lower level, with this node's position and path.
  void warn(const std::string& message) const;
  void note(const std::string& message) const;
  // As fail(): "value is not allowed: allowed".
  [[noreturn]] void refuse(const std::string& allowed) const;
  // The same for an error of a field below this node ("readout.taxel_gain[3]"), at the position of that field, or of the nearest block
  // that the file has.
  [[noreturn]] void failAt(std::string_view field, const std::string& reason) const;

  const YamlTree& tree() const { return *tree_; }
  const std::string& file() const { return *file_; }
  bool isScalar() const { return tree_->kind == YamlTree::Kind::kScalar; }
  bool isList() const { return tree_->kind == YamlTree::Kind::kSequence; }
  bool isMap() const { return tree_->kind == YamlTree::Kind::kMap; }

  std::optional<YamlNode> child(std::string_view key) const;   // of a mapping
  std::vector<YamlNode> items(const std::string& what) const;  // of a list; refuses anything else, `what` being allowed
  double number(const Allowed& allowed) const;                 // SI
  std::vector<double> numbers(const Allowed& allowed, std::size_t count) const;
  std::uint64_t integer(std::uint64_t min, std::uint64_t max) const;
  std::string text(const std::string& what) const;  // one line, 1 to 200 bytes
  std::string choice(std::span<const std::string_view> words) const;

 private:
  friend class YamlMap;

  static std::string below(const std::string& path, std::string_view key);  // "randomization", "load": "randomization.load"
  std::string withPlace(const std::string& message) const;

  const YamlTree* tree_;
  const std::string* file_;
  std::string path_;
  int line_;
  int column_;
  FileUnit unit_ = FileUnit::kSi;
};

class YamlMap {
 public:
  using Keys = std::vector<std::string_view>;

  // The mapping `node` itself; throws if it is not a mapping or has a key that is not allowed.
  YamlMap(const YamlNode& node, Keys allowed, Canonical& canonical);
  // `without`: a key of the block that this file must not have.
  YamlMap(const YamlNode& node, const Block& block, Canonical& canonical, std::string_view without = "");
  // The block `key` of `parent`, empty if missing. Its values are below `key` in the canonical text.
  YamlMap(const YamlMap& parent, std::string_view key, Keys allowed);
  YamlMap(const YamlMap& parent, std::string_view key, const Block& block);
  // The same of a mapping that the block of `parent` has.
  YamlMap(const YamlMap& parent, std::string_view key);
  // The same mapping as `map`, with another canonical text.
  YamlMap(const YamlMap& map, Canonical& canonical);
  // An item of the list that was opened in `canonical`.
  static YamlMap item(const YamlNode& node, Keys allowed, Canonical& canonical);
  static YamlMap item(const YamlNode& node, const Block& block, Canonical& canonical);
  ~YamlMap();
  YamlMap(const YamlMap&) = delete;
  YamlMap& operator=(const YamlMap&) = delete;

  const YamlNode& node() const { return node_; }
  Canonical& canonical() const { return *canonical_; }

  // The value of a key, without writing it. `require` throws if it is missing: "key is missing: what".
  std::optional<YamlNode> find(std::string_view key) const;
  YamlNode require(std::string_view key, const std::string& what) const;
  YamlNode require(std::string_view key) const;    // what: whatOf(key)
  std::string whatOf(std::string_view key) const;  // what the value of a key of the block may be
  bool has(std::string_view key) const { return find(key).has_value(); }
  // Throws at `key` if the mapping has both keys: "conflicts with `other`: remedy".
  void rejectBoth(std::string_view key, std::string_view other, std::string_view remedy = "give only one of them") const;

  // Checked values. Without a default the key must be there.
  double number(std::string_view key, const Allowed& allowed, std::optional<double> otherwise = {}) const;
  std::uint64_t integer(std::string_view key, std::uint64_t min, std::uint64_t max, std::optional<std::uint64_t> otherwise = {}) const;
  std::string text(std::string_view key, const std::string& what, std::optional<std::string> otherwise = {}) const;
  std::string choice(std::string_view key, std::initializer_list<std::string_view> words, std::string_view otherwise = {}) const;

  // The same of a key of the block, which says what is allowed and the default.
  double number(std::string_view key) const;
  std::string text(std::string_view key) const;
  template <std::size_t N>
  std::array<double, N> numbers(std::string_view key) const {
    return numbers<N>(key, allowedOf(key));
  }
  std::size_t wordOf(std::string_view key) const;        // place among the words
  const Allowed& allowedOf(std::string_view key) const;  // range of a number, or of each number in a list
  template <typename Enum>
  Enum choice(std::string_view key) const {
    return static_cast<Enum>(wordOf(key));
  }
  std::vector<YamlNode> items(std::string_view key) const;  // the list must be there and have one or more
  const Block& itemBlock(std::string_view key) const;       // block that each mapping in the list has
  // The one of block.one_of that the mapping has. Throws if it has none or several of them.
  std::string_view onlyOne() const;

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
  YamlMap(const YamlNode& node, Keys allowed, const Block* block, Canonical& canonical, bool closes);
  const Key& keyOf(std::string_view key) const;  // of the block
  static YamlNode blockOf(const YamlMap& parent, std::string_view key);
  void checkKeys() const;
  [[noreturn]] void fail(std::string_view key, const std::string& what) const;  // missing

  YamlNode node_;
  std::vector<std::string_view> allowed_;
  const Block* block_ = nullptr;
  Canonical* canonical_;
  bool closes_ = false;
};

// Reads the value of a key into `setting`, whose value is the default unless the key is required. An optional setting without a value and a
// setting without a limit stay as they are if the key is missing.
void readSetting(const YamlMap& map, std::string_view key, const SettingPointer& setting, const Allowed& allowed, Presence presence);

// Reads the fields of a table into `settings`.
template <typename Settings>
void readFields(const YamlMap& map, std::span<const Field<std::type_identity_t<Settings>>> table, Settings& settings) {
  for (const Field<Settings>& field : table) readSetting(map, field.name(), field.in(settings), field.allowed, field.presence);
}

// Runs `check` and rethrows its exception as Error(kInput) at the position of `node`, or of the field of an Error that has one.
template <typename Function>
auto atNode(const YamlNode& node, Function&& check) {
  try {
    return check();
  } catch (const Error& error) {
    if (!error.field().empty()) node.failAt(error.field(), error.reason());
    node.fail(error.what());
  } catch (const std::runtime_error& error) {
    node.fail(error.what());
  }
}

}  // namespace taxelsim
