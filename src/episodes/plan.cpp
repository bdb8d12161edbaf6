#include "episodes/plan.h"

#include <algorithm>
#include <cmath>

#include "scene/skin_ranges.h"
#include "sensor/skin.h"
#include "taxelsim/environment.h"

namespace taxelsim {

ModelOptions modelOptionsOf(const Scene& scene) {
  ModelOptions options{.sensor = scene.sensor, .objects = {}};
  for (const SceneObject& object : scene.objects) options.objects.push_back(object.object);
  return options;
}

EpisodePlan::EpisodePlan(const Scene& scene_to_run, const OutputOptions& read_outputs, int num_regions)
    : scene(scene_to_run),
      drawer(scene_to_run),
      outputs(read_outputs),
      max_regions(num_regions),
      num_sensors(numSensors(scene_to_run)),
      num_joints(numJoints(scene_to_run)),
      num_frames(numFrames(scene_to_run)),
      dt(1 / scene_to_run.simulation_rate),
      control_period(std::max(1, static_cast<int>(std::lround(scene_to_run.simulation_rate / scene_to_run.control_rate)))),
      starts_at_load(scene_to_run.randomization.load.has_value() && isLevel(scene_to_run.sensor)) {
  for (const SceneObject& object : scene.objects) edges.emplace_back(object);
}

SimulatorOptions EpisodePlan::simulatorOptions(int num_instances) const {
  const ContactRecording* const recording = scene.contact_points ? &*scene.contact_points : nullptr;
  SimulatorOptions options{.num_instances = num_instances * num_sensors,
                           .num_slots = 1,
                           .seed = scene.seed,
                           .outputs = outputs,
                           .max_regions = hasContactFeatures(outputs) ? max_regions : 0,
                           .vary_skin = variesSkin(scene.randomization),
                           .export_memory = export_memory,
                           .device_clock = device_clock};
  if (!recording) return options;
  options.max_contacts = std::max(recording->maxPoints(), 1);
  options.contact_band = recording->contact_band;
  return options;
}

}  // namespace taxelsim
