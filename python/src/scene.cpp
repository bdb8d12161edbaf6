// Scenes.
#include "taxelsim/scene.h"

#include <nanobind/stl/filesystem.h>
#include <nanobind/stl/map.h>
#include <nanobind/stl/optional.h>
#include <nanobind/stl/pair.h>
#include <nanobind/stl/string.h>
#include <nanobind/stl/vector.h>

#include <map>
#include <utility>

#include "bind.h"
#include "interruptible.h"
#include "scene/scene_fields.h"

namespace taxelsim::python {
namespace {

Scene loadSceneWith(const std::filesystem::path& file, std::optional<std::uint64_t> num_episodes, std::optional<std::uint64_t> seed,
                    const std::string& condition, bool refuse_folders) {
  return loadInterruptibly([&] {
    return loadScene(file, {.num_episodes = num_episodes, .seed = seed, .condition = condition, .refuse_folders = refuse_folders});
  });
}

// Ranges of the random variables of an episode. One of load and depth is missing; so is exploration_velocity if it is the controller's.
std::map<std::string, std::pair<double, double>> rangesOf(const Scene& scene) {
  std::map<std::string, std::pair<double, double>> ranges;
  const auto add = [&](const auto& table) {
    for (const RangeField& field : table) {
      if (const std::optional<Range> range = field.in(scene.randomization)) ranges[std::string(field.name())] = {range->min, range->max};
    }
  };
  add(kRandomizationFields);
  add(kServoRandomizationFields);
  return ranges;
}

std::vector<std::pair<std::string, Sensor>> sensorsOf(const Scene& scene) {
  std::vector<std::pair<std::string, Sensor>> sensors;
  if (scene.grasp) {
    for (const RobotSensor& sensor : scene.grasp->sensors) sensors.emplace_back(sensor.name, sensor.sensor);
  }
  return sensors;
}

std::vector<Object> objectsOf(const Scene& scene) {
  std::vector<Object> objects;
  for (const SceneObject& object : scene.objects) objects.push_back(object.object);
  return objects;
}

std::vector<Pose> objectPosesOf(const Scene& scene) {
  std::vector<Pose> poses;
  for (const SceneObject& object : scene.objects) poses.push_back(object.pose);
  return poses;
}

std::vector<std::string> controllerNames(const Scene& scene) {
  std::vector<std::string> names;
  if (scene.kind == Scene::Kind::kServo) {
    for (const SceneController& controller : scene.controllers) names.push_back(controller.name);
  }
  return names;
}

}  // namespace

void bindScene(nb::module_& module) {
  nb::class_<Scene> scene(module, "Scene", "A scene file, read and checked: everything that determines a data set. Made by load_scene().");
  nb::enum_<Scene::Kind>(scene, "Kind", "Kind of scene.")
      .value("SERVO", Scene::Kind::kServo, "Episodes of num_steps frames under a controller.")
      .value("CONTACTS", Scene::Kind::kContacts, "Episodes of one frame each: labelled contact images.")
      .value("GRASP", Scene::Kind::kGrasp, "Episodes of num_steps frames: the fingers of a hand close on all objects at once.")
      .value("CONTACT_POINTS", Scene::Kind::kContactPoints,
             "Episodes of num_steps frames from recorded contact points: no objects, no robot.");
  scene.def_ro("file", &Scene::file, "File that it was read from.")
      .def_ro("name", &Scene::name, "Name in data sets.")
      .def_ro("kind", &Scene::kind, "Kind of scene.")
      .def_ro("sensor", &Scene::sensor, "The sensor; of kind GRASP the first of `sensors`.")
      .def_prop_ro("sensors", &sensorsOf, "(name, sensor) of the robot's sensors, in its order; empty for other kinds than GRASP.")
      .def_prop_ro("objects", &objectsOf, "The objects, in the order of the scene.")
      .def_prop_ro("object_poses", &objectPosesOf, "X_WO of each object at the start; of kind GRASP only.")
      .def_prop_ro("controllers", &controllerNames, "Names of the controllers; empty for other kinds than SERVO.")
      .def_prop_ro(
          "has_task", [](const Scene& self) { return self.task.has_value(); }, "Whether evaluate() can judge its episodes.")
      .def_ro("num_steps", &Scene::num_steps, "Frames per episode.")
      .def_ro("simulation_rate", &Scene::simulation_rate, "Hz.")
      .def_ro("control_rate", &Scene::control_rate, "Hz.")
      .def_ro("num_episodes", &Scene::num_episodes, "Episodes of the data set.")
      .def_ro("seed", &Scene::seed, "Seed of all random numbers.")
      .def_ro("conditions", &Scene::conditions, "Names of the conditions of the file, without \"nominal\".")
      .def_ro("condition", &Scene::condition, "The condition that was loaded.")
      .def_prop_ro("randomization", &rangesOf,
                   "(min, max) of each random variable of an episode, SI units, by its key in the file; load or depth is missing.")
      .def_ro("episodes_per_shard", &Scene::episodes_per_shard, "Episodes per file.")
      .def_ro("record", &Scene::record, "Recorded outputs.")
      .def_ro("resolved", &Scene::resolved, "The scene as canonical YAML with every default.")
      .def(
          "__reduce__",
          [](const Scene& self) {
            return nb::make_tuple(nb::module_::import_("taxelsim.runs").attr("reload_scene"),
                                  nb::make_tuple(self.file, self.num_episodes, self.seed, self.condition));
          },
          nb::sig("def __reduce__(self) -> tuple[typing.Any, ...]"))
      .def("__repr__", [](const Scene& self) {
        return "<taxelsim.Scene " + self.name + ", " + std::to_string(self.num_episodes) + " episodes of " +
               std::to_string(self.num_steps) + " frames>";
      });
  module.def("load_scene", &loadSceneWith, "file"_a, "num_episodes"_a = nb::none(), "seed"_a = nb::none(),
             "condition"_a = std::string(kNominalCondition), "refuse_folders"_a = false,
             R"(Reads and checks a scene and all files that it names.

num_episodes, seed: replace those of the file. condition: name of one of the scene's conditions, whose overrides of sensor and randomization
apply; "nominal" is the scene without them. refuse_folders: whether to refuse a file that is named with a folder, for the scene of a data set. Raises InputError with file, line, column, key, the value found and what is allowed.)");
  module.def(
      "readable_scene", &readableScene, "recorded"_a,
      "The scene of a data set as text that load_scene() reads: with the springs of a contact law that was removed, for reading what "
      "was recorded.");
}

}  // namespace taxelsim::python
