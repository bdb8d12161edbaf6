#include "scene/motion_reader.h"

#include "control/motion_fields.h"
#include "scene/hashed_file.h"
#include "taxelsim/scene.h"

namespace taxelsim {
namespace {

constexpr std::uintmax_t kMaxWaypointBytes = std::uintmax_t{64} << 20;

Motion readConstantTwist(const YamlMap& parent) {
  ConstantTwist motion;
  readFields(YamlMap(parent, "constant_twist"), kConstantTwistFields, motion.twist);
  return motion;
}

Motion readSinusoid(const YamlMap& parent) {
  const YamlMap map(parent, "sinusoid");
  if (!map.has("amplitude") && !map.has("angle")) {
    map.node().fail("amplitude[_mm] or angle[_deg] is missing: the amplitude along the axis, or the angle about it");
  }
  Sinusoid motion;
  readFields(map, kSinusoidFields, motion);
  return motion;
}

Motion readWaypoints(const YamlMap& parent, const std::filesystem::path& directory) {
  const YamlMap map(parent, "waypoints");
  const std::filesystem::path file = readHashedFile(map, "file", directory, kMaxWaypointBytes);
  Waypoints motion;
  motion.interpolation = map.choice<Waypoints::Interpolation>("interpolation");
  motion.points = atNode(map.require("file"), [&] { return loadWaypoints(file); });
  return motion;
}

Motion readHandHeld(const YamlMap& parent) {
  HandHeld motion;
  readFields(YamlMap(parent, "hand_held"), kHandHeldFields, motion);
  return motion;
}

}  // namespace

std::optional<Motion> readMotion(const YamlMap& object, const std::filesystem::path& directory) {
  const std::optional<YamlNode> node = object.find("motion");
  if (!node) return {};
  const YamlMap map(object, "motion");
  const std::string_view kind = map.onlyOne();
  const Motion motion = kind == "constant_twist" ? readConstantTwist(map)
                        : kind == "sinusoid"     ? readSinusoid(map)
                        : kind == "waypoints"    ? readWaypoints(map, directory)
                                                 : readHandHeld(map);
  atNode(*node, [&] { checkMotion(motion); });
  return motion;
}

}  // namespace taxelsim
