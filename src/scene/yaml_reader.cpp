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
constexpr double kDegreesPerRadian = 180 / std::numbers::pi;

const YamlTree& emptyMap() {
  static const YamlTree tree = [] {
    YamlTree map;
    map.kind = YamlTree::Kind::kMap;
    return map;
  }();
  return tree;
}

// "randomization" and "load" -> "randomization.load"
std::string below(const std::string& path, std::string_view key) {
  std::string result = path;
  if (!path.empty()) result += '.';
  return result.append(key);
}

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

// A bound in the unit of the file. Rounding removes the last bits of pi / 180, so that 90 deg is 90.
double inUnit(double bound, YamlNode::Unit unit) {
  switch (unit) {
    case YamlNode::Unit::kMilli:
      return bound * 1000;
    case YamlNode::Unit::kDegree:
      return std::isfinite(bound) ? std::round(bound * kDegreesPerRadian * 1e9) / 1e9 : bound;
    case YamlNode::Unit::kSi:
      break;
  }
  return bound;
}

std::string unitName(std::string_view si, YamlNode::Unit unit) {
  std::string name;
  if (unit == YamlNode::Unit::kMilli) name.append("m").append(si);                                            // m, m/s
  if (unit == YamlNode::Unit::kDegree) name.append("deg").append(si.substr(std::string_view("rad").size()));  // rad, rad/s
  return name.empty() ? std::string(si) : name;
}

// The allowed numbers in the unit of a file.
std::string describe(Allowed allowed, YamlNode::Unit unit) {
  const std::string name = unitName(allowed.unit, unit);
  allowed.min = inUnit(allowed.min, unit);
  allowed.max = inUnit(allowed.max, unit);
  allowed.unit = name;
  return describe(allowed);
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

// "pitch[_mm]" -> {"pitch", "_mm", ""}, "randomization(randomisation)" -> {"randomization", "", "randomisation"}
struct KeyForms {
  std::string_view name;
  std::string_view suffix;
  std::string_view former;
};

KeyForms formsOf(std::string_view key) {
  const std::size_t bracket = key.find_first_of("[(");
  if (bracket == std::string_view::npos) return {key, {}, {}};
  const std::string_view inside = key.substr(bracket + 1, key.size() - bracket - 2);
  if (key[bracket] == '[') return {key.substr(0, bracket), inside, {}};
  return {key.substr(0, bracket), {}, inside};
}

}  // namespace

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
  if (unit_ == Unit::kMilli) value = thousandth(text, value);
  if (unit_ == Unit::kDegree) value = value * std::numbers::pi / 180;
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

std::string YamlNode::choice(std::initializer_list<std::string_view> words) const {
  std::string allowed;
  for (const std::string_view word : words) {
    if (isScalar() && tree_->text == word) return std::string(word);
    allowed += (allowed.empty() ? "" : " | ") + std::string(word);
  }
  refuse(allowed);
}

YamlMap::YamlMap(const YamlNode& node, Keys allowed, Canonical& canonical, bool closes)
    : node_(node), allowed_(std::move(allowed)), canonical_(&canonical), closes_(closes) {
  checkKeys();
}

YamlMap::YamlMap(const YamlNode& node, Keys allowed, Canonical& canonical) : YamlMap(node, std::move(allowed), canonical, false) {}

YamlMap::YamlMap(const YamlMap& parent, std::string_view key, Keys allowed)
    : YamlMap(blockOf(parent, key), std::move(allowed), parent.canonical(), true) {
  canonical_->open(key);
}

YamlMap::YamlMap(const YamlMap& map, Canonical& canonical) : node_(map.node_), allowed_(map.allowed_), canonical_(&canonical) {}

YamlMap YamlMap::item(const YamlNode& node, Keys allowed, Canonical& canonical) {
  canonical.openItem();
  return YamlMap(node, std::move(allowed), canonical, true);
}

YamlMap::~YamlMap() {
  if (closes_) canonical_->close();
}

YamlNode YamlMap::blockOf(const YamlMap& parent, std::string_view key) {
  if (std::optional<YamlNode> given = parent.find(key)) return *given;
  YamlNode block = parent.node_;
  block.tree_ = &emptyMap();
  block.path_ = below(block.path_, key);
  return block;
}

