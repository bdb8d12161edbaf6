#include "scene/task_reader.h"

#include <algorithm>
#include <numbers>

namespace taxelsim {
namespace {

constexpr double kHalfTurn = std::numbers::pi / 2;
constexpr double kMaxLaps = 1000;
constexpr double kMaxTravel = 1000;  // m
constexpr double kRounding = 1e-9;   // relative

std::optional<TaskCriterion> readCriterion(const YamlMap& parent, TaskMeasure measure) {
  const std::string_view name = kTaskMeasureNames[static_cast<std::size_t>(measure)];
  if (!parent.has(name)) return {};
  TaskCriterion criterion;
  switch (measure) {
    case TaskMeasure::kEdgeAngle: {
      const YamlMap map(parent, name, {"reference[_deg]", "tolerance[_deg]"});
      criterion.reference = map.number("reference", {.min = -kHalfTurn, .max = kHalfTurn, .above_min = true, .unit = "rad"}, 0);
      criterion.tolerance = map.number("tolerance", {.min = 0, .max = kHalfTurn, .above_min = true, .unit = "rad"});
      return criterion;
    }
    case TaskMeasure::kTotalForce: {
      const YamlMap map(parent, name, {"reference", "tolerance"});
      if (map.has("reference")) criterion.reference = map.number("reference", Allowed::within(0, 1e6, "N"));
      criterion.tolerance = map.number("tolerance", Allowed::above(0, "N"));
      return criterion;
    }
    case TaskMeasure::kCenter:
    case TaskMeasure::kContour: {
      const YamlMap map(parent, name, {"tolerance[_mm]"});
      criterion.tolerance = map.number("tolerance", Allowed::above(0, "m"));
      return criterion;
    }
  }
  return {};
}

}  // namespace

std::optional<Task> readTask(const YamlMap& scene_map, const Scene& scene) {
  const std::optional<YamlNode> node = scene_map.find("task");
  if (!node) return {};
  if (scene.kind == Scene::Kind::kContacts) node->fail("a scene of kind contacts has no task");
  const YamlMap map(scene_map, "task", {"edge_angle", "total_force", "center", "contour", "hold", "laps", "travel[_mm]"});
  Task task;
  for (int m = 0; m < kNumTaskMeasures; ++m) {
    task.criteria[static_cast<std::size_t>(m)] = readCriterion(map, static_cast<TaskMeasure>(m));
  }
  if (std::none_of(task.criteria.begin(), task.criteria.end(), [](const auto& criterion) { return criterion.has_value(); })) {
    node->fail("no success criterion: at least one of edge_angle, total_force, center, contour");
  }
  const double duration = scene.num_steps / scene.simulation_rate;
  task.hold = map.number("hold", {.min = 0, .max = duration * (1 + kRounding), .above_min = true, .unit = "s"}, std::min(1.0, duration));
  task.laps = map.number("laps", Allowed::within(0, kMaxLaps, ""), task.laps);
  task.travel = map.number("travel", Allowed::within(0, kMaxTravel, "m"), task.travel);

  const bool all_have_edges = std::all_of(scene.objects.begin(), scene.objects.end(),
                                          [](const SceneObject& object) { return object.edge || !object.contour.empty(); });
  const bool all_have_contours =
      std::all_of(scene.objects.begin(), scene.objects.end(), [](const SceneObject& object) { return !object.contour.empty(); });
  if (task[TaskMeasure::kEdgeAngle] && !all_have_edges) {
    map.require("edge_angle", "").fail("needs an edge or a contour of every object of the scene");
  }
  for (const std::string_view key : {"contour", "laps"}) {
    if (map.has(key) && !all_have_contours) map.require(key, "").fail("needs a contour of every object of the scene");
  }
  return task;
}

}  // namespace taxelsim
