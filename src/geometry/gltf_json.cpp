#include "geometry/gltf_json.h"

#include <nlohmann/json.hpp>
#include <set>
#include <utility>

#include "base/text.h"

namespace taxelsim {
namespace {

using Json = nlohmann::json;

constexpr std::size_t kMaxJsonDepth = 64;
constexpr std::size_t kMaxJsonValues = std::size_t{1} << 23;

// Checks the text before it becomes a tree. (A callback of Json::parse() would take a time that is quadratic in the length of a list.)
class JsonChecker : public nlohmann::json_sax<Json> {
 public:
  bool null() override { return count(); }
  bool boolean(bool) override { return count(); }
  bool number_integer(std::int64_t) override { return count(); }
  bool number_unsigned(std::uint64_t) override { return count(); }
  bool number_float(double, const std::string&) override { return count(); }
  bool string(std::string&) override { return count(); }
  bool binary(Json::binary_t&) override { return count(); }
  bool start_array(std::size_t) override { return open(); }
  bool end_array() override { return close(); }
  bool start_object(std::size_t) override { return open(); }
  bool end_object() override { return close(); }

  bool key(std::string& name) override {
    if (!keys_.back().insert(name).second) throw GltfProblem{"its JSON has the key \"" + shownGltfText(name) + "\" twice in one object"};
    return true;
  }

  bool parse_error(std::size_t byte, const std::string&, const Json::exception& error) override {
    constexpr int kOutOfRange = 406;
    if (error.id == kOutOfRange) throw GltfProblem{"its JSON has a number that is too large, before byte " + std::to_string(byte)};
    throw GltfProblem{"it is not glTF: no JSON at byte " + std::to_string(byte)};
  }

 private:
  bool count() {
    if (++num_values_ > kMaxJsonValues) throw GltfProblem{"its JSON has more than " + std::to_string(kMaxJsonValues) + " values"};
    return true;
  }

  bool open() {
    if (keys_.size() == kMaxJsonDepth) throw GltfProblem{"its JSON nests deeper than " + std::to_string(kMaxJsonDepth) + " levels"};
    keys_.emplace_back();
    return count();
  }

  bool close() {
    keys_.pop_back();
    return true;
  }

