#include "scene/keys/block.h"

#include <algorithm>
#include <stdexcept>

#include "scene/canonical.h"

namespace taxelsim {
namespace {

template <typename... Functions>
struct Overloaded : Functions... {
  using Functions::operator()...;
};
template <typename... Functions>
Overloaded(Functions...) -> Overloaded<Functions...>;

}  // namespace

KeyForms formsOf(std::string_view key) {
  const std::size_t bracket = key.find_first_of("[(");
  if (bracket == std::string_view::npos) return {key, {}, {}};
  const std::string_view inside = key.substr(bracket + 1, key.size() - bracket - 2);
  if (key[bracket] == '[') return {key.substr(0, bracket), inside, {}};
  return {key.substr(0, bracket), {}, inside};
}

const Key* Block::find(std::string_view wanted) const {
  const auto in = [&](const KeyTable& table) -> const Key* {
    const auto found = std::find_if(table.begin(), table.end(), [&](const Key& key) { return key.name() == wanted; });
    return found == table.end() ? nullptr : &*found;
  };
  if (const Key* const key = in(keys)) return key;
  for (const Case& one : cases) {
    if (const Key* const key = in(one.keys)) return key;
  }
  return nullptr;
}

std::vector<std::string_view> Block::allKeys() const {
  std::vector<std::string_view> all;
  const auto add = [&](const KeyTable& table) {
    for (const Key& key : table) {
      if (std::find(all.begin(), all.end(), key.key) == all.end()) all.push_back(key.key);
    }
  };
  add(keys);
  for (const Case& one : cases) add(one.keys);
  return all;
}

Key keyOf(std::string_view key, const ConstSettingPointer& otherwise, const Allowed& allowed, Presence presence, std::string_view text) {
  const auto make = [&](ValueType type, std::string value) {
    if (presence == Presence::kRequired) value = kNeeded;
    if (presence == Presence::kUnlimited) value = "";
    return Key{key, std::move(type), std::move(value), std::string(text)};
  };
  return std::visit(Overloaded{
                        [&](const double* value) { return make(Number{allowed}, canonicalNumber(*value)); },
                        [&](const int* value) {
                          return make(Number{allowed, true}, std::to_string(*value));
                        },
                        [&](const std::uint64_t* value) {
                          return make(Number{allowed, true}, std::to_string(*value));
                        },
                        [&](const std::optional<double>* value) { return make(Number{allowed}, *value ? canonicalNumber(**value) : ""); },
                        [&]<std::size_t N>(const std::array<double, N>* value) {
                          return make(Numbers{allowed, N}, canonicalList(*value));
                        },
                    },
                    otherwise);
}

const Block& noKeys() {
  static const Block block{.name = "", .keys = {}};
  return block;
}

KeyTable withDefault(KeyTable keys, std::string_view name, std::string otherwise) {
  const auto found = std::find_if(keys.begin(), keys.end(), [&](const Key& key) { return key.name() == name; });
  if (found == keys.end()) throw std::logic_error("no table has the key " + std::string(name));
  found->otherwise = std::move(otherwise);
  return keys;
}

std::string describe(const ValueType& type) {
  return std::visit(Overloaded{
                        [](const Number& number) { return number.is_whole ? describeWhole(number.allowed) : describe(number.allowed); },
                        [](const Numbers& numbers) {
                          const std::string count = numbers.count == kAnyNumber ? "" : std::to_string(numbers.count) + " ";
                          return (numbers.or_one ? "a number, or a list of " : "a list of ") + count + "numbers";
                        },
                        [](const Words& words) { return (words.is_list ? "a list of " : "") + listOf(words.words); },
                        [](const Text& text) { return text.what; },
                        [](const Nested& nested) { return nested.file.empty() ? "a mapping" : nested.file + ", or a mapping"; },
                        [](const NestedList& list) { return list.what; },
                        [](const NestedByName& map) { return map.what; },
                    },
                    type);
}

std::string listOf(std::span<const std::string_view> words) {
  std::string list;
  for (const std::string_view word : words) list += (list.empty() ? "" : " | ") + std::string(word);
  return list;
}

}  // namespace taxelsim
