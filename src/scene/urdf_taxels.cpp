#include "scene/urdf_taxels.h"

#include <charconv>
#include <cmath>
#include <map>
#include <numbers>
#include <optional>
#include <sstream>

#include "base/text.h"
#include "base/xml_file.h"
#include "taxelsim/error.h"

namespace taxelsim {
namespace {

using tinyxml2::XMLElement;

// Limits of numbers as in YAML files: the device computes in float32.
constexpr double kLargestNumber = 1e30;

// The file being read; its name is in messages.
class Urdf {
 public:
  Urdf(const std::filesystem::path& file, int max_taxels) : file_(file, kMaxUrdfBytes), max_taxels_(max_taxels) {}

  std::vector<GridPatch> taxelsOf(const std::string& sensor) const;
  SensorMount mountOf(const std::string& sensor) const;

 private:
  [[noreturn]] void fail(int line, const std::string& what) const { file_.fail(line, what); }
  [[noreturn]] void fail(const XMLElement& element, const std::string& what) const {
    fail(element.GetLineNum(), "<" + std::string(element.Name()) + "> " + what);
  }
  [[noreturn]] void refuse(const XMLElement& element, const char* attribute, const std::string& allowed) const {
    std::string value = element.Attribute(attribute);
    if (value.size() > kMaxShown) value = value.substr(0, kMaxShown) + "...";
    fail(element, std::string(attribute) + ": \"" + value + "\" is not allowed: " + allowed);
  }

  // `count` numbers separated by blanks; none if the attribute is missing.
  std::optional<std::vector<double>> numbers(const XMLElement& element, const char* attribute, std::size_t count) const;
  Pose poseOf(const XMLElement& element) const;  // of its xyz and rpy, 0 by default
  int whole(const XMLElement& element, const char* attribute, int min, int max) const;
  const XMLElement& tactileOf(const std::string& sensor) const;
  std::vector<GridPatch> arrayOf(const XMLElement& array) const;
  std::vector<GridPatch> listOf(const XMLElement& tactile) const;
  std::array<double, 2> sizeOf(const XMLElement& taxel) const;

