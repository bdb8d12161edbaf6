#include "cli/json_schema.h"

#include <spdlog/fmt/fmt.h>

#include <cmath>
#include <optional>
#include <set>
#include <utility>
#include <variant>
#include <vector>

#include "base/text.h"
#include "scene/file_unit.h"
#include "scene/keys/robot.h"
#include "scene/keys/scene.h"
#include "scene/keys/sensor.h"

namespace taxelsim::cli {
namespace {

using Json = nlohmann::ordered_json;

// Gives the default as a value, or nothing if it is in words.
std::optional<Json> valueOf(const Key& key) {
  if (const auto* words = std::get_if<Words>(&key.type); words != nullptr && !words->is_list && key.otherwise != kNeeded)
    return Json(key.otherwise);
  const Json value = Json::parse(key.otherwise, nullptr, /*allow_exceptions=*/false);
  return value.is_discarded() ? std::nullopt : std::optional(value);
}

Json numberSchema(const Allowed& allowed, bool is_whole) {
  Json schema{{"type", is_whole ? "integer" : "number"}};
  if (std::isfinite(allowed.min)) schema[allowed.above_min ? "exclusiveMinimum" : "minimum"] = allowed.min;
  if (std::isfinite(allowed.max)) schema[allowed.below_max ? "exclusiveMaximum" : "maximum"] = allowed.max;
  return schema;
}

class SchemaWriter {
 public:
  Json object(const Block& block) {
    Json schema{{"type", "object"}, {"properties", properties(block.keys)}, {"additionalProperties", false}};
    for (const Block::Case& one : block.cases) {
      schema["properties"].update(properties(one.keys));
    }
    Json conditions = required(block.keys);
    for (const Block::Case& one : block.cases) conditions.push_back(caseSchema(block, one));
    if (!conditions.empty()) schema["allOf"] = std::move(conditions);
    for (const std::string_view key : block.one_of) schema["oneOf"].push_back(given(*block.find(key)));
    return schema;
  }

  // All named blocks that objects refer to.
  Json definitions() {
    Json all = Json::object();
    for (std::size_t i = 0; i < named_.size(); ++i) all[std::string(named_[i]->name)] = object(*named_[i]);
    return all;
  }

  Json reference(const Block& block) {
    if (block.name.empty()) return object(block);
    if (names_.insert(block.name).second) named_.push_back(&block);
    return {{"$ref", "#/definitions/" + std::string(block.name)}};
  }

 private:
  Json properties(const KeyTable& keys) {
    Json all = Json::object();
    for (const Key& key : keys) {
      all.emplace(std::string(key.name()), property(key, FileUnit::kSi));
      if (const std::string_view suffix = formsOf(key.key).suffix; !suffix.empty()) {
        all.emplace(std::string(key.name()).append(suffix), property(key, unitOfSuffix(suffix)));
      }
    }
    return all;
  }

  Json property(const Key& key, FileUnit unit) {
    std::string unit_name;
    Json schema = std::visit([&](const auto& type) { return typeSchema(type, unit, unit_name); }, key.type);
    const bool says_default = key.otherwise != kNeeded && !key.otherwise.empty();
    schema["description"] = key.text + (unit_name.empty() ? "" : ", " + unit_name) + "." +
                            (says_default && unit == FileUnit::kSi ? " Default: " + key.otherwise + "." : "");
    if (!unit_name.empty()) schema["unit"] = unit_name;
    if (const std::optional<Json> value = valueOf(key); value && unit == FileUnit::kSi) schema["default"] = *value;
    return schema;
  }

