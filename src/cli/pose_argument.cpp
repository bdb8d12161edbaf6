#include "cli/pose_argument.h"

#include <spdlog/fmt/fmt.h>

#include <charconv>
#include <cmath>
#include <numbers>
#include <vector>

#include "base/constants.h"
#include "taxelsim/error.h"

namespace taxelsim::cli {
namespace {

constexpr double kFullTurn = 360;  // degrees

// The numbers of one argument. `what`: the forms that are allowed, for messages.
struct Argument {
  const char* option;
  const std::string& text;
  const char* what;

  Error refuse(const std::string& why) const { return Error(ErrorKind::kInput, fmt::format("{} \"{}\": {}; {}", option, text, why, what)); }

  std::vector<double> numbers(std::size_t most) const {
    const auto isSeparator = [](char c) { return c == ' ' || c == ',' || c == '\t'; };
    std::vector<double> numbers;
    const char* place = text.data();
    const char* const end = text.data() + text.size();
    while (true) {
      while (place != end && isSeparator(*place)) ++place;
      if (place == end) return numbers;
      if (numbers.size() == most) throw refuse(fmt::format("has more than {} numbers", most));
      double number = 0;
      const auto [next, problem] = std::from_chars(*place == '+' ? place + 1 : place, end, number);
      if (problem != std::errc() || (next != end && !isSeparator(*next)) || !std::isfinite(number)) {
        throw refuse(fmt::format("number {} cannot be read", numbers.size() + 1));
      }
      numbers.push_back(number);
      place = next;
    }
  }
};

}  // namespace

PoseArgument parsePose(const std::string& text) {
  const Argument argument{"--pose", text, "a pose is \"x y z\" or \"x y z qw qx qy qz\", m and a unit quaternion"};
  const std::vector<double> n = argument.numbers(7);
  if (n.size() != 3 && n.size() != 7) throw argument.refuse(fmt::format("has {} numbers, not 3 or 7", n.size()));
  PoseArgument pose{.position = {n[0], n[1], n[2]}, .rotation = {}};
  if (n.size() == 3) return pose;
  const double norm = std::sqrt(n[3] * n[3] + n[4] * n[4] + n[5] * n[5] + n[6] * n[6]);
  if (!(std::abs(norm - 1) <= kQuaternionTolerance)) {
    throw argument.refuse(fmt::format("the quaternion has length {:.6g}, not 1 within 1e-3", norm));
  }
  pose.rotation = {n[3] / norm, n[4] / norm, n[5] / norm, n[6] / norm};
  return pose;
}

Quaternion parseRollPitchYaw(const std::string& text) {
  const Argument argument{"--rpy-deg", text, "it is \"roll pitch yaw\", degrees"};
  const std::vector<double> degrees = argument.numbers(3);
  if (degrees.size() != 3) throw argument.refuse(fmt::format("has {} numbers, not 3", degrees.size()));
  for (const double angle : degrees) {
    if (!(std::abs(angle) <= kFullTurn)) throw argument.refuse(fmt::format("{:g} is not allowed: from -360 to 360", angle));
  }
  return axisAngle({0, 0, 1}, degrees[2] * kRadPerDegree) * axisAngle({0, 1, 0}, degrees[1] * kRadPerDegree) *
         axisAngle({1, 0, 0}, degrees[0] * kRadPerDegree);
}

Vector3 parseSlide(const std::string& text) {
  const Argument argument{"--slide", text, "it is \"x y\", m in the sensor frame"};
  const std::vector<double> n = argument.numbers(2);
  if (n.size() != 2) throw argument.refuse(fmt::format("has {} numbers, not 2", n.size()));
  return {n[0], n[1], 0};
}

}  // namespace taxelsim::cli
