// Tables of the keys of files: one Block per mapping states each key once, with the type of its value, its default and its meaning. The
// readers take keys, words and texts from it (scene/yaml_reader.h); `taxelsim schema` prints it. Numbers come from tables of fields.
#pragma once

#include <span>
#include <string>
#include <string_view>
#include <type_traits>
#include <utility>
#include <variant>
#include <vector>

#include "base/field.h"

namespace taxelsim {

struct Block;
using BlockOf = const Block& (*)();
inline constexpr int kAnyNumber = 0;  // a list may have any number of items

// Types of values.
struct Number {
  Allowed allowed;
  bool is_whole = false;
};
struct Numbers {  // a list
  Allowed allowed;
  int count;             // or kAnyNumber
  bool or_one = false;   // or one number
  bool in_rows = false;  // or a list of lists
};
struct Words {
  std::span<const std::string_view> words;
  bool is_list = false;  // a list of different words
};
struct Text {
  std::string what;
  bool is_list = false;
};
struct Nested {  // a mapping
  BlockOf block;
  std::string file = "";  // what a text names instead: "a sensor file"
};
struct NestedList {
  std::string what;
  BlockOf block;
};
struct NestedByName {  // a mapping from names of any choice
  std::string what;
  BlockOf block;
};
using ValueType = std::variant<Number, Numbers, Words, Text, Nested, NestedList, NestedByName>;

inline constexpr const char* kNeeded = "required";

// "pitch[_mm]" -> {"pitch", "_mm", ""}, "randomization(randomisation)" -> {"randomization", "", "randomisation"}
struct KeyForms {
  std::string_view name;
  std::string_view suffix;
  std::string_view former;
};
KeyForms formsOf(std::string_view key);

struct Key {
  std::string_view key;  // "pitch[_mm]": may be given as pitch or pitch_mm; "randomization(randomisation)": with its former spelling
  ValueType type;
  std::string otherwise;  // the default as in a file, or in words; kNeeded, or "" for none
  std::string text;       // meaning

  std::string_view name() const { return formsOf(key).name; }
};
using KeyTable = std::vector<Key>;

// The keys of one mapping.
struct Block {
  // Keys that a file may have if the key `selector` of the block has `word`.
  struct Case {
    std::string_view word;
    KeyTable keys;
  };

  std::string_view name;  // heading of its table in the documents; "" if its keys are rows of the outer table
  KeyTable keys;
  std::vector<std::string_view> one_of = {};  // exactly one of these keys is given
  std::string_view selector = "";
  std::vector<Case> cases = {};

  // Null if there is none. Keys of cases count.
  const Key* find(std::string_view wanted) const;
  // Every key once.
  std::vector<std::string_view> allKeys() const;
};

// The key of a field. `otherwise`: the value of the setting.
Key keyOf(std::string_view key, const ConstSettingPointer& otherwise, const Allowed& allowed, Presence presence, std::string_view text);

template <typename Settings>
KeyTable keysOfFields(std::span<const Field<Settings>> table) {
  const Settings defaults{};
  KeyTable keys;
  for (const Field<Settings>& field : table) {
    keys.push_back(keyOf(field.key, field.in(defaults), field.allowed, field.presence, field.text));
  }
  return keys;
}
template <typename Settings, std::size_t N>
KeyTable keysOfFields(const std::array<Field<Settings>, N>& table) {
  return keysOfFields(std::span<const Field<Settings>>(table));
}

// A mapping without keys: {}.
const Block& noKeys();

// The block of a table of fields.
template <const auto& kTable>
const Block& fieldBlock() {
  static const Block block{.name = "", .keys = keysOfFields(kTable)};
  return block;
}

// The table with another default of one key.
KeyTable withDefault(KeyTable keys, std::string_view name, std::string otherwise);

// The tables one after the other.
template <typename... Tables>
KeyTable joinKeys(const Tables&... tables) {
  KeyTable keys;
  (keys.insert(keys.end(), tables.begin(), tables.end()), ...);
  return keys;
}

// What a value may be, in words: "a number > 0 m".
std::string describe(const ValueType& type);

// "x | y | z"
std::string listOf(std::span<const std::string_view> words);

}  // namespace taxelsim