  Json typeSchema(const Number& number, FileUnit unit, std::string& unit_name) {
    return numberSchema(inUnit(number.allowed, unit, unit_name), number.is_whole);
  }
  Json typeSchema(const Numbers& numbers, FileUnit unit, std::string& unit_name) {
    const Json one = numberSchema(inUnit(numbers.allowed, unit, unit_name), false);
    Json list{{"type", "array"}, {"items", one}};
    if (numbers.count != kAnyNumber) list["minItems"] = list["maxItems"] = numbers.count;
    if (numbers.or_one) return {{"anyOf", {one, list}}};
    if (numbers.in_rows) return {{"anyOf", {list, {{"type", "array"}, {"items", list}}}}};
    return list;
  }
  Json typeSchema(const Words& words, FileUnit, std::string&) {
    Json one{{"enum", words.words}};
    return words.is_list ? Json{{"type", "array"}, {"items", one}, {"minItems", 1}, {"uniqueItems", true}} : one;
  }
  Json typeSchema(const Text& text, FileUnit, std::string&) {
    const Json one{{"type", "string"}};
    return text.is_list ? Json{{"type", "array"}, {"items", one}, {"minItems", 1}} : one;
  }
  Json typeSchema(const Nested& nested, FileUnit, std::string&) {
    const Json mapping = reference(nested.block());
    return {{"anyOf", nested.file.empty() ? Json{mapping} : Json{{{"type", "string"}}, mapping}}};
  }
  Json typeSchema(const NestedList& list, FileUnit, std::string&) { return {{"type", "array"}, {"items", reference(list.block())}}; }
  Json typeSchema(const NestedByName& map, FileUnit, std::string&) {
    return {{"type", "object"}, {"additionalProperties", reference(map.block())}};
  }

  // Requires a key in any of its forms.
  static Json given(const Key& key) {
    const Json name{{"required", {key.name()}}};
    const std::string_view suffix = formsOf(key.key).suffix;
    return suffix.empty() ? name : Json{{"anyOf", {name, {{"required", {std::string(key.name()).append(suffix)}}}}}};
  }

  static Json required(const KeyTable& keys) {
    Json all = Json::array();
    for (const Key& key : keys) {
      if (key.otherwise == kNeeded) all.push_back(given(key));
    }
    return all;
  }

  // Applies the keys of a case where the selector has its word, or is missing and the word is the default.
  Json caseSchema(const Block& block, const Block::Case& one) {
    const std::string selector(block.selector);
    Json chosen{{"properties", {{selector, {{"const", one.word}}}}}};
    if (block.find(selector)->otherwise != one.word) chosen["required"] = {selector};
    const Json own = properties(one.keys);
    Json then{{"properties", own}};
    for (const Block::Case& other : block.cases) {
      const Json keys = properties(other.keys);
      for (const auto& [name, value] : keys.items()) then["properties"].emplace(name, false);
    }
    if (Json needed = required(one.keys); !needed.empty()) then["allOf"] = std::move(needed);
    return {{"if", chosen}, {"then", then}};
  }

  std::vector<const Block*> named_;
  std::set<std::string_view> names_;
};

// A scene has the keys of the kind that it names.
Json sceneObject(SchemaWriter& writer) {
  Json schema{{"type", "object"}, {"properties", {{"kind", {{"enum", kSceneKindNames}}}}}, {"required", {"kind"}}};
  for (std::size_t kind = 0; kind < kSceneKindNames.size(); ++kind) {
    schema["allOf"].push_back({{"if", {{"properties", {{"kind", {{"const", kSceneKindNames[kind]}}}}}}},
                               {"then", writer.reference(sceneKeys(static_cast<Scene::Kind>(kind)))}});
  }
  return schema;
}

// "> 0 m", "1 to 128"
std::string rangeText(const Allowed& allowed, FileUnit unit, bool is_whole) {
  std::string name;
  if (allowed.min == allowed.max) return numberText(allowed.min);
  std::string text = is_whole ? describeWhole(inUnit(allowed, unit, name)) : describe(inUnit(allowed, unit, name));
  for (const std::string_view words : {"a whole number from ", "a number from ", "a number "}) {
    if (text.starts_with(words)) text.erase(0, words.size());
  }
  if (is_whole && !name.empty()) text += " " + name;
  return text == "a number" ? "any" : text;
}

class TableWriter {
 public:
  std::string text;

  void table(const Block& block) {
    if (!names_.insert(block.name).second) return;
    text += fmt::format("## {}\n\n| key | allowed | default | meaning |\n|---|---|---|---|\n", block.name);
    rows(block, "");
    text += "\n";
    const std::vector<const Block*> named = std::exchange(named_, {});
    for (const Block* const inner : named) table(*inner);
  }