void YamlMap::checkKeys() const {
  std::string list;
  for (auto key = allowed_.begin(); key != allowed_.end(); ++key) {
    if (std::find(allowed_.begin(), key, *key) == key) list += (list.empty() ? "" : ", ") + std::string(key->substr(0, key->find('(')));
  }
  if (!node_.isMap()) node_.refuse("a mapping of " + (list.empty() ? "nothing: {}" : list));
  for (const YamlTree::Key& key : node_.tree_->keys) {
    bool known = false;
    std::string nearest;
    std::size_t nearest_distance = 1 + key.text.size() / 4;  // more distant words are no typing errors
    for (const std::string_view allowed : allowed_) {
      const auto [name, suffix, former] = formsOf(allowed);
      known = known || (!former.empty() && key.text == former);
      for (const std::string& form : {std::string(name), std::string(name) + std::string(suffix)}) {
        known = known || key.text == form;
        // Long keys are not compared: the table of distances would be as long.
        if (key.text.size() > 2 * kMaxShown) continue;
        const std::size_t distance = editDistance(key.text, form);
        if (distance <= nearest_distance && (nearest.empty() || distance < nearest_distance)) {
          nearest = form;
          nearest_distance = distance;
        }
      }
    }
    for (const std::string_view allowed : allowed_) {
      const auto [name, suffix, former] = formsOf(allowed);
      if (!former.empty() && key.text == former) {
        logWarning(oneLine(*node_.file_) + ":" + std::to_string(key.line) + ":" + std::to_string(key.column) + ": '" + key.text +
                   "' is the former spelling of '" + std::string(name) + "'");
      }
    }
    if (known) continue;
    YamlNode place = node_;
    place.line_ = key.line;
    place.column_ = key.column;
    place.path_ = below(place.path_, std::string_view(key.text).substr(0, kMaxShown));
    place.fail("unknown key" + (nearest.empty() ? "" : ", did you mean '" + nearest + "'?") +
               (list.empty() ? "; no key is allowed here" : "; allowed: " + list));
  }
}

std::optional<YamlNode> YamlMap::find(std::string_view key) const {
  key = formsOf(key).name;
  std::string_view suffix, former;
  for (const std::string_view allowed : allowed_) {
    if (formsOf(allowed).name != key) continue;
    suffix = formsOf(allowed).suffix;
    former = formsOf(allowed).former;
  }
  std::optional<YamlNode> found = node_.child(key);
  if (!former.empty()) {
    if (const std::optional<YamlNode> old = node_.child(former)) {
      if (found) old->fail("given twice, as " + std::string(key) + " and " + std::string(former));
      return old;
    }
  }
  if (suffix.empty()) return found;
  const std::string suffixed = std::string(key) + std::string(suffix);
  if (std::optional<YamlNode> other = node_.child(suffixed)) {
    if (found) other->fail("given twice, as " + std::string(key) + " and " + suffixed);
    found = other;
    found->unit_ = suffix == "_mm" ? YamlNode::Unit::kMilli : YamlNode::Unit::kDegree;
  }
  return found;
}

void YamlMap::rejectBoth(std::string_view key, std::string_view other, std::string_view remedy) const {
  const std::optional<YamlNode> value = find(key);
  if (value && has(other)) value->fail("conflicts with `" + std::string(other) + "`: " + std::string(remedy));
}

void YamlMap::fail(std::string_view key, const std::string& what) const {
  std::string form(key);
  for (const std::string_view allowed : allowed_) {
    if (formsOf(allowed).name == key) form = allowed;
  }
  node_.fail(form + " is missing: " + what);
}

YamlNode YamlMap::require(std::string_view key, const std::string& what) const {
  std::optional<YamlNode> value = find(key);
  if (!value) fail(key, what);
  return *value;
}

double YamlMap::number(std::string_view key, const Allowed& allowed, std::optional<double> otherwise) const {
  const std::optional<YamlNode> value = find(key);
  if (!value && !otherwise) fail(key, describe(allowed, YamlNode::Unit::kSi));
  const double result = value ? value->number(allowed) : *otherwise;
  canonical_->line(key, canonicalNumber(result));
  return result;
}

std::uint64_t YamlMap::integer(std::string_view key, std::uint64_t min, std::uint64_t max, std::optional<std::uint64_t> otherwise) const {
  const std::optional<YamlNode> value = find(key);
  if (!value && !otherwise) fail(key, "a whole number from " + std::to_string(min) + " to " + std::to_string(max));
  const std::uint64_t result = value ? value->integer(min, max) : *otherwise;
  canonical_->line(key, std::to_string(result));
  return result;
}

std::string YamlMap::text(std::string_view key, const std::string& what, std::optional<std::string> otherwise) const {
  const std::optional<YamlNode> value = find(key);
  if (!value && !otherwise) fail(key, what);
  std::string result = value ? value->text(what) : *otherwise;
  canonical_->line(key, canonicalText(result));
  return result;
}

std::string YamlMap::choice(std::string_view key, std::initializer_list<std::string_view> words, std::string_view otherwise) const {
  const std::optional<YamlNode> value = find(key);
  if (!value && otherwise.empty()) {
    std::string list;
    for (const std::string_view word : words) list += (list.empty() ? "" : " | ") + std::string(word);
    fail(key, list);
  }
  std::string result = value ? value->choice(words) : std::string(otherwise);
  canonical_->line(key, canonicalText(result));
  return result;
}

}  // namespace taxelsim
