// Checks of settings structs by their tables of fields. Each throws Error with the path of the field, its value and what is allowed.
#pragma once

#include <cstddef>
#include <span>
#include <string>
#include <type_traits>

#include "base/field.h"
#include "base/text.h"
#include "taxelsim/error.h"

namespace taxelsim {

// Throws Error(field, "value is not allowed: allowed").
[[noreturn]] void failField(const std::string& field, const std::string& value, const std::string& allowed);

// "field[index]".
std::string elementOf(const std::string& field, std::size_t index);

void checkNumber(const std::string& field, double value, const Allowed& allowed);
void checkSetting(const std::string& field, const ConstSettingPointer& setting, const Allowed& allowed, Presence presence);

// Checks the fields in `table`; `prefix`: path of the struct, "skin.".
template <typename Settings>
void checkFields(const std::string& prefix, std::span<const Field<std::type_identity_t<Settings>>> table, const Settings& settings) {
  for (const Field<Settings>& field : table) {
    checkSetting(prefix + std::string(field.name()), field.in(settings), field.allowed, field.presence);
  }
}

// Runs `check` of a struct at `path` and prepends that path to the field of an Error: "sensor" and "skin.thickness".
template <typename Function>
void checkBelow(const std::string& path, Function check) {
  try {
    check();
  } catch (const Error& error) {
    throw Error(path + (error.field().empty() ? "" : ".") + error.field(), error.reason());
  }
}

}  // namespace taxelsim
