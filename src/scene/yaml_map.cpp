// Mappings: YamlMap of yaml_reader.h.
#include <algorithm>

#include "base/log.h"
#include "base/text.h"
#include "scene/yaml_reader.h"

namespace taxelsim {
namespace {

const YamlTree& emptyMap() {
  static const YamlTree tree = [] {
    YamlTree map;
    map.kind = YamlTree::Kind::kMap;
    return map;
  }();
  return tree;
}

YamlMap::Keys keysWithout(const Block& block, std::string_view key) {
  YamlMap::Keys keys = block.allKeys();
  std::erase(keys, key);
  return keys;
}

}  // namespace

YamlMap::YamlMap(const YamlNode& node, Keys allowed, const Block* block, Canonical& canonical, bool closes)
    : node_(node), allowed_(std::move(allowed)), block_(block), canonical_(&canonical), closes_(closes) {
  checkKeys();
}

YamlMap::YamlMap(const YamlNode& node, Keys allowed, Canonical& canonical) : YamlMap(node, std::move(allowed), nullptr, canonical, false) {}

YamlMap::YamlMap(const YamlNode& node, const Block& block, Canonical& canonical, std::string_view without)
    : YamlMap(node, without.empty() ? block.allKeys() : keysWithout(block, without), &block, canonical, false) {}

YamlMap::YamlMap(const YamlMap& parent, std::string_view key, Keys allowed)
    : YamlMap(blockOf(parent, key), std::move(allowed), nullptr, parent.canonical(), true) {
  canonical_->open(key);
}

YamlMap::YamlMap(const YamlMap& parent, std::string_view key, const Block& block)
    : YamlMap(blockOf(parent, key), block.allKeys(), &block, parent.canonical(), true) {
  canonical_->open(key);
}

YamlMap::YamlMap(const YamlMap& parent, std::string_view key) : YamlMap(parent, key, std::get<Nested>(parent.keyOf(key).type).block()) {}

YamlMap::YamlMap(const YamlMap& map, Canonical& canonical)
    : node_(map.node_), allowed_(map.allowed_), block_(map.block_), canonical_(&canonical) {}

YamlMap YamlMap::item(const YamlNode& node, Keys allowed, Canonical& canonical) {
  canonical.openItem();
  return YamlMap(node, std::move(allowed), nullptr, canonical, true);
}

YamlMap YamlMap::item(const YamlNode& node, const Block& block, Canonical& canonical) {
  canonical.openItem();
  return YamlMap(node, block.allKeys(), &block, canonical, true);
}

YamlMap::~YamlMap() {
  if (closes_) canonical_->close();
}

YamlNode YamlMap::blockOf(const YamlMap& parent, std::string_view key) {
  if (std::optional<YamlNode> given = parent.find(key)) return *given;
  YamlNode block = parent.node_;
  block.tree_ = &emptyMap();
  block.path_ = YamlNode::below(block.path_, key);
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
    place.path_ = YamlNode::below(place.path_, std::string_view(key.text).substr(0, kMaxShown));
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
    found->unit_ = unitOfSuffix(suffix);
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

const Key& YamlMap::keyOf(std::string_view key) const {
  const Key* const found = block_ == nullptr ? nullptr : block_->find(key);
  if (found == nullptr) throw std::logic_error("no table has the key " + std::string(key));
  return *found;
}

YamlNode YamlMap::require(std::string_view key) const {
  return require(key, whatOf(key));
}

std::string YamlMap::whatOf(std::string_view key) const {
  return describe(keyOf(key).type);
}

double YamlMap::number(std::string_view key) const {
  return number(key, allowedOf(key));
}

std::string YamlMap::text(std::string_view key) const {
  const Key& row = keyOf(key);
  return text(key, std::get<Text>(row.type).what);
}

const Allowed& YamlMap::allowedOf(std::string_view key) const {
  const ValueType& type = keyOf(key).type;
  const auto* const one = std::get_if<Number>(&type);
  return one != nullptr ? one->allowed : std::get<Numbers>(type).allowed;
}

std::size_t YamlMap::wordOf(std::string_view key) const {
  const Key& row = keyOf(key);
  const auto& words = std::get<Words>(row.type).words;
  const std::optional<YamlNode> value = find(key);
  if (!value && row.otherwise == kNeeded) fail(key, listOf(words));
  const std::string word = value ? value->choice(words) : row.otherwise;
  canonical_->line(key, canonicalText(word));
  return static_cast<std::size_t>(std::find(words.begin(), words.end(), word) - words.begin());
}

const Block& YamlMap::itemBlock(std::string_view key) const {
  return std::get<NestedList>(keyOf(key).type).block();
}

std::vector<YamlNode> YamlMap::items(std::string_view key) const {
  const std::string what = whatOf(key);
  const YamlNode list = require(key, what);
  std::vector<YamlNode> all = list.items(what);
  if (all.empty()) list.refuse(what);
  return all;
}

std::string_view YamlMap::onlyOne() const {
  std::string_view chosen;
  for (const std::string_view key : block_->one_of) {
    if (!has(key)) continue;
    if (!chosen.empty()) rejectBoth(key, chosen, "exactly one of " + listOf(block_->one_of));
    chosen = key;
  }
  if (chosen.empty()) node_.fail("exactly one of " + listOf(block_->one_of));
  return chosen;
}

double YamlMap::number(std::string_view key, const Allowed& allowed, std::optional<double> otherwise) const {
  const std::optional<YamlNode> value = find(key);
  if (!value && !otherwise) fail(key, describe(allowed));
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

std::string YamlMap::choice(std::string_view key, std::initializer_list<std::string_view> list, std::string_view otherwise) const {
  const std::span<const std::string_view> words(list.begin(), list.size());
  const std::optional<YamlNode> value = find(key);
  if (!value && otherwise.empty()) fail(key, listOf(words));
  std::string result = value ? value->choice(words) : std::string(otherwise);
  canonical_->line(key, canonicalText(result));
  return result;
}

}  // namespace taxelsim
