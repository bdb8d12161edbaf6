#include "scene/pose_reader.h"

#include <cmath>
#include <limits>

#include "scene/keys/sensor.h"

namespace taxelsim {
namespace {

// Already normalized; a second division would change the last bit.
constexpr double kNormalised = 4 * std::numeric_limits<double>::epsilon();

// The canonical text keeps given roll, pitch and yaw, because sine and cosine may differ in the last bit between machines.
Quaternion rotationOf(const YamlMap& map) {
  const std::optional<YamlNode> given = map.find("rotation");
  if (map.has("rpy")) {
    if (given) given->fail("given twice, as rotation and rpy");
    const std::array<double, 3> rpy = map.numbers<3>("rpy");
    return axisAngle({0, 0, 1}, rpy[2]) * axisAngle({0, 1, 0}, rpy[1]) * axisAngle({1, 0, 0}, rpy[0]);
  }
  Quaternion rotation{1, 0, 0, 0};
  if (given) {
    const std::vector<double> numbers = given->numbers(map.allowedOf("rotation"), rotation.size());
    std::copy(numbers.begin(), numbers.end(), rotation.begin());
    double square = 0;
    for (const double q : rotation) square += q * q;
    const double length = std::sqrt(square);
    if (std::abs(length - 1) > kUnitTolerance) {
      given->fail("length " + canonicalNumber(length) + " is not allowed: a unit quaternion [w, x, y, z]");
    }
    if (std::abs(square - 1) > kNormalised) {
      for (double& q : rotation) q /= length;
    }
  }
  map.canonical().line("rotation", canonicalList(rotation));
  return rotation;
}

}  // namespace

Pose readPose(const YamlMap& parent, std::string_view key) {
  const YamlMap map(parent, key, poseKeys());
  Pose pose;
  pose.position = map.numbers<3>("position", map.allowedOf("position"), Vector3{0, 0, 0});
  pose.rotation = rotationOf(map);
  return pose;
}

Quaternion readRotation(const YamlMap& parent, std::string_view key) {
  return rotationOf(YamlMap(parent, key, rotationKeys()));
}

}  // namespace taxelsim
