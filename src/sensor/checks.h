// The parts of checkSensor(). Each throws Error with the path of the field, its value and what is allowed.
#pragma once

#include <cstddef>
#include <string>

#include "base/text.h"
#include "sensor/fields.h"
#include "taxelsim/error.h"
#include "taxelsim/sensor.h"

namespace taxelsim {

// Throws Error(field, "value is not allowed: allowed").
[[noreturn]] void failField(const std::string& field, const std::string& value, const std::string& allowed);

// "field[index]".
std::string elementOf(const std::string& field, std::size_t index);

void checkNumber(const std::string& field, double value, const Allowed& allowed);

// Checks the fields in `table`; `prefix`: path of the struct, "skin.".
template <typename Table, typename Settings>
void checkFields(const std::string& prefix, const Table& table, const Settings& settings) {
  for (const Field<Settings>& field : table) {
    const std::string path = prefix + std::string(field.name());
    if (const auto* whole = std::get_if<int Settings::*>(&field.member)) {
      const int value = settings.**whole;
      if (!isAllowed(value, field.allowed)) failField(path, std::to_string(value), describeWhole(field.allowed));
    } else {
      checkNumber(path, settings.*std::get<double Settings::*>(field.member), field.allowed);
    }
  }
}

void checkSkin(const Skin& skin);
void checkLayer(const Sensor& sensor);
void checkPsf(const Sensor& sensor);
void checkReadout(const Sensor& sensor);

// Sum of the weights of a kernel.
double kernelSum(const Psf& psf);

}  // namespace taxelsim
