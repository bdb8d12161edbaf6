#include "scene/skin_reader.h"

#include <algorithm>
#include <utility>

#include "scene/keys/sensor.h"
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

template <typename Law>
void readLawFields(const YamlMap& map, Law& law) {
  visitFields(law, [&](const auto& table) { readFields(map, table, law); });
}

void readLawFields(const YamlMap& map, ElasticLayer& law) {
  readFields(map, kElasticLayerFields, law);
  law.base = map.choice<ElasticLayer::Base>("base");
  readFields(map, kLayerSolverFields, law);
}

// Refuses keys of other laws.
void checkLawKeys(const YamlMap& map, std::size_t chosen) {
  const std::vector<Block::Case>& laws = skinKeys().cases;
  const auto has = [](const Block::Case& law, std::string_view name) {
    return std::any_of(law.keys.begin(), law.keys.end(), [&](const Key& key) { return key.name() == name; });
  };
  for (const Block::Case& other : laws) {
    for (const Key& key : other.keys) {
      if (has(laws[chosen], key.name())) continue;
      if (const std::optional<YamlNode> given = map.find(key.name())) {
        given->fail("not a key of law " + std::string(kLawNames[chosen]) + " but of " + std::string(other.word));
      }
    }
  }
}

ContactLaw readLaw(const YamlMap& map) {
  const std::size_t chosen = map.wordOf("law");
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
  const auto table = std::span<const Field<Friction>>(kFrictionFields);
  readFields(map, table.first(1), friction);
  if (friction.friction_coefficient > 0) {
    readFields(map, table.subspan(1), friction);
  } else if (const std::optional<YamlNode> alone = map.find("tangential_stiffness")) {
    alone->fail("given without friction: needs friction_coefficient > 0");
  }
  return friction;
}

}  // namespace

Skin readSkin(const YamlMap& sensor) {
  refusePasternak(sensor);
  const YamlMap map(sensor, "skin");
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
