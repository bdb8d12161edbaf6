#include "scene/motion_reader.h"

#include "scene/hashed_file.h"
#include "taxelsim/scene.h"

namespace taxelsim {
namespace {

constexpr std::string_view kKinds = "constant_twist | sinusoid | waypoints | hand_held";
constexpr std::uintmax_t kMaxWaypointBytes = std::uintmax_t{64} << 20;

Motion readConstantTwist(const YamlMap& parent) {
  const YamlMap map(parent, "constant_twist", {"linear_velocity[_mm]", "angular_velocity[_deg]"});
  ConstantTwist motion;
  motion.twist.v = map.numbers<3>("linear_velocity", Allowed::any("m/s"), motion.twist.v);
  motion.twist.w = map.numbers<3>("angular_velocity", Allowed::any("rad/s"), motion.twist.w);
  return motion;
}

Motion readSinusoid(const YamlMap& parent) {
  const YamlMap map(parent, "sinusoid", {"axis", "amplitude[_mm]", "angle[_deg]", "frequency", "phase[_deg]"});
  if (!map.has("amplitude") && !map.has("angle")) {
    map.node().fail("amplitude[_mm] or angle[_deg] is missing: the amplitude along the axis, or the angle about it");
  }
  Sinusoid motion;
  motion.axis = map.numbers<3>("axis", Allowed::any(""));
  motion.amplitude = map.number("amplitude", Allowed::any("m"), motion.amplitude);
  motion.angle = map.number("angle", Allowed::any("rad"), motion.angle);
  motion.frequency = map.number("frequency", Allowed::above(0, "Hz"));
  motion.phase = map.number("phase", Allowed::any("rad"), motion.phase);
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
  const YamlMap map(parent, "hand_held",
                    {"drift[_mm]", "drift_angle[_deg]", "tremor[_mm]", "tremor_angle[_deg]", "drift_band", "tremor_band"});
  HandHeld motion;
  motion.drift = map.number("drift", Allowed::atLeast(0, "m"), motion.drift);
  motion.drift_angle = map.number("drift_angle", Allowed::atLeast(0, "rad"), motion.drift_angle);
  motion.tremor = map.number("tremor", Allowed::atLeast(0, "m"), motion.tremor);
  motion.tremor_angle = map.number("tremor_angle", Allowed::atLeast(0, "rad"), motion.tremor_angle);
  motion.drift_band = map.numbers<2>("drift_band", Allowed::above(0, "Hz"), motion.drift_band);
  motion.tremor_band = map.numbers<2>("tremor_band", Allowed::above(0, "Hz"), motion.tremor_band);
  return motion;
}

}  // namespace

std::optional<Motion> readMotion(const YamlMap& object, const std::filesystem::path& directory) {
  const std::optional<YamlNode> node = object.find("motion");
  if (!node) return {};
  const YamlMap map(object, "motion", {"constant_twist", "sinusoid", "waypoints", "hand_held"});
  int num_kinds = 0;
  for (const std::string_view kind : {"constant_twist", "sinusoid", "waypoints", "hand_held"}) num_kinds += map.has(kind) ? 1 : 0;
  if (num_kinds != 1) node->fail("exactly one of " + std::string(kKinds));
  const Motion motion = map.has("constant_twist") ? readConstantTwist(map)
                        : map.has("sinusoid")     ? readSinusoid(map)
                        : map.has("waypoints")    ? readWaypoints(map, directory)
                                                  : readHandHeld(map);
  atNode(*node, [&] { checkMotion(motion); });
  return motion;
}

}  // namespace taxelsim
