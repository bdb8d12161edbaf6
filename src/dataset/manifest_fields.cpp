#include "dataset/manifest_fields.h"

#include <algorithm>
#include <charconv>
#include <limits>
#include <sstream>
#include <system_error>

#include "base/text.h"
#include "taxelsim/error.h"

namespace taxelsim::dataset {
namespace {}  // namespace

Fields::Fields(const std::string& file, const YamlTree& map) : file_(file), map_(map) {
  if (map.kind != YamlTree::Kind::kMap) fail(map, "is not a mapping");
}

const YamlTree* Fields::find(std::string_view key) const {
  const auto found = std::find_if(map_.keys.begin(), map_.keys.end(), [&](const YamlTree::Key& k) { return k.text == key; });
  return found == map_.keys.end() ? nullptr : &map_.children[static_cast<std::size_t>(found - map_.keys.begin())];
}

const YamlTree& Fields::at(std::string_view key) const {
  const YamlTree* const value = find(key);
  if (value == nullptr) fail(map_, "key " + std::string(key) + " is missing");
  return *value;
}

std::string Fields::text(std::string_view key) const {
  return textOf(key, at(key));
}

std::uint64_t Fields::integer(std::string_view key, std::uint64_t max) const {
  return integerOf(key, at(key), max);
}

std::vector<std::uint64_t> Fields::integers(std::string_view key) const {
  std::vector<std::uint64_t> values;
  for (const YamlTree& item : list(key)) values.push_back(integerOf(key, item, std::numeric_limits<std::uint64_t>::max()));
  return values;
}

std::vector<double> Fields::numbers(std::string_view key, std::size_t count) const {
  const std::vector<YamlTree>& items = list(key);
  if (items.size() != count) refuse(key, at(key), "a list of " + std::to_string(count) + " numbers");
  std::vector<double> values(count);
  for (std::size_t i = 0; i < count; ++i)
    if (!parseNumber(textOf(key, items[i]), values[i])) refuse(key, items[i], "a number");
  return values;
}

std::vector<std::string> Fields::texts(std::string_view key) const {
  std::vector<std::string> values;
  for (const YamlTree& item : list(key)) values.push_back(textOf(key, item));
  return values;
}

const std::vector<YamlTree>& Fields::list(std::string_view key) const {
  const YamlTree& value = at(key);
  if (value.kind != YamlTree::Kind::kSequence) refuse(key, value, "a list");
  return value.children;
}

void Fields::fail(const YamlTree& where, const std::string& what) const {
  throw Error(ErrorKind::kInput, oneLine(file_ + ":" + std::to_string(where.line) + ": " + what));
}

void Fields::refuse(std::string_view key, const YamlTree& value, const std::string& allowed) const {
  const std::string found = value.kind == YamlTree::Kind::kScalar     ? value.text.substr(0, kMaxShown)
                            : value.kind == YamlTree::Kind::kSequence ? "a list"
                            : value.kind == YamlTree::Kind::kMap      ? "a mapping"
                                                                      : "nothing";
  fail(value, std::string(key) + ": " + found + " is not allowed: " + allowed);
}

std::uint64_t Fields::integerOf(std::string_view key, const YamlTree& value, std::uint64_t max) const {
  const char* const end = value.text.data() + value.text.size();
  std::uint64_t number = 0;
  const std::from_chars_result result = std::from_chars(value.text.data(), end, number);
  if (value.kind != YamlTree::Kind::kScalar || value.quoted || result.ec != std::errc() || result.ptr != end || number > max)
    refuse(key, value, "a whole number from 0 to " + std::to_string(max));
  return number;
}

const std::string& Fields::textOf(std::string_view key, const YamlTree& value) const {
  if (value.kind != YamlTree::Kind::kScalar) refuse(key, value, "a text");
  return value.text;
}

std::string quoted(const std::string& text) {
  static constexpr char kDigits[] = "0123456789abcdef";
  std::string result = "\"";
  for (const char c : text) {
    const auto code = static_cast<unsigned char>(c);
    if (c == '"' || c == '\\') {
      result += '\\';
      result += c;
    } else if (c == '\n') {
      result += "\\n";
    } else if (code < 0x20 || code == 0x7f) {
      result += {'\\', 'x', kDigits[code >> 4], kDigits[code & 15]};
    } else {
      result += c;
    }
  }
  return result + '"';
}

std::string quotedList(const std::vector<std::string>& texts) {
  std::string list = "[";
  for (const std::string& text : texts) list += (list.size() > 1 ? ", " : "") + quoted(text);
  return list + "]";
}

std::string block(const std::string& text) {
  const bool fits_block = text.size() > 1 && text.front() != ' ' && text.front() != '\n' && text.back() == '\n' &&
                          text[text.size() - 2] != '\n' &&
                          std::none_of(text.begin(), text.end(), [](unsigned char c) { return (c < 0x20 && c != '\n') || c == 0x7f; });
  if (!fits_block) return quoted(text) + "\n";
  std::string result = "|\n";
  std::istringstream lines(text);
  for (std::string line; std::getline(lines, line);) result += line.empty() ? "\n" : "  " + line + "\n";
  return result;
}

}  // namespace taxelsim::dataset
