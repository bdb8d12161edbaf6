#include "scene/keys/robot.h"

#include <utility>

#include "control/robot_fields.h"
#include "scene/keys/sensor.h"

namespace taxelsim {
namespace {

const Block& initialPositionKeys() {
  static const Block block{.name = "",
                           .keys = {{"joint", Text{"the name of a joint"}, kNeeded, "Joint"},
                                    {"position[_deg]", Number{Allowed::any("rad")}, "", "Position of a revolute joint"},
                                    {"position[_mm]", Number{Allowed::any("m")}, "", "Position of a prismatic joint"}}};
  return block;
}

// Lists the keys of a robot with joints. `sensors`, `selection`: their defaults.
KeyTable manipulatorKeys(std::string sensors, std::string selection) {
  return joinKeys(KeyTable{{"base", Nested{poseKeys}, "identity", "Pose of the base in the world"},
                           {"sensors", NestedList{"a list of at least one {link, mount}", mountKeys}, std::move(sensors),
                            "1 to 64 sensors; all are simulated, the controller reads and moves the first one"},
                           {"selection", Words{kCoordinateNames, true}, std::move(selection),
                            "Velocities of the first sensor, in S, that the joints follow"}},
                  keysOfFields(kManipulatorFields), keysOfFields(kDriveFields),
                  KeyTable{{"initial_positions", NestedList{"a list of {joint, position}", initialPositionKeys},
                            "0, or the limit next to it", "Positions of joints at the start"}});
}

const Block& panTiltKeys() {
  static const Block block{.name = "pan_tilt",
                           .keys = joinKeys(keysOfFields(kPanTiltFields), manipulatorKeys("on tilt, 0.03 m up", "[wy, wz]"))};
  return block;
}

const Block& urdfKeys() {
  static const Block block{
      .name = "urdf",
      .keys = joinKeys(KeyTable{{"file", Text{"a URDF file"}, kNeeded, "URDF, relative to the folder of the file that names it"},
                                sha256Key(),
                                {"base_link", Text{"the name of a link"}, "the root", "The fixed link"}},
                       keysOfFields(kUrdfFields), manipulatorKeys(kNeeded, "all"))};
  return block;
}

}  // namespace

const Block& mountKeys() {
  static const Block block{
      .name = "mount",
      .keys = {{"name", Text{"a name of letters, digits and _"}, "", "Name of the sensor in a scene of kind grasp, which requires it"},
               {"link", Text{"the name of a link"}, "", "Link that carries the sensor"},
               {"mount", Nested{poseKeys}, "identity", "Pose of S in the link"},
               {"sensor", Nested{sensorKeys, "a sensor file"}, "", "Sensor in a scene of kind grasp, which requires it"},
               {"urdf_sensor", Text{"the name of a tactile sensor in the URDF"}, "",
                "Instead of link and mount: parent and origin of this <sensor> with <tactile> in the URDF"}}};
  return block;
}

const Block& robotKeys() {
  static const Block block{
      .name = "robot",
      .keys = {fileKeys(kNeededInFile).front(),
               {"free_flying", Nested{noKeys}, "", "The sensor follows every twist"},
               {"pan_tilt", Nested{panTiltKeys}, "", "Two servo motors under a plate: `pan` about z of the base, on it `tilt` about y"},
               {"urdf", Nested{urdfKeys}, "", "Links of a URDF file and the joints between them"}},
      .one_of = {"free_flying", "pan_tilt", "urdf"}};
  return block;
}

}  // namespace taxelsim
