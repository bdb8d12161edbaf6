#include "scene/keys/grasp.h"

#include "scene/keys/controller.h"
#include "scene/scene_fields.h"

namespace taxelsim {
namespace {

const Block& fingerJointKeys() {
  static const Block block{.name = "",
                           .keys = {{"joint", Text{"the name of a joint that moves a sensor"}, kNeeded, "Joint; it belongs to one finger"},
                                    {"velocity[_deg]", Number{Allowed::any("rad/s")}, "",
                                     "Velocity of a revolute joint while the finger closes, within its limit"},
                                    {"velocity[_mm]", Number{Allowed::any("m/s")}, "", "Velocity of a prismatic joint, the same"}}};
  return block;
}

const Block& graspServoKeys() {
  static const Block block{
      .name = "",
      .keys = {{"sensor", Text{"the name of a sensor of the robot"}, kNeeded, "Sensor that the servo reads; it belongs to no finger"},
               {"joints", Text{"a list of at least one name of a joint that moves the sensor", true}, kNeeded,
                "Joints that follow the servo; they belong to no finger"},
               {"tactile_servo", Nested{servoKeys}, kNeeded, "Gains and limits; edge_angle_source is not exact"}}};
  return block;
}

}  // namespace

const Block& graspTaskKeys() {
  static const Block block{.name = "", .keys = withDefault(keysOfFields(kGraspTaskFields), "hold", "0.5, or the episode")};
  return block;
}

const Block& graspKeys() {
  static const Block block{
      .name = "grasp",
      .keys = joinKeys(keysOfFields(kGraspGainFields),
                       KeyTable{{"fingers", NestedList{"a list of at least one {sensor, force, joints}", fingerKeys}, kNeeded,
                                 "Fingers that close until their sensors read the target force"},
                                {"servo", Nested{graspServoKeys}, "none", "Tactile servo of one more sensor; it runs in every frame"}})};
  return block;
}

const Block& fingerKeys() {
  static const Block block{
      .name = "",
      .keys = joinKeys(KeyTable{{"sensor", Text{"the name of a sensor of the robot"}, kNeeded, "Sensor of the finger"}},
                       keysOfFields(kFingerForceFields),
                       KeyTable{{"joints", NestedList{"a list of at least one {joint, velocity}", fingerJointKeys}, kNeeded,
                                 "Joints that close the finger; at least one moves the sensor and does not start at its limit"}})};
  return block;
}

}  // namespace taxelsim
