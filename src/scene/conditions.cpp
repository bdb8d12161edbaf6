#include "scene/conditions.h"

#include <algorithm>
#include <array>
#include <utility>

#include "base/text.h"
#include "scene/keys/scene.h"
#include "scene/yaml_reader.h"
#include "taxelsim/error.h"
#include "taxelsim/scene.h"

namespace taxelsim {
namespace {

constexpr std::string_view kConditions = "conditions";
constexpr std::array<std::string_view, 2> kReplaced{"sensor", "robot"};
constexpr std::string_view kRandomization = "randomization";
constexpr std::string_view kFormerRandomization = "randomisation";
constexpr std::string_view kNameCharacters = "abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ0123456789_-";
constexpr std::size_t kMaxName = 40;  // bytes

YamlTree* find(YamlTree& map, std::string_view key) {
  for (std::size_t i = 0; i < map.keys.size(); ++i) {
    if (map.keys[i].text == key) return &map.children[i];
  }
  return nullptr;
}

void set(YamlTree& map, const YamlTree::Key& key, const YamlTree& value) {
  if (YamlTree* const old = find(map, key.text)) {
    *old = value;
    return;
  }
  map.keys.push_back(key);
  map.children.push_back(value);
}

std::string_view withoutUnit(std::string_view key) {
  for (const std::string_view suffix : {"_mm", "_deg"}) {
    if (key.ends_with(suffix)) return key.substr(0, key.size() - suffix.size());
  }
  return key;
}

// Whether one key replaces the other: the same value in any unit, or the two ways to give the initial contact.
bool replaces(std::string_view key, std::string_view other) {
  key = withoutUnit(key);
  other = withoutUnit(other);
  return key == other || (key == "load" && other == "depth") || (key == "depth" && other == "load");
}

void replaceKeys(YamlTree& map, const YamlTree& overrides) {
  for (std::size_t i = map.keys.size(); i-- > 0;) {
    const bool replaced = std::any_of(overrides.keys.begin(), overrides.keys.end(),
                                      [&](const YamlTree::Key& key) { return replaces(key.text, map.keys[i].text); });
    if (!replaced) continue;
    map.keys.erase(map.keys.begin() + static_cast<std::ptrdiff_t>(i));
    map.children.erase(map.children.begin() + static_cast<std::ptrdiff_t>(i));
  }
  map.keys.insert(map.keys.end(), overrides.keys.begin(), overrides.keys.end());
  map.children.insert(map.children.end(), overrides.children.begin(), overrides.children.end());
}

bool isName(std::string_view text) {
  return !text.empty() && text.size() <= kMaxName && text.find_first_not_of(kNameCharacters) == std::string_view::npos;
}

const Block& keysOfConditions(const YamlNode& scene) {
  const std::optional<YamlNode> kind = scene.child("kind");
  return kind && kind->isScalar() && kind->tree().text == "grasp" ? graspConditionKeys() : conditionKeys();
}

}  // namespace

std::vector<std::string> conditionNames(const YamlTree& scene, const std::string& file) {
  const YamlNode root(scene, file);
  const std::optional<YamlNode> block = root.child(kConditions);
  if (!block) return {};
  if (!block->isMap()) block->refuse("a mapping of names to overrides");
  const Block& keys = keysOfConditions(root);
  std::vector<std::string> names;
  const auto at = std::find_if(scene.keys.begin(), scene.keys.end(), [](const YamlTree::Key& key) { return key.text == kConditions; });
  for (const YamlTree::Key& key : scene.children[static_cast<std::size_t>(at - scene.keys.begin())].keys) {
    if (!isName(key.text)) block->fail("a name has 1 to 40 letters, digits, _ and -");
    const YamlNode condition = *block->child(key.text);
    if (key.text == kNominalCondition) condition.fail("this name means the scene without overrides");
    Canonical unused;
    const YamlMap map(condition, keys, unused);
    const std::optional<YamlNode> randomization = map.find(kRandomization);
    if (randomization && !randomization->isMap()) randomization->refuse("a mapping of keys of the scene's randomization");
    names.push_back(key.text);
  }
  return names;
}

YamlTree inCondition(YamlTree scene, const std::string& file, std::string_view condition) {
  const std::vector<std::string> names = conditionNames(scene, file);
  if (condition == kNominalCondition) return scene;
  if (std::find(names.begin(), names.end(), condition) == names.end()) {
    std::string known(kNominalCondition);
    for (const std::string& name : names) known += ", " + name;
    throw Error(ErrorKind::kInput, oneLine(file + ": condition " + std::string(condition) + ": not in this scene; it has " + known));
  }
  const YamlTree overrides = *find(*find(scene, kConditions), condition);
  for (std::size_t i = 0; i < overrides.keys.size(); ++i) {
    if (std::ranges::find(kReplaced, overrides.keys[i].text) != kReplaced.end()) {
      set(scene, overrides.keys[i], overrides.children[i]);
      continue;
    }
    YamlTree* randomization = find(scene, kRandomization);
    if (randomization == nullptr) randomization = find(scene, kFormerRandomization);
    if (randomization == nullptr) {
      set(scene, overrides.keys[i], overrides.children[i]);
    } else if (randomization->kind == YamlTree::Kind::kMap) {  // anything else is refused when it is read
      replaceKeys(*randomization, overrides.children[i]);
    }
  }
  return scene;
}

bool haveSameLayout(const Sensor& a, const Sensor& b) {
  const bool same_patches =
      std::equal(a.patches.begin(), a.patches.end(), b.patches.begin(), b.patches.end(),
                 [](const GridPatch& p, const GridPatch& q) { return p.num_rows == q.num_rows && p.num_cols == q.num_cols; });
  return same_patches && taxelPositions(a) == taxelPositions(b);
}

}  // namespace taxelsim