  XmlFile file_;
  int max_taxels_;
};

std::optional<std::vector<double>> Urdf::numbers(const XMLElement& element, const char* attribute, std::size_t count) const {
  const char* text = element.Attribute(attribute);
  if (text == nullptr) return {};
  std::vector<double> result;
  bool good = true;
  std::istringstream words(text);
  for (std::string word; words >> word;) {
    double value = 0;
    good = good && parseNumber(word, value) && std::abs(value) <= kLargestNumber;
    result.push_back(value);
    if (result.size() > count) break;
  }
  if (!good || result.size() != count) refuse(element, attribute, std::to_string(count) + " numbers between blanks");
  return result;
}

Pose Urdf::poseOf(const XMLElement& element) const {
  const std::vector<double> xyz = numbers(element, "xyz", 3).value_or(std::vector<double>{0, 0, 0});
  const std::vector<double> rpy = numbers(element, "rpy", 3).value_or(std::vector<double>{0, 0, 0});
  return {{xyz[0], xyz[1], xyz[2]}, axisAngle({0, 0, 1}, rpy[2]) * axisAngle({0, 1, 0}, rpy[1]) * axisAngle({1, 0, 0}, rpy[0])};
}

int Urdf::whole(const XMLElement& element, const char* attribute, int min, int max) const {
  const char* text = element.Attribute(attribute);
  const std::string allowed = "a whole number from " + std::to_string(min) + " to " + std::to_string(max);
  if (text == nullptr) fail(element, std::string(attribute) + " is missing: " + allowed);
  const std::string_view digits(text);
  int value = 0;
  const auto [end, problem] = std::from_chars(digits.data(), digits.data() + digits.size(), value);
  if (problem != std::errc{} || end != digits.data() + digits.size() || value < min || value > max) refuse(element, attribute, allowed);
  return value;
}

const XMLElement& Urdf::tactileOf(const std::string& sensor) const {
  const XMLElement* robot = file_.root();
  if (robot == nullptr || std::string_view(robot->Name()) != "robot") fail(1, "is not a URDF: no <robot>");
  const XMLElement* found = nullptr;
  std::string others;
  for (const XMLElement* element = robot->FirstChildElement("sensor"); element != nullptr;
       element = element->NextSiblingElement("sensor")) {
    const XMLElement* tactile = element->FirstChildElement("tactile");
    const char* name = element->Attribute("name");
    if (tactile == nullptr || name == nullptr) continue;
    if (name == sensor) {
      if (found != nullptr) fail(*element, "a second tactile sensor of the name " + sensor);
      found = tactile;
    } else if (others.size() < 200) {
      others += (others.empty() ? "" : ", ") + std::string(name);
    }
  }
  if (found == nullptr) {
    fail(*robot, "has no tactile sensor " + sensor + (others.empty() ? ", and no other either" : "; it has " + others));
  }
  return *found;
}

std::vector<GridPatch> Urdf::arrayOf(const XMLElement& array) const {
  const int rows = whole(array, "rows", 1, max_taxels_), cols = whole(array, "cols", 1, max_taxels_);
  const std::optional<std::vector<double>> size = numbers(array, "size", 2);
  if (!size) fail(array, "size is missing: two lengths > 0 m");
  const std::vector<double> spacing = numbers(array, "spacing", 2).value_or(*size);
  const std::vector<double> offset = numbers(array, "offset", 2).value_or(std::vector<double>{0, 0});
  bool is_grid = true;
  for (std::size_t axis = 0; axis < 2; ++axis) {
    if (!((*size)[axis] > 0)) refuse(array, "size", "two lengths > 0 m");
    if (std::abs(spacing[axis]) < (*size)[axis]) {
      if (array.Attribute("spacing") == nullptr) refuse(array, "size", "two lengths > 0 m");
      refuse(array, "spacing", "at least the size: taxels may not overlap");
    }
    is_grid = is_grid && spacing[axis] == (*size)[axis];
  }
  const char* order = array.Attribute("order");
  // The package's documentation writes column-major, its parser col-major.
  const bool by_cols = order != nullptr && (std::string_view(order) == "column-major" || std::string_view(order) == "col-major");
  if (order != nullptr && !by_cols && std::string_view(order) != "row-major")
    refuse(array, "order", "row-major, column-major or col-major");

  if (is_grid && !by_cols && rows <= kMaxTaxelsPerSide && cols <= kMaxTaxelsPerSide) {
    const Vector3 middle{0.5 * (rows - 1) * spacing[0] - offset[0], 0.5 * (cols - 1) * spacing[1] - offset[1], 0};
    return {{.name = "array", .num_rows = rows, .num_cols = cols, .pitch = {spacing[0], spacing[1]}, .X_SP = {middle, {1, 0, 0, 0}}}};
  }
  if (static_cast<long long>(rows) * cols > max_taxels_) {
    fail(array, std::to_string(rows) + " x " + std::to_string(cols) + " taxels are not allowed: at most " + std::to_string(max_taxels_));
  }
  std::vector<GridPatch> taxels;
  for (int t = 0; t < rows * cols; ++t) {
    const int i = by_cols ? t % rows : t / cols, j = by_cols ? t / rows : t % cols;
    const Vector3 position{i * spacing[0] - offset[0], j * spacing[1] - offset[1], 0};
    taxels.push_back(taxelPatch("taxel_" + std::to_string(t), position, {0, 0, 1}, {(*size)[0], (*size)[1]}));
  }
  return taxels;
}

std::array<double, 2> Urdf::sizeOf(const XMLElement& taxel) const {
  const XMLElement* geometry = taxel.FirstChildElement("geometry");
  const XMLElement* shape = geometry == nullptr ? nullptr : geometry->FirstChildElement();
  if (shape == nullptr) fail(taxel, "has no geometry: a box, cylinder or sphere says how large a taxel is");
  const std::string_view kind = shape->Name();
  if (kind == "box") {
    const std::optional<std::vector<double>> size = numbers(*shape, "size", 3);
    if (!size) fail(*shape, "size is missing: three lengths in m");
    if (!((*size)[0] > 0 && (*size)[1] > 0)) refuse(*shape, "size", "lengths > 0 m along x and y");
    return {(*size)[0], (*size)[1]};
  }
  if (kind == "cylinder" || kind == "sphere") {
    const std::optional<std::vector<double>> radius = numbers(*shape, "radius", 1);
    if (!radius) fail(*shape, "radius is missing: a number > 0 m");
    if (!(radius->front() > 0)) refuse(*shape, "radius", "a number > 0 m");
    const double side = radius->front() * std::sqrt(std::numbers::pi);
    return {side, side};
  }
  fail(*shape, "is no geometry that says how large a taxel is: box, cylinder or sphere");
}

std::vector<GridPatch> Urdf::listOf(const XMLElement& tactile) const {
  std::map<int, GridPatch> by_index;
  const XMLElement* last = nullptr;
  for (const XMLElement* taxel = tactile.FirstChildElement("taxel"); taxel != nullptr; taxel = taxel->NextSiblingElement("taxel")) {
    last = taxel;
    const int index = whole(*taxel, "idx", 0, max_taxels_ - 1);
    const Pose X_SP = poseOf(*taxel);
    GridPatch patch{.name = "taxel_" + std::to_string(index), .num_rows = 1, .num_cols = 1, .pitch = sizeOf(*taxel), .X_SP = X_SP};
    if (!by_index.emplace(index, std::move(patch)).second) fail(*taxel, "idx: an earlier taxel has " + std::to_string(index));
  }
  std::vector<GridPatch> taxels;
  for (auto& [index, patch] : by_index) {
    if (index != static_cast<int>(taxels.size())) {
      fail(*last, "no taxel has idx " + std::to_string(taxels.size()) + ", but one has " + std::to_string(index));
    }
    taxels.push_back(std::move(patch));
  }
  return taxels;
}

std::vector<GridPatch> Urdf::taxelsOf(const std::string& sensor) const {
  const XMLElement& tactile = tactileOf(sensor);
  const XMLElement* array = tactile.FirstChildElement("array");
  std::vector<GridPatch> taxels = listOf(tactile);
  if (array == nullptr && taxels.empty()) fail(tactile, "has neither an <array> nor a <taxel>");
  if (array == nullptr) return taxels;
  if (!taxels.empty()) fail(*array, "conflicts with <taxel>: give only one of them");
  if (array->NextSiblingElement("array") != nullptr) fail(*array->NextSiblingElement("array"), "is the second one: a sensor has one");
  return arrayOf(*array);
}

SensorMount Urdf::mountOf(const std::string& sensor) const {
  const XMLElement& element = *tactileOf(sensor).Parent()->ToElement();
  const XMLElement* parent = element.FirstChildElement("parent");
  const char* link = parent == nullptr ? nullptr : parent->Attribute("link");
  if (link == nullptr) fail(element, sensor + " has no <parent link>");
  const XMLElement* origin = element.FirstChildElement("origin");
  return {.link = link, .X_LS = origin == nullptr ? Pose{} : poseOf(*origin)};
}

}  // namespace

std::vector<GridPatch> loadUrdfTaxels(const std::filesystem::path& file, const std::string& name, int max_taxels) {
  return Urdf(file, max_taxels).taxelsOf(name);
}

SensorMount loadUrdfMount(const std::filesystem::path& file, const std::string& name) {
  return Urdf(file, kMaxTaxels).mountOf(name);
}

}  // namespace taxelsim
