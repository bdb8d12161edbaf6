#include "scene/task_reader.h"

#include <algorithm>

#include "scene/scene_checks.h"
#include "scene/scene_fields.h"

namespace taxelsim {
namespace {

constexpr double kDefaultHold = 1;  // s, for episodes that last at least as long

std::optional<TaskCriterion> readCriterion(const YamlMap& parent, TaskMeasure measure) {
  const std::string_view name = kTaskMeasureNames[static_cast<std::size_t>(measure)];
  if (!parent.has(name)) return {};
  TaskCriterion criterion;
  if (measure == TaskMeasure::kEdgeAngle) criterion.reference = 0;
  readFields(YamlMap(parent, name), criterionFields(measure), criterion);
  return criterion;
}

}  // namespace

std::optional<Task> readTask(const YamlMap& scene_map, const Scene& scene) {
  const std::optional<YamlNode> node = scene_map.find("task");
  if (!node) return {};
  if (scene.kind == Scene::Kind::kContacts) node->fail("a scene of kind contacts has no task");
  const YamlMap map(scene_map, "task");
  Task task;
  for (int m = 0; m < kNumTaskMeasures; ++m) {
    task.criteria[static_cast<std::size_t>(m)] = readCriterion(map, static_cast<TaskMeasure>(m));
  }
  task.hold = std::min(kDefaultHold, scene.num_steps / scene.simulation_rate);
  readFields(map, kTaskFields, task);
  atNode(map.node(), [&] { checkTask(task, scene); });
  return task;
}

}  // namespace taxelsim