  std::vector<std::set<std::string>> keys_;  // of each object that is open; empty for lists
  std::size_t num_values_ = 0;
};

bool isIndex(const Json& value, std::size_t size) {
  return value.is_number_unsigned() && value.get<std::uint64_t>() < size;
}

[[noreturn]] void refuseValue(const std::string& path, const Json& value, const std::string& allowed) {
  const std::string shown = value.is_structured() ? (value.is_array() ? "a list" : "an object") : shownGltfText(value.dump());
  throw GltfProblem{path + ": " + shown + " is not allowed: " + allowed};
}

std::string indexBelow(const char* list, std::size_t size) {
  return "an index of " + std::string(list) + ", which has " + std::to_string(size) + (size == 1 ? " entry" : " entries");
}

}  // namespace

std::string shownGltfText(std::string_view text) {
  return oneLine(text.substr(0, kMaxShown)) + (text.size() > kMaxShown ? "..." : "");
}

Json parseGltfJson(std::string_view text) {
  JsonChecker checker;
  Json::sax_parse(text.begin(), text.end(), &checker);
  Json json = Json::parse(text.begin(), text.end());
  if (!json.is_object()) throw GltfProblem{"it is not glTF: no JSON object"};
  return json;
}

GltfItem::GltfItem(const Json& value, std::string path) : value_(&value), path_(std::move(path)) {
  if (!value.is_object()) refuseValue(path_, value, "an object");
}

const Json* GltfItem::find(const char* key) const {
  const auto found = value_->find(key);
  return found == value_->end() ? nullptr : &*found;
}

const Json* GltfItem::findList(const char* key) const {
  const Json* list = find(key);
  if (list != nullptr && !list->is_array()) refuse(key, "a list");
  return list;
}

std::string GltfItem::pathOf(const char* key) const {
  return path_.empty() ? key : path_ + "." + key;
}

void GltfItem::refuse(const char* key, const std::string& allowed) const {
  if (const Json* value = find(key)) refuseValue(pathOf(key), *value, allowed);
  throw GltfProblem{pathOf(key) + " is missing: " + allowed};
}

bool GltfItem::has(const char* key) const {
  return find(key) != nullptr;
}

std::uint64_t GltfItem::whole(const char* key, std::uint64_t max, std::optional<std::uint64_t> fallback) const {
  const Json* value = find(key);
  if (value == nullptr && fallback) return *fallback;
  if (value == nullptr || !value->is_number_unsigned() || value->get<std::uint64_t>() > max)
    refuse(key, "a whole number up to " + std::to_string(max));
  return value->get<std::uint64_t>();
}

std::string GltfItem::text(const char* key) const {
  const Json* value = find(key);
  if (value == nullptr || !value->is_string()) refuse(key, "a text");
  return value->get<std::string>();
}

bool GltfItem::flag(const char* key, bool fallback) const {
  const Json* value = find(key);
  if (value != nullptr && !value->is_boolean()) refuse(key, "true or false");
  return value == nullptr ? fallback : value->get<bool>();
}

std::vector<float> GltfItem::numbers(const char* key, std::vector<float> fallback) const {
  const Json* list = findList(key);
  if (list == nullptr) return fallback;
  const std::string allowed = "a list of " + std::to_string(fallback.size()) + " numbers";
  if (list->size() != fallback.size()) refuse(key, allowed);
  for (std::size_t i = 0; i < fallback.size(); ++i) {
    if (!(*list)[i].is_number()) refuse(key, allowed);
    fallback[i] = (*list)[i].get<float>();
  }
  return fallback;
}

std::size_t GltfItem::index(const char* key, const char* list, std::size_t size, std::optional<std::size_t> fallback) const {
  const Json* value = find(key);
  if (value == nullptr && fallback && *fallback < size) return *fallback;
  if (value == nullptr || !isIndex(*value, size)) refuse(key, indexBelow(list, size));
  return value->get<std::size_t>();
}

std::vector<std::size_t> GltfItem::indices(const char* key, const char* list, std::size_t size) const {
  const Json* values = findList(key);
  std::vector<std::size_t> indices(values == nullptr ? 0 : values->size());
  for (std::size_t i = 0; i < indices.size(); ++i) {
    const Json& value = (*values)[i];
    if (!isIndex(value, size)) refuseValue(pathOf(key) + "[" + std::to_string(i) + "]", value, indexBelow(list, size));
    indices[i] = value.get<std::size_t>();
  }
  return indices;
}

std::size_t GltfItem::size(const char* list) const {
  const Json* values = findList(list);
  return values == nullptr ? 0 : values->size();
}

std::vector<std::string> GltfItem::texts(const char* list) const {
  std::vector<std::string> texts;
  const Json* values = findList(list);
  for (std::size_t i = 0; values != nullptr && i < values->size(); ++i) {
    if (!(*values)[i].is_string()) refuseValue(pathOf(list) + "[" + std::to_string(i) + "]", (*values)[i], "a text");
    texts.push_back((*values)[i].get<std::string>());
  }
  return texts;
}

GltfItem GltfItem::entry(const char* list, std::size_t i) const {
  return GltfItem((*findList(list))[i], pathOf(list) + "[" + std::to_string(i) + "]");
}

GltfItem GltfItem::object(const char* key) const {
  const Json* value = find(key);
  if (value == nullptr) refuse(key, "an object");
  return GltfItem(*value, pathOf(key));
}

std::vector<std::string> GltfItem::keys() const {
  std::vector<std::string> keys;
  for (const auto& [key, value] : value_->items()) keys.push_back(key);
  return keys;
}

}  // namespace taxelsim
