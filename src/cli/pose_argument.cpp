#include "cli/pose_argument.h"

#include <spdlog/fmt/fmt.h>

#include <array>
#include <charconv>
#include <cmath>

#include "taxelsim/error.h"

namespace taxelsim::cli {
namespace {

constexpr double kQuaternionTolerance = 1e-3;  // as in Simulator::setObjects()

}  // namespace

Pose parsePose(const std::string& text) {
  const auto refuse = [&](const std::string& why) -> Error {
    return Error(ErrorKind::kInput, "--pose \"" + text + "\": " + why + "; a pose is \"x y z qw qx qy qz\", m and a unit quaternion");
  };
  std::array<double, 7> numbers{};
  std::size_t count = 0;
  const char* place = text.data();
  const char* const end = text.data() + text.size();
  while (true) {
    while (place != end && (*place == ' ' || *place == ',' || *place == '\t')) ++place;
    if (place == end) break;
    if (count == numbers.size()) throw refuse("has more than 7 numbers");
    const auto [next, problem] = std::from_chars(*place == '+' ? place + 1 : place, end, numbers[count]);
    const bool whole_word = next == end || *next == ' ' || *next == ',' || *next == '\t';
    if (problem != std::errc() || !whole_word || !std::isfinite(numbers[count]))
      throw refuse(fmt::format("number {} cannot be read", count + 1));
    place = next;
    ++count;
  }
  if (count != numbers.size()) throw refuse(fmt::format("has {} numbers, not 7", count));
  const double norm = std::sqrt(numbers[3] * numbers[3] + numbers[4] * numbers[4] + numbers[5] * numbers[5] + numbers[6] * numbers[6]);
  if (!(std::abs(norm - 1) <= kQuaternionTolerance)) throw refuse(fmt::format("the quaternion has length {:.6g}, not 1 within 1e-3", norm));
  return {{numbers[0], numbers[1], numbers[2]}, {numbers[3] / norm, numbers[4] / norm, numbers[5] / norm, numbers[6] / norm}};
}

}  // namespace taxelsim::cli