 private:
  void rows(const Block& block, const std::string& indent) {
    for (const Key& key : block.keys) row(key, indent, "");
    for (const Block::Case& one : block.cases) {
      for (const Key& key : one.keys) row(key, indent, fmt::format("`{}`: ", one.word));
    }
  }

  void row(const Key& key, const std::string& indent, const std::string& condition) {
    const std::string_view name = key.key.substr(0, key.key.find('('));
    text += fmt::format("| `{}{}` | {} | {} | {}{} |\n", indent, name, allowedText(key), defaultText(key), condition, escaped(key.text));
    const Block* const block = blockOf(key);
    if (block == nullptr) return;
    if (block->name.empty()) return rows(*block, indent + "  ");
    named_.push_back(block);
  }

  static const Block* blockOf(const Key& key) {
    if (const auto* nested = std::get_if<Nested>(&key.type)) return &nested->block();
    if (const auto* list = std::get_if<NestedList>(&key.type)) return &list->block();
    if (const auto* map = std::get_if<NestedByName>(&key.type)) return &map->block();
    return nullptr;
  }

  static std::string allowedText(const Key& key) {
    const FileUnit unit = unitOfSuffix(formsOf(key.key).suffix) == FileUnit::kDegree ? FileUnit::kDegree : FileUnit::kSi;
    std::string what;
    if (const auto* number = std::get_if<Number>(&key.type)) {
      what = rangeText(number->allowed, unit, number->is_whole);
    } else if (const auto* numbers = std::get_if<Numbers>(&key.type)) {
      const std::string count = numbers->count == kAnyNumber ? "" : std::to_string(numbers->count) + " ";
      what = fmt::format("{}{}: {}", numbers->or_one ? "a number, or " : "", count + "numbers", rangeText(numbers->allowed, unit, false));
    } else if (const auto* words = std::get_if<Words>(&key.type)) {
      for (const std::string_view word : words->words) what += fmt::format("{}`{}`", what.empty() ? "" : ", ", word);
    } else {
      what = describe(key.type);
    }
    const Block* const block = blockOf(key);
    return escaped(what) + (block == nullptr || block->name.empty() ? "" : fmt::format(", [{0}](#{0})", block->name));
  }

  // Gives angles in degrees.
  static std::string defaultText(const Key& key) {
    const std::optional<Json> value = valueOf(key);
    if (!value || unitOfSuffix(formsOf(key.key).suffix) != FileUnit::kDegree)
      return value ? fmt::format("`{}`", key.otherwise) : key.otherwise;
    if (value->is_number())
      return value->get<double>() == 0 ? "`0`" : fmt::format("{:.4g} deg", inUnit(value->get<double>(), FileUnit::kDegree));
    std::string list;
    for (const Json& each : *value) list += (list.empty() ? "" : ", ") + numberText(inUnit(each.get<double>(), FileUnit::kDegree));
    return fmt::format("[{}] deg", list);
  }

  static std::string escaped(std::string cell) {
    for (std::size_t at = 0; (at = cell.find('|', at)) != std::string::npos; at += 2) cell.insert(at, 1, '\\');
    return cell;
  }

  std::set<std::string_view> names_;
  std::vector<const Block*> named_;  // blocks that the current table names
};

}  // namespace

Json jsonSchema(const std::string& kind) {
  SchemaWriter writer;
  Json schema{{"$schema", "http://json-schema.org/draft-07/schema#"}, {"title", "taxelsim " + kind}};
  schema.update(kind == "sensor" ? writer.object(sensorKeys()) : kind == "robot" ? writer.object(robotKeys()) : sceneObject(writer));
  schema["required"].push_back("format_version");
  schema["definitions"] = writer.definitions();
  return schema;
}

std::string keyTables(const std::string& kind) {
  TableWriter writer;
  if (kind == "sensor") writer.table(sensorKeys());
  if (kind == "robot") writer.table(robotKeys());
  if (kind == "scene") {
    for (std::size_t k = 0; k < kSceneKindNames.size(); ++k) writer.table(sceneKeys(static_cast<Scene::Kind>(k)));
  }
  return writer.text;
}

}  // namespace taxelsim::cli
