#include "scene/keys/controller.h"

#include <array>
#include <utility>

#include "control/servo_fields.h"
#include "scene/scene_fields.h"

namespace taxelsim {
namespace {

// Names the tables of loops, which differ in units and in rolling_radius.
constexpr std::array<std::string_view, kNumServoFeatures> kLoopNames{"loop_center", "loop_center", "loop_across", "loop_force",
                                                                     "loop_angle",  "loop_tilt",   "loop_tilt"};

template <std::size_t kFeature>
const Block& loopKeys() {
  static const Block block{.name = kLoopNames[kFeature],
                           .keys = withDefault(keysOfFields(loopFields(static_cast<ServoFeature>(kFeature))), "reference", "")};
  return block;
}

constexpr std::array<const char*, kNumServoFeatures> kLoopTexts{
    "Centre of pressure along x of S",
    "Centre of pressure along y of S",
    "Distance of the edge from the middle of the array, instead of center_x and center_y",
    "Normal force",
    "Angle of the edge, modulo 180 degrees",
    "Tilt of a flat face about x",
    "Tilt of a flat face about y"};

template <std::size_t... kFeatures>
KeyTable allLoopKeys(std::index_sequence<kFeatures...>) {
  return {{kServoFeatureNames[kFeatures], Nested{loopKeys<kFeatures>}, "not controlled", kLoopTexts[kFeatures]}...};
}

// The default of a reference is in words.
KeyTable criterionTable(TaskMeasure measure) {
  KeyTable keys = keysOfFields(criterionFields(measure));
  return keys.size() == 1 ? keys : withDefault(std::move(keys), "reference", measure == TaskMeasure::kEdgeAngle ? "0" : "the controller's");
}

template <std::size_t kMeasure>
const Block& criterionKeys() {
  static const Block block{.name = "", .keys = criterionTable(static_cast<TaskMeasure>(kMeasure))};
  return block;
}

constexpr std::array<const char*, kNumTaskMeasures> kMeasureTexts{
    "Between the object's edge, or its contour next to the sensor, and the reference", "Clean total force",
    "From the middle of the array to the clean centre of pressure",
    "From the sensor's origin to the object's contour, in the sensor's plane"};

template <std::size_t... kMeasures>
KeyTable allCriterionKeys(std::index_sequence<kMeasures...>) {
  return {{kTaskMeasureNames[kMeasures], Nested{criterionKeys<kMeasures>}, "not judged", kMeasureTexts[kMeasures]}...};
}

}  // namespace

const Block& servoKeys() {
  static const Block block{
      .name = "tactile_servo",
      .keys = joinKeys(
          KeyTable{{"jacobian", Words{kJacobianSourceNames}, "nominal",
                    "Conversion of feature rates to a twist. nominal: for a point contact and the skin's stiffness over the contact; "
                    "measured: by damped least squares with the tactile Jacobian of the frame, which needs contact: whole"},
                   {"edge_angle_source", Words{kEdgeAngleSourceNames}, "principal_axis",
                    "principal_axis: of all forces; window: under a Gaussian window, which the border of the array biases less; ridge: of "
                    "a Gaussian ridge fitted to the logarithms of the forces, which gains that differ between taxels turn least; exact: "
                    "from the object's pose and edge, which no sensor can measure"},
                   {"contact", Words{kServoContactNames}, "whole",
                    "whole: all contacts; largest_region: the connected taxels with the largest force"}},
          keysOfFields(kServoFields), allLoopKeys(std::make_index_sequence<kNumServoFeatures>()))};
  return block;
}

const Block& oneControllerKeys() {
  static const Block block{.name = "", .keys = {{"tactile_servo", Nested{servoKeys}, kNeeded, "Gains and limits"}}};
  return block;
}

const Block& controllerKeys() {
  static const Block block{.name = "",
                           .keys = joinKeys(KeyTable{{"name", Text{"a name"}, kNeeded, "Name, unlike those of the other controllers"}},
                                            keysOfFields(kControllerFields), oneControllerKeys().keys)};
  return block;
}

const Block& taskKeys() {
  static const Block block{.name = "task",
                           .keys = joinKeys(allCriterionKeys(std::make_index_sequence<kNumTaskMeasures>()),
                                            withDefault(keysOfFields(kTaskFields), "hold", "1, or the episode"))};
  return block;
}

}  // namespace taxelsim
