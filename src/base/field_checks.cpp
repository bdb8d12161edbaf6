#include "base/field_checks.h"

#include <cmath>
#include <cstdint>

namespace taxelsim {
namespace {

void checkWhole(const std::string& field, std::uint64_t value, const Allowed& allowed) {
  if (value < minWhole(allowed) || value > maxWhole(allowed)) failField(field, std::to_string(value), describeWhole(allowed));
}

// Calls the overload for the type of a setting.
struct SettingChecker {
  const std::string& field;
  const Allowed& allowed;
  Presence presence;

  void operator()(const double* value) const {
    const bool is_unlimited = presence == Presence::kUnlimited && std::isinf(*value) && *value > 0;
    if (!is_unlimited) checkNumber(field, *value, allowed);
  }
  void operator()(const int* value) const {
    if (*value < 0) failField(field, std::to_string(*value), describeWhole(allowed));
    checkWhole(field, static_cast<std::uint64_t>(*value), allowed);
  }
  void operator()(const std::uint64_t* value) const { checkWhole(field, *value, allowed); }
  void operator()(const std::optional<double>* value) const {
    if (*value) checkNumber(field, **value, allowed);
  }
  template <std::size_t N>
  void operator()(const std::array<double, N>* values) const {
    for (std::size_t i = 0; i < N; ++i) checkNumber(elementOf(field, i), (*values)[i], allowed);
  }
};

}  // namespace

void failField(const std::string& field, const std::string& value, const std::string& allowed) {
  throw Error(field, value + " is not allowed: " + allowed);
}

std::string elementOf(const std::string& field, std::size_t index) {
  return field + "[" + std::to_string(index) + "]";
}

void checkNumber(const std::string& field, double value, const Allowed& allowed) {
  if (!isAllowed(value, allowed)) failField(field, numberText(value), describe(allowed));
}

void checkSetting(const std::string& field, const ConstSettingPointer& setting, const Allowed& allowed, Presence presence) {
  std::visit(SettingChecker{field, allowed, presence}, setting);
}

}  // namespace taxelsim
