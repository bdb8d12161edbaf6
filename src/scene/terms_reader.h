// A list of {fraction, time}: terms of relaxation or creep.
#pragma once

#include <array>
#include <optional>
#include <string>
#include <vector>

#include "scene/yaml_reader.h"

namespace taxelsim {

template <typename Term, std::size_t N>
std::vector<Term> readTerms(const YamlMap& map, std::string_view key, int max_terms, const std::array<Field<Term>, N>& fields) {
  const std::optional<YamlNode> node = map.find(key);
  const std::string what = map.whatOf(key);
  const std::vector<YamlNode> items = node ? node->items(what) : std::vector<YamlNode>{};
  if (items.size() > static_cast<std::size_t>(max_terms)) node->refuse(what);
  if (items.empty()) {
    map.canonical().line(key, "[]");
    return {};
  }
  std::vector<Term> terms;
  map.canonical().open(key);
  for (const YamlNode& item : items) readFields(YamlMap::item(item, map.itemBlock(key), map.canonical()), fields, terms.emplace_back());
  map.canonical().close();
  return terms;
}

}  // namespace taxelsim
