#include "scene/keys/scene.h"

#include <span>
#include <utility>

#include "scene/keys/controller.h"
#include "scene/keys/grasp.h"
#include "scene/keys/object.h"
#include "scene/keys/robot.h"
#include "scene/keys/sensor.h"
#include "scene/object_reader.h"
#include "scene/scene_fields.h"

namespace taxelsim {
namespace {

KeyTable rangeKeys(std::span<const RangeField> table) {
  KeyTable keys;
  for (const RangeField& field : table) {
    keys.push_back(
        {field.key, Numbers{.allowed = field.allowed, .count = 2, .or_one = true}, std::string(field.otherwise), std::string(field.text)});
  }
  return keys;
}

// Lists the overrides of a condition, which may leave load and depth as they are.
const Block& overrideKeys() {
  static const Block block{.name = "", .keys = servoRandomizationKeys().keys};
  return block;
}

const Block& episodeKeys() {
  static const Block block{.name = "",
                           .keys = joinKeys(keysOfFields(kNumStepsFields), keysOfFields(kSimulationRateFields),
                                            withDefault(keysOfFields(kControlRateFields), "control_rate", "simulation_rate"))};
  return block;
}

const Block& recordedEpisodeKeys() {
  static const Block block{.name = "", .keys = joinKeys(keysOfFields(kNumStepsFields), keysOfFields(kSimulationRateFields))};
  return block;
}

const Block& dataSetKeys() {
  static const Block block{.name = "data_set",
                           .keys = joinKeys(keysOfFields(kNumEpisodesFields), keysOfFields(kSeedFields), keysOfFields(kDataSetFields))};
  return block;
}

const Block& sensorPosesKeys() {
  static const Block block{
      .name = "",
      .keys = {{"file", Text{"a CSV file of poses of the sensor"}, kNeeded, "Poses; a pose holds until the next one of the episode"},
               sha256Key()}};
  return block;
}

const Block& contactPointsKeys() {
  static constexpr std::array<std::string_view, 2> kFrames{"sensor", "world"};
  static const Block block{
      .name = "contact_points",
      .keys = joinKeys(KeyTable{{"file", Text{"a CSV file of contact points"}, kNeeded, "Points and forces of each step"},
                                sha256Key(),
                                {"num_episodes", Number{Allowed::within(1, kMaxRecordedEpisodes, ""), true}, "those of the file",
                                 "The file has episodes 0 to num_episodes - 1"},
                                {"frame", Words{kFrames}, "sensor", "Frame of positions and forces"},
                                {"sensor_pose", Nested{poseKeys}, "", "X_WS, the pose of the sensor in the world, where frame is world"},
                                {"sensor_poses", Nested{sensorPosesKeys}, "", "Instead of it: those of a sensor that moves"}},
                       keysOfFields(kContactBandFields))};
  return block;
}

Key conditionsKey() {
  return {"conditions", NestedByName{"a mapping of names to {sensor, randomization}", conditionKeys}, "none",
          "Overrides of sensor and randomization, by name"};
}

Key graspConditionsKey() {
  return {"conditions", NestedByName{"a mapping of names to {robot, randomization}", graspConditionKeys}, "none",
          "Overrides of robot and randomization, by name"};
}

Key randomizationKey(BlockOf block) {
  return {"randomization(randomisation)", Nested{block}, "",
          "Random values of each episode: a number, or [min, max] of a uniform distribution"};
}

Key episodeKey(BlockOf block) {
  return {"episode", Nested{block}, "", "Length and rates of an episode"};
}

Key sensorKey() {
  return {"sensor", Nested{sensorKeys, "a sensor file"}, kNeeded, "Sensor"};
}

Key robotKey(std::string otherwise) {
  return {"robot", Nested{robotKeys, "a robot file"}, std::move(otherwise), "Robot that carries the sensors"};
}

Key objectsKey(BlockOf block) {
  return {"objects", NestedList{kObjectList, block}, kNeeded, "Objects"};
}

KeyTable sceneHead() {
  return joinKeys(fileKeys(kNeeded),
                  KeyTable{{"kind", Words{kSceneKindNames}, kNeeded,
                            "servo: episodes of num_steps frames under a controller; contacts: episodes of one frame; grasp: the fingers "
                            "of a hand close on objects; contact_points: recorded contact points instead of objects"}});
}

KeyTable sceneTail() {
  return joinKeys(KeyTable{{"record", Words{kRecordWords, true}, "see below", "Recorded groups of columns"}},
                  withDefault(keysOfFields(kMaxRegionsFields), "max_regions", "4"),
                  KeyTable{{"data_set", Nested{dataSetKeys}, "", "Size and form of the data set"}});
}

KeyTable servoOnlyKeys() {
  return {{"controller", Nested{oneControllerKeys}, "", "The controller"},
          {"controllers", NestedList{"a list of at least one controller, {name: ..., tactile_servo: {...}}", controllerKeys}, "",
           "Instead of it: several, of which each episode draws one by weight"},
          {"task", Nested{taskKeys}, "none", "Success criteria of `taxelsim evaluate`"}};
}

KeyTable contactKeys(BlockOf randomization) {
  return {sensorKey(),    robotKey("free_flying"), objectsKey(objectKeys), episodeKey(episodeKeys), randomizationKey(randomization),
          conditionsKey()};
}

}  // namespace

const Block& conditionKeys() {
  static const Block block{.name = "",
                           .keys = {{"sensor", Nested{sensorKeys, "a sensor file"}, "the scene's", "Sensor with the same taxel positions"},
                                    {"randomization", Nested{overrideKeys}, "the scene's", "Each key replaces that key of the scene"}}};
  return block;
}

const Block& graspConditionKeys() {
  static const Block block{
      .name = "",
      .keys = {{"robot", Nested{robotKeys, "a robot file"}, "the scene's", "Robot with the same joints, and sensors with the same taxels"},
               {"randomization", Nested{graspRandomizationKeys}, "the scene's", "Each key replaces that key of the scene"}}};
  return block;
}

const Block& readoutRandomizationKeys() {
  static const Block block{
      .name = "",
      .keys = rangeKeys(std::array{randomizationField("gain"), randomizationField("gain_spread"), randomizationField("noise")})};
  return block;
}

const Block& graspRandomizationKeys() {
  static const Block block{.name = "", .keys = joinKeys(keysOfFields(kGraspRandomFields), readoutRandomizationKeys().keys)};
  return block;
}

const Block& servoRandomizationKeys() {
  static const Block block{.name = "randomization",
                           .keys = joinKeys(rangeKeys(kRandomizationFields), rangeKeys(kServoRandomizationFields)),
                           .one_of = {"load", "depth"}};
  return block;
}

const Block& randomizationKeys() {
  static const Block block{.name = "randomization_contacts", .keys = rangeKeys(kRandomizationFields), .one_of = {"load", "depth"}};
  return block;
}

const Block& sceneKeys(Scene::Kind kind) {
  static const Block servo{.name = "scene_servo",
                           .keys = joinKeys(sceneHead(), contactKeys(servoRandomizationKeys), servoOnlyKeys(), sceneTail())};
  static const Block contacts{.name = "scene_contacts", .keys = joinKeys(sceneHead(), contactKeys(randomizationKeys), sceneTail())};
  static const Block grasp{.name = "scene_grasp",
                           .keys = joinKeys(sceneHead(),
                                            KeyTable{robotKey(kNeeded),
                                                     objectsKey(placedObjectKeys),
                                                     {"grasp", Nested{graspKeys}, kNeeded, "Fingers and their target forces"},
                                                     episodeKey(episodeKeys),
                                                     {"randomization", Nested{graspRandomizationKeys}, "", "Random values of each episode"},
                                                     graspConditionsKey(),
                                                     {"task", Nested{graspTaskKeys}, "", "Success criteria of `taxelsim evaluate`"}},
                                            sceneTail())};
  static const Block contact_points{
      .name = "scene_contact_points",
      .keys = joinKeys(sceneHead(),
                       KeyTable{sensorKey(),
                                {"contact_points", Nested{contactPointsKeys}, kNeeded, "Recorded contact points"},
                                episodeKey(recordedEpisodeKeys),
                                {"randomization", Nested{readoutRandomizationKeys}, "", "Random values of each episode"}},
                       sceneTail())};
  switch (kind) {
    case Scene::Kind::kServo:
      return servo;
    case Scene::Kind::kContacts:
      return contacts;
    case Scene::Kind::kGrasp:
      return grasp;
    case Scene::Kind::kContactPoints:
      break;
  }
  return contact_points;
}

}  // namespace taxelsim
