// Reading of one field of a settings struct: readSetting() of yaml_reader.h.
#include "scene/yaml_reader.h"

namespace taxelsim {
namespace {

// Calls the overload for the type of a setting.
struct SettingReader {
  const YamlMap& map;
  std::string_view key;
  const Allowed& allowed;
  Presence presence;

  template <typename Value>
  std::optional<Value> otherwise(const Value& value) const {
    return presence == Presence::kRequired ? std::nullopt : std::optional(value);
  }
  void operator()(double* value) const {
    if (presence != Presence::kUnlimited || map.has(key)) *value = map.number(key, allowed, otherwise(*value));
  }
  void operator()(std::optional<double>* value) const {
    if (*value || map.has(key)) *value = map.number(key, allowed, *value);
  }
  void operator()(std::uint64_t* value) const { *value = map.integer(key, minWhole(allowed), maxWhole(allowed), otherwise(*value)); }
  void operator()(int* value) const {
    auto whole = static_cast<std::uint64_t>(*value);
    (*this)(&whole);
    *value = static_cast<int>(whole);
  }
  template <std::size_t N>
  void operator()(std::array<double, N>* values) const {
    *values = map.numbers<N>(key, allowed, otherwise(*values));
  }
};

}  // namespace

void readSetting(const YamlMap& map, std::string_view key, const SettingPointer& setting, const Allowed& allowed, Presence presence) {
  std::visit(SettingReader{map, key, allowed, presence}, setting);
}

}  // namespace taxelsim
