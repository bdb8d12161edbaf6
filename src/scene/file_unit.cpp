#include "scene/file_unit.h"

#include <cmath>
#include <numbers>

namespace taxelsim {
namespace {

constexpr double kDegreesPerRadian = 180 / std::numbers::pi;

std::string unitName(std::string_view si, FileUnit unit) {
  if (unit == FileUnit::kMilli) return "m" + std::string(si);                                            // m, m/s
  if (unit == FileUnit::kDegree) return "deg" + std::string(si.substr(std::string_view("rad").size()));  // rad, rad/s
  return std::string(si);
}

}  // namespace

FileUnit unitOfSuffix(std::string_view suffix) {
  return suffix == "_mm" ? FileUnit::kMilli : suffix == "_deg" ? FileUnit::kDegree : FileUnit::kSi;
}

double inUnit(double value, FileUnit unit) {
  switch (unit) {
    case FileUnit::kMilli:
      return value * 1000;
    case FileUnit::kDegree:
      return std::isfinite(value) ? std::round(value * kDegreesPerRadian * 1e9) / 1e9 : value;
    case FileUnit::kSi:
      break;
  }
  return value;
}

Allowed inUnit(const Allowed& allowed, FileUnit unit, std::string& name) {
  name = unitName(allowed.unit, unit);
  Allowed result = allowed;
  result.min = inUnit(allowed.min, unit);
  result.max = inUnit(allowed.max, unit);
  result.unit = name;
  return result;
}

}  // namespace taxelsim
