// Tables of fields: one table per settings struct, an array of Field, states key, member, unit and allowed range of each setting once.
// Checks (base/field_checks.h), readers and writers of files (scene/) use the tables. Settings that depend on each other, lists of any
// length and choices are not in them.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <string_view>
#include <variant>

#include "base/allowed.h"

namespace taxelsim {

// What a missing key means in a file.
enum class Presence {
  kOptional,   // the struct's default
  kRequired,   // an error
  kUnlimited,  // no limit: the member is +infinity, which cannot be written in a file
};
inline constexpr Presence kOptional = Presence::kOptional;
inline constexpr Presence kRequired = Presence::kRequired;
inline constexpr Presence kUnlimited = Presence::kUnlimited;

// A setting of any type that a field can have.
template <template <typename> typename Reference>
using AnySetting = std::variant<Reference<double>, Reference<int>, Reference<std::uint64_t>, Reference<std::optional<double>>,
                                Reference<std::array<double, 2>>, Reference<std::array<double, 3>>>;
template <typename Value>
using Pointer = Value*;
template <typename Value>
using ConstPointer = const Value*;
using SettingPointer = AnySetting<Pointer>;
using ConstSettingPointer = AnySetting<ConstPointer>;

template <typename Settings>
struct Field {
  template <typename Value>
  using Member = Value Settings::*;

  std::string_view key;  // in files, the member's name; "[_mm]" or "[_deg]" after it if the file may give millimetres or degrees
  AnySetting<Member> member;
  Allowed allowed;  // of each element of an array
  Presence presence = Presence::kOptional;
  std::string_view text = "";  // meaning, for documentation

  constexpr std::string_view name() const { return key.substr(0, key.find('[')); }

  SettingPointer in(Settings& settings) const {
    return std::visit([&](auto pointer) { return SettingPointer(&(settings.*pointer)); }, member);
  }
  ConstSettingPointer in(const Settings& settings) const {
    return std::visit([&](auto pointer) { return ConstSettingPointer(&(settings.*pointer)); }, member);
  }
};

}  // namespace taxelsim
