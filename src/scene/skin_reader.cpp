#include "scene/skin_reader.h"

#include <algorithm>
#include <utility>

#include "scene/terms_reader.h"
#include "sensor/fields.h"
#include "sensor/hints.h"

namespace taxelsim {
namespace {

// Calls visit(law) with the default of every law, in the order of kLawNames.
template <typename Visit, std::size_t... I>
void forEachLaw(Visit visit, std::index_sequence<I...>) {
  (visit(std::variant_alternative_t<I, ContactLaw>{}), ...);
}
template <typename Visit>
void forEachLaw(Visit visit) {
  forEachLaw(visit, std::make_index_sequence<std::variant_size_v<ContactLaw>>());
}

// Keys of each law, in the order of kLawNames.
const std::vector<YamlMap::Keys>& lawKeys() {
  static const std::vector<YamlMap::Keys> all = [] {
    std::vector<YamlMap::Keys> result;
    forEachLaw([&](const auto& law) {
      YamlMap::Keys& keys = result.emplace_back();
      visitFields(law, [&](const auto& table) { addKeys(table, keys); });
      if constexpr (std::is_same_v<std::decay_t<decltype(law)>, ElasticLayer>) {
        keys.insert(keys.begin() + kElasticLayerFields.size(), "base");
        addKeys(kMarginFields, keys);
      }
    });
    return result;
  }();
  return all;
}

template <typename Law>
void readLawFields(const YamlMap& map, Law& law) {
  visitFields(law, [&](const auto& table) { readFields(map, table, law); });
}

void readLawFields(const YamlMap& map, ElasticLayer& law) {
  readFields(map, kElasticLayerFields, law);
  const bool is_bonded = map.choice("base", {"half_space", "bonded"}, "bonded") == "bonded";
  law.base = is_bonded ? ElasticLayer::Base::kBonded : ElasticLayer::Base::kHalfSpace;
  readFields(map, kLayerSolverFields, law);
}

// Refuses keys of other laws.
void checkLawKeys(const YamlMap& map, std::size_t chosen) {
  const YamlMap::Keys& keys = lawKeys()[chosen];
  for (std::size_t other = 0; other < kLawNames.size(); ++other) {
    for (const std::string_view key : lawKeys()[other]) {
      if (std::find(keys.begin(), keys.end(), key) != keys.end()) continue;
      if (const std::optional<YamlNode> given = map.find(key)) {
        given->fail("not a key of law " + std::string(kLawNames[chosen]) + " but of " + std::string(kLawNames[other]));
      }
    }
  }
}

ContactLaw readLaw(const YamlMap& map) {
  const std::string name =
      map.choice("law", {"winkler", "mass_spring_damper", "deformation_mask", "proximity", "elastic_layer", "lugre"}, "winkler");
  const auto chosen = static_cast<std::size_t>(std::find(kLawNames.begin(), kLawNames.end(), name) - kLawNames.begin());
  checkLawKeys(map, chosen);
  ContactLaw result;
  std::size_t number = 0;
  forEachLaw([&](auto law) {
    if (number++ != chosen) return;
    readLawFields(map, law);
    result = law;
  });
  return result;
}

// Files of earlier versions may name the law, and have its keys.
void refusePasternak(const YamlMap& sensor) {
  const std::optional<YamlNode> skin = sensor.find("skin"), law = skin ? skin->child("law") : std::nullopt;
  if (law && law->tree().text == "pasternak") law->refuse("removed; use elastic_layer, or winkler with depth_sampling: area");
}

Friction readFriction(const YamlMap& map) {
  Friction friction;
  friction.friction_coefficient =
      map.number("friction_coefficient", Allowed::within(0, kMaxFrictionCoefficient, ""), friction.friction_coefficient);
  if (friction.friction_coefficient > 0) {
    friction.tangential_stiffness = map.number("tangential_stiffness", Allowed::above(0, "N/m^3"));
  } else if (const std::optional<YamlNode> alone = map.find("tangential_stiffness")) {
    alone->fail("given without friction: needs friction_coefficient > 0");
  }
  return friction;
}

}  // namespace

Skin readSkin(const YamlMap& sensor) {
  refusePasternak(sensor);
  YamlMap::Keys keys;
  addKeys(kSkinFields, keys);
  for (const std::string_view key : {"law", "friction_coefficient", "tangential_stiffness", "relaxation"}) keys.push_back(key);
  for (const YamlMap::Keys& of_law : lawKeys()) {
    for (const std::string_view key : of_law) {
      if (std::find(keys.begin(), keys.end(), key) == keys.end()) keys.push_back(key);
    }
  }
  const YamlMap map(sensor, "skin", keys);
  Skin skin;
  readFields(map, kSkinFields, skin);
  if (const std::string question = unitQuestion(skin); !question.empty()) map.require("thickness", "").warn(question + " thickness_mm");
  skin.law = readLaw(map);
  if (std::holds_alternative<ElasticLayer>(skin.law)) readFields(map, kMarginFields, skin);
  skin.friction = readFriction(map);
  skin.relaxation = readTerms(map, "relaxation", kMaxRelaxationTerms, kRelaxationFields);
  return skin;
}

}  // namespace taxelsim
