#include "scene/scene_checks.h"

#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

#include "base/field_checks.h"
#include "control/servo_fields.h"
#include "scene/keys/scene.h"
#include "scene/scene_fields.h"
#include "scene/skin_ranges.h"

namespace taxelsim {
namespace {

constexpr double kRounding = 1e-9;  // relative; rates and times are decimal fractions

bool hasEdge(const SceneObject& object) {
  return object.edge || !object.contour.empty();
}
bool hasContour(const SceneObject& object) {
  return !object.contour.empty();
}

template <typename Item, typename Table>
void checkWeights(const std::string& list, const std::vector<Item>& items, const Table& table) {
  if (items.empty()) failField(list, "an empty list", "at least one");
  double sum = 0;
  for (std::size_t i = 0; i < items.size(); ++i) {
    checkFields(elementOf(list, i) + ".", table, items[i]);
    sum += items[i].weight;
  }
  if (!(sum > 0)) throw Error(list, "every weight is 0: at least one must be chosen");
}

void checkRecording(const Scene& scene) {
  if (scene.kind != Scene::Kind::kContactPoints) return;
  if (!scene.contact_points) throw Error("contact_points", "missing: a scene of kind contact_points needs them");
  checkNumber("contact_points.contact_band", scene.contact_points->contact_band, kContactBand);
  checkRecordedEpisodes(scene);
}

void checkObjects(const Scene& scene) {
  if (scene.kind == Scene::Kind::kContactPoints) return;
  checkWeights("objects", scene.objects, kObjectFields);
  for (std::size_t i = 0; i < scene.objects.size(); ++i) {
    const SceneObject& object = scene.objects[i];
    checkObject(object.object);
    if (object.motion) checkBelow(elementOf("objects", i) + ".motion", [&] { checkMotion(*object.motion); });
  }
}

void checkControllers(const Scene& scene) {
  if (scene.kind != Scene::Kind::kServo) return;
  checkWeights("controllers", scene.controllers, kControllerFields);
  for (std::size_t i = 0; i < scene.controllers.size(); ++i) {
    checkBelow(elementOf("controllers", i) + ".tactile_servo", [&] { checkServo(scene.controllers[i].servo); });
  }
}

void checkGraspServo(const Scene& scene) {
  if (!scene.grasp || !scene.grasp->servo) return;
  checkBelow("grasp.servo.tactile_servo", [&] {
    const TactileServo& servo = scene.grasp->servo->servo;
    checkServo(servo);
    if (servo.edge_angle_source == EdgeAngleSource::kExact) {
      failField("edge_angle_source", "exact", "principal_axis, window or ridge in a scene of kind grasp, whose objects have no edge");
    }
  });
}

void checkRange(const std::string& field, const Range& range, const Allowed& allowed) {
  checkNumber(field + ".min", range.min, allowed);
  checkNumber(field + ".max", range.max, allowed);
  if (range.min > range.max)
    failField(field, "[" + numberText(range.min) + ", " + numberText(range.max) + "]", "[min, max] with min <= max");
}

void checkRandomization(const Scene& scene) {
  if (scene.kind == Scene::Kind::kGrasp) return;
  const bool is_recorded = scene.kind == Scene::Kind::kContactPoints;
  const Randomization& random = scene.randomization;
  const auto check = [&](const auto& table) {
    for (const RangeField& field : table) {
      const std::string path = "randomization." + std::string(field.name());
      if (const std::optional<Range> range = field.in(random)) checkRange(path, *range, field.allowed);
    }
  };
  check(kRandomizationFields);
  check(kServoRandomizationFields);
  checkBelow("randomization", [&] { checkSkinRanges(random, scene.sensor); });
  if (is_recorded && (random.load || random.depth || variesSkin(random) || variesMounting(random))) {
    throw Error("randomization", "a scene of kind contact_points varies gain, gain_spread and noise only");
  }
  if (!is_recorded && random.load.has_value() == random.depth.has_value())
    throw Error("randomization", "exactly one of load and depth must be set");
}

// duration: s, of an episode.
void checkHold(double hold, double duration) {
  if (hold <= duration * (1 + kRounding)) return;
  failField("hold", numberText(hold), describe(Allowed::aboveUpTo(0, duration, "s")) + ", the duration of an episode");
}

}  // namespace

void checkRates(const Scene& scene) {
  const double ratio = scene.simulation_rate / scene.control_rate;
  if (ratio >= 1 - kRounding && std::abs(ratio - std::round(ratio)) <= kRounding * ratio) return;
  failField("control_rate", numberText(scene.control_rate) + " Hz",
            "simulation_rate (" + numberText(scene.simulation_rate) + " Hz) divided by a whole number");
}

void checkGraspTask(const GraspTask& task, double duration) {
  checkFields("", kGraspTaskFields, task);
  checkHold(task.hold, duration);
}

void checkTask(const Task& task, const Scene& scene) {
  bool any = false;
  for (std::size_t m = 0; m < task.criteria.size(); ++m) {
    if (!task.criteria[m]) continue;
    any = true;
    checkFields(std::string(kTaskMeasureNames[m]) + ".", criterionFields(static_cast<TaskMeasure>(m)), *task.criteria[m]);
  }
  if (!any) throw Error(ErrorKind::kInput, "no success criterion: at least one of edge_angle, total_force, center, contour");
  checkFields("", kTaskFields, task);
  checkHold(task.hold, scene.num_steps / scene.simulation_rate);
  const auto& objects = scene.objects;
  if (task[TaskMeasure::kEdgeAngle] && !std::all_of(objects.begin(), objects.end(), hasEdge)) {
    throw Error("edge_angle", "needs an edge or a contour of every object of the scene");
  }
  if (std::all_of(objects.begin(), objects.end(), hasContour)) return;
  if (task[TaskMeasure::kContour]) throw Error("contour", "needs a contour of every object of the scene");
  if (task.laps > 0) throw Error("laps", "needs a contour of every object of the scene");
}

void checkRecordedEpisodes(const Scene& scene) {
  const std::uint64_t num_recorded = scene.contact_points->num_episodes;
  if (scene.num_episodes <= num_recorded) return;
  throw Error(ErrorKind::kInput, "episodes: " + std::to_string(scene.num_episodes) + " is not allowed: 1 to " +
                                     std::to_string(num_recorded) + ", the episodes of " + scene.contact_points->file_name);
}

std::string wordOf(Scene::Kind kind) {
  return std::string(kSceneKindNames[static_cast<std::size_t>(kind)]);
}

void checkScene(const Scene& scene) {
  checkFields("", kNumEpisodesFields, scene);
  checkFields("", kNumStepsFields, scene);
  if (scene.kind == Scene::Kind::kContacts && scene.num_steps != 1) {
    failField("num_steps", std::to_string(scene.num_steps), "1 in a scene of kind contacts");
  }
  checkFields("", kSimulationRateFields, scene);
  checkFields("", kControlRateFields, scene);
  checkFields("", kSeedFields, scene);
  checkFields("", kDataSetFields, scene);
  checkFields("", kMaxRegionsFields, scene);
  checkRates(scene);
  checkRecording(scene);
  checkObjects(scene);
  checkControllers(scene);
  checkGraspServo(scene);
  checkRandomization(scene);
  if (scene.task) checkBelow("task", [&] { checkTask(*scene.task, scene); });
  checkBelow("robot", [&] { checkRobot(scene.robot); });
  checkBelow("sensor", [&] { checkSensor(scene.sensor); });
}

}  // namespace taxelsim
