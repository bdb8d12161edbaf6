#include "scene/yaml_reader.h"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <numbers>

#include "base/log.h"
#include "base/text.h"
#include "taxelsim/error.h"

namespace taxelsim {
namespace {

constexpr double kLargest = 1e30;
constexpr double kSmallest = 1e-30;
constexpr std::size_t kMaxText = 200;  // bytes of a name or file name

std::string shown(const YamlTree& tree) {
  switch (tree.kind) {
    case YamlTree::Kind::kNull:
      return "nothing";
    case YamlTree::Kind::kSequence:
      return "a list of " + std::to_string(tree.children.size());
    case YamlTree::Kind::kMap:
      return "a mapping";
    case YamlTree::Kind::kScalar:
      break;
  }
  std::string text = tree.text;
  if (text.size() > kMaxShown) {
    std::size_t end = kMaxShown;
    while (end > 0 && (static_cast<unsigned char>(text[end]) & 0xC0u) == 0x80u) --end;  // not within a character
    text = text.substr(0, end) + "...";
  }
  if (tree.quoted) return std::string("\"").append(text).append("\"");
  return text.empty() ? "an empty text" : text;
}

// The allowed numbers in the unit of a file.
std::string describe(const Allowed& allowed, FileUnit unit) {
  std::string name;
  return describe(inUnit(allowed, unit, name));
}

// A thousandth of the decimal number `text` (which is `value`), rounded once: value / 1000 is rounded twice, and 3.4 mm must be the same
// bits as 0.0034 m.
double thousandth(std::string_view text, double value) {
  const std::size_t e = text.find_first_of("eE");
  int exponent = 0;
  if (e != std::string_view::npos) {
    std::string_view digits = text.substr(e + 1);
    if (digits.starts_with('+')) digits.remove_prefix(1);
    if (std::from_chars(digits.data(), digits.data() + digits.size(), exponent).ec != std::errc{}) return value / 1000;
  }
  const std::string shifted = std::string(text.substr(0, e)).append("e").append(std::to_string(static_cast<long long>(exponent) - 3));
  double result = 0;
  std::from_chars(shifted.data(), shifted.data() + shifted.size(), result);
  return result;
}

}  // namespace

std::string YamlNode::below(const std::string& path, std::string_view key) {
  std::string result = path;
  if (!path.empty()) result += '.';
  return result.append(key);
}

std::string YamlNode::withPlace(const std::string& message) const {
  const std::string position = *file_ + ":" + std::to_string(line_) + ":" + std::to_string(column_) + ": ";
  return oneLine(position + (path_.empty() ? "" : path_ + ": ") + message);
}

void YamlNode::fail(const std::string& message) const {
  throw Error(ErrorKind::kInput, withPlace(message));
}

void YamlNode::warn(const std::string& message) const {
  logWarning(withPlace(message));
}

void YamlNode::note(const std::string& message) const {
  logInfo(withPlace(message));
}

void YamlNode::refuse(const std::string& allowed) const {
  fail(shown(*tree_) + " is not allowed: " + allowed);
}

void YamlNode::failAt(std::string_view field, const std::string& reason) const {
  YamlNode place = *this;
  std::string_view rest = field;
  while (!rest.empty()) {
    const bool is_index = rest.front() == '[';
    const std::size_t end = is_index ? rest.find(']') : std::min(rest.find_first_of(".["), rest.size());
    const std::string name(rest.substr(is_index ? 1 : 0, end - (is_index ? 1 : 0)));
    std::optional<YamlNode> next;
    if (is_index && place.isList()) {
      const std::vector<YamlNode> list = place.items("");
      const std::size_t index = std::stoul(name);
      if (index < list.size()) next = list[index];
    } else if (!is_index) {
      for (const char* const suffix : {"", "_mm", "_deg"}) {
        if (!next) next = place.child(name + suffix);
      }
    }
    if (!next) break;
    place = *next;
    rest.remove_prefix(is_index ? end + 1 : end);
    if (rest.starts_with('.')) rest.remove_prefix(1);
  }
  place.fail(rest.empty() ? reason : std::string(rest) + ": " + reason);
}

std::optional<YamlNode> YamlNode::child(std::string_view key) const {
  for (std::size_t i = 0; i < tree_->keys.size(); ++i) {
    if (tree_->keys[i].text != key) continue;
    YamlNode value(tree_->children[i], *file_);
    value.path_ = below(path_, key);
    return value;
  }
  return {};
}

std::vector<YamlNode> YamlNode::items(const std::string& what) const {
  if (!isList()) refuse(what);
  std::vector<YamlNode> result;
  for (std::size_t i = 0; i < tree_->children.size(); ++i) {
    YamlNode& item = result.emplace_back(tree_->children[i], *file_);
    item.path_.append(path_).append("[").append(std::to_string(i)).append("]");
    item.unit_ = unit_;
  }
  return result;
}

double YamlNode::number(const Allowed& allowed) const {
  std::string_view text = tree_->text;
  if (text.starts_with('+') && text.size() > 1 && text[1] != '-') text.remove_prefix(1);
  double value = 0;
  const auto [end, code] = std::from_chars(text.data(), text.data() + text.size(), value);
  const bool is_number = isScalar() && !tree_->quoted && code != std::errc::invalid_argument && end == text.data() + text.size();
  if (!is_number || !std::isfinite(value)) refuse(describe(allowed, unit_));
  const double magnitude = std::abs(value);
  if (code == std::errc::result_out_of_range || magnitude > kLargest || (magnitude < kSmallest && magnitude > 0)) {
    refuse(describe(allowed, unit_) + ", its size 0 or 1e-30 to 1e30");
  }
  const double min = inUnit(allowed.min, unit_);
  const double max = inUnit(allowed.max, unit_);
  if (value < min || value > max || (allowed.above_min && value == min) || (allowed.below_max && value == max)) {
    refuse(describe(allowed, unit_));
  }
  if (unit_ == FileUnit::kMilli) value = thousandth(text, value);
  if (unit_ == FileUnit::kDegree) value = value * std::numbers::pi / 180;
  return std::clamp(value, allowed.min, allowed.max) + 0.0;  // + 0.0 turns -0 into 0
}

std::vector<double> YamlNode::numbers(const Allowed& allowed, std::size_t count) const {
  const std::string what = "a list of " + std::to_string(count) + " numbers";
  const std::vector<YamlNode> list = items(what);
  if (list.size() != count) refuse(what);
  std::vector<double> result;
  for (const YamlNode& item : list) result.push_back(item.number(allowed));
  return result;
}

std::uint64_t YamlNode::integer(std::uint64_t min, std::uint64_t max) const {
  const std::string& text = tree_->text;
  std::uint64_t value = 0;
  const auto [end, code] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (!isScalar() || tree_->quoted || code != std::errc{} || end != text.data() + text.size() || value < min || value > max) {
    refuse("a whole number from " + std::to_string(min) + " to " + std::to_string(max));
  }
  return value;
}

std::string YamlNode::text(const std::string& what) const {
  if (!isScalar() || tree_->text.empty()) refuse(what);
  if (tree_->text.size() > kMaxText) refuse(what + " of at most " + std::to_string(kMaxText) + " bytes");
  if (oneLine(tree_->text) != tree_->text) refuse(what + " on one line");
  return tree_->text;
}

std::string YamlNode::choice(std::span<const std::string_view> words) const {
  if (!isScalar() || std::find(words.begin(), words.end(), tree_->text) == words.end()) refuse(listOf(words));
  return tree_->text;
}

}  // namespace taxelsim
