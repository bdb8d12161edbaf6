#include <array>
#include <cmath>
#include <fstream>
#include <string>
#include <string_view>

#include "geometry/text.h"
#include "taxelsim/error.h"
#include "taxelsim/scene.h"

namespace taxelsim {
namespace {

constexpr std::array<std::string_view, 8> kColumns = {"time_s", "x_m", "y_m", "z_m", "qw", "qx", "qy", "qz"};
constexpr std::string_view kHeading = "time_s,x_m,y_m,z_m,qw,qx,qy,qz";
constexpr std::size_t kMaxWaypoints = 1'000'000;
constexpr std::size_t kMaxShown = 40;    // bytes of a value that a message repeats
constexpr double kLargest = 1e6;         // s and m
constexpr double kUnitTolerance = 1e-3;  // a quaternion written with four digits is of unit length within this
constexpr std::string_view kBlanks = " \t\r";

std::string_view trimmed(std::string_view text) {
  const std::size_t first = text.find_first_not_of(kBlanks);
  return first == std::string_view::npos ? std::string_view{} : text.substr(first, text.find_last_not_of(kBlanks) - first + 1);
}

// One line of the file, and where it stands for messages.
class Row {
 public:
  Row(const std::string& file, std::size_t number, std::string_view text) : file_(file), number_(number), text_(text) {}

  // `begin` counts bytes from 0.
  [[noreturn]] void fail(std::size_t begin, const std::string& what) const {
    throw Error(ErrorKind::kInput, oneLine(file_ + ":" + std::to_string(number_) + ":" + std::to_string(begin + 1) + ": " + what));
  }

  std::array<double, kColumns.size()> numbers() const;

 private:
  const std::string& file_;
  std::size_t number_;
  std::string_view text_;
};

std::array<double, kColumns.size()> Row::numbers() const {
  std::array<double, kColumns.size()> numbers{};
  std::size_t begin = 0;
  for (std::size_t column = 0; column < kColumns.size(); ++column) {
    if (begin > text_.size()) fail(text_.size(), std::string(kColumns[column]) + " is missing: " + std::string(kHeading));
    const std::size_t end = std::min(text_.find(',', begin), text_.size());
    const std::string_view word = trimmed(text_.substr(begin, end - begin));
    const double largest = column < 4 ? kLargest : 1 + kUnitTolerance;
    if (!parseNumber(word, numbers[column]) || std::abs(numbers[column]) > largest) {
      fail(begin, std::string(kColumns[column]) + ": \"" + std::string(word.substr(0, kMaxShown)) + "\" is not allowed: a number from -" +
                      numberText(largest) + " to " + numberText(largest));
    }
    begin = end + 1;
  }
  if (begin <= text_.size()) fail(begin, "a value more than " + std::string(kHeading));
  return numbers;
}

Waypoint waypointOf(const Row& row) {
  const auto [time, x, y, z, qw, qx, qy, qz] = row.numbers();
  const double norm = std::sqrt(qw * qw + qx * qx + qy * qy + qz * qz);
  if (std::abs(norm - 1) > kUnitTolerance) row.fail(0, "qw,qx,qy,qz: length " + numberText(norm) + " is not allowed: a unit quaternion");
  return {time, {{x, y, z}, {qw / norm, qx / norm, qy / norm, qz / norm}}};
}

// As written, but for blanks around the commas.
bool isHeading(std::string_view text) {
  std::string bare;
  for (const char c : text) {
    if (kBlanks.find(c) == std::string_view::npos) bare += c;
  }
  return bare == kHeading;
}

}  // namespace

std::vector<Waypoint> loadWaypoints(const std::filesystem::path& file) {
  const std::string name = file.generic_string();
  std::error_code error;
  if (!std::filesystem::is_regular_file(file, error)) throw Error(ErrorKind::kInput, oneLine(name + ": is not there, or not a file"));
  std::ifstream stream(file, std::ios::binary);
  if (!stream) throw Error(ErrorKind::kInput, oneLine(name + ": cannot be read"));

  std::vector<Waypoint> points;
  bool has_heading = false;
  std::string line;
  std::size_t number = 0;
  while (std::getline(stream, line)) {
    const std::string_view text = std::string_view(line).substr(0, line.find('#'));
    const Row row(name, ++number, text);
    if (trimmed(text).empty()) continue;
    if (!has_heading) {
      if (!isHeading(text)) row.fail(0, "the heading is missing: " + std::string(kHeading));
      has_heading = true;
      continue;
    }
    if (points.size() == kMaxWaypoints) row.fail(0, "more than " + std::to_string(kMaxWaypoints) + " waypoints");
    const Waypoint point = waypointOf(row);
    if (!points.empty() && point.time <= points.back().time) {
      row.fail(
          0, "time_s: " + numberText(point.time) + " is not allowed: later than the line before (" + numberText(points.back().time) + ")");
    }
    points.push_back(point);
  }
  if (points.empty()) Row(name, number + 1, "").fail(0, "no waypoint: " + std::string(kHeading) + ", then at least one line");
  return points;
}

}  // namespace taxelsim
