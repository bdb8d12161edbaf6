#include "scene/motion_reader.h"

#include "control/motion_fields.h"
#include "scene/hashed_file.h"
#include "taxelsim/scene.h"

namespace taxelsim {
namespace {

constexpr std::string_view kMotionKinds = "constant_twist | sinusoid | waypoints | hand_held";
constexpr std::uintmax_t kMaxWaypointBytes = std::uintmax_t{64} << 20;

Motion readConstantTwist(const YamlMap& parent) {
  ConstantTwist motion;
  readFields(YamlMap(parent, "constant_twist", keysOf(kConstantTwistFields)), kConstantTwistFields, motion.twist);
  return motion;
}

Motion readSinusoid(const YamlMap& parent) {
  const YamlMap map(parent, "sinusoid", keysOf(kSinusoidFields));
  if (!map.has("amplitude") && !map.has("angle")) {
    map.node().fail("amplitude[_mm] or angle[_deg] is missing: the amplitude along the axis, or the angle about it");
  }
  Sinusoid motion;
  readFields(map, kSinusoidFields, motion);
  return motion;
}

Motion readWaypoints(const YamlMap& parent, const std::filesystem::path& directory) {
  const YamlMap map(parent, "waypoints", {"file", "interpolation", "sha256"});
  const std::filesystem::path file = readHashedFile(map, "file", "a CSV file of waypoints", directory, kMaxWaypointBytes);
  Waypoints motion;
  const bool is_cubic = map.choice("interpolation", {"cubic", "linear"}, "cubic") == "cubic";
  motion.interpolation = is_cubic ? Waypoints::Interpolation::kCubic : Waypoints::Interpolation::kLinear;
  motion.points = atNode(map.require("file", ""), [&] { return loadWaypoints(file); });
  return motion;
}

Motion readHandHeld(const YamlMap& parent) {
  HandHeld motion;
  readFields(YamlMap(parent, "hand_held", keysOf(kHandHeldFields)), kHandHeldFields, motion);
  return motion;
}

}  // namespace

std::optional<Motion> readMotion(const YamlMap& object, const std::filesystem::path& directory) {
  const std::optional<YamlNode> node = object.find("motion");
  if (!node) return {};
  const YamlMap map(object, "motion", {"constant_twist", "sinusoid", "waypoints", "hand_held"});
  int num_kinds = 0;
  for (const std::string_view kind : {"constant_twist", "sinusoid", "waypoints", "hand_held"}) num_kinds += map.has(kind) ? 1 : 0;
  if (num_kinds != 1) node->fail("exactly one of " + std::string(kMotionKinds));
  const Motion motion = map.has("constant_twist") ? readConstantTwist(map)
                        : map.has("sinusoid")     ? readSinusoid(map)
                        : map.has("waypoints")    ? readWaypoints(map, directory)
                                                  : readHandHeld(map);
  atNode(*node, [&] { checkMotion(motion); });
  return motion;
}

}  // namespace taxelsim
