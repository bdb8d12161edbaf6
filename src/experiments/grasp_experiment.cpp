#include <algorithm>
#include <cmath>
#include <limits>

#include "base/constants.h"
#include "base/field_checks.h"
#include "episodes/grasp_batch.h"
#include "scene/scene_checks.h"
#include "taxelsim/error.h"
#include "taxelsim/experiment.h"

namespace taxelsim {
namespace {

constexpr double kDecayFrom = 0.5, kDecayTo = 0.1;  // of the target; below, the rounding of the readout to counts shows

// Mean factor of the error per frame between its last value above kDecayFrom and its first one below kDecayTo, both of the target.
double decayOf(const GraspFingerTrace& finger) {
  const auto error = [&](std::size_t n) { return std::abs(finger.force[n] - finger.target) / finger.target; };
  std::size_t first = finger.force.size();
  for (std::size_t n = 0; n < finger.force.size(); ++n) {
    if (finger.force[n] > 0 && error(n) >= kDecayFrom) first = n + 1;  // the next frame is the first of the fall
  }
  std::size_t last = first;
  while (last + 1 < finger.force.size() && error(last) > kDecayTo) ++last;
  if (last >= finger.force.size() || last < first + 2 || finger.force[first] == 0 || error(last) == 0) return kNaN;
  return std::exp(std::log(error(last) / error(first)) / static_cast<double>(last - first));
}

void measure(GraspFingerTrace& finger, const Scene& scene) {
  const GraspTask& task = scene.grasp->task;
  const double dt = 1 / scene.simulation_rate;
  const auto num_frames = static_cast<std::ptrdiff_t>(finger.force.size());
  const auto touched = std::find_if(finger.force.begin(), finger.force.end(), [](double force) { return force > 0; });
  finger.first_contact = touched == finger.force.end() ? kNaN : static_cast<double>(touched - finger.force.begin()) * dt;
  std::ptrdiff_t settled = num_frames;
  while (settled > 0 && std::abs(finger.force[static_cast<std::size_t>(settled - 1)] - finger.target) <= task.tolerance * finger.target)
    --settled;
  finger.settling_time = settled == num_frames ? kNaN : static_cast<double>(settled) * dt;
  finger.overshoot = std::max(0.0, *std::max_element(finger.force.begin(), finger.force.end()) / finger.target - 1);
  const std::ptrdiff_t num_held = std::clamp<std::ptrdiff_t>(std::lround(task.hold / dt), 1, num_frames);
  double sum = 0;
  for (auto force = finger.force.end() - num_held; force != finger.force.end(); ++force) sum += std::pow(*force - finger.target, 2);
  finger.steady_rms = std::sqrt(sum / static_cast<double>(num_held));
  finger.decay = decayOf(finger);
}

GraspRun run(const Device& device, const Scene& scene) {
  const Grasp& grasp = *scene.grasp;
  GraspRun result{.gain = grasp.gain, .expected_decay = 1 - grasp.gain / scene.simulation_rate, .time = {}, .fingers = {}};
  GraspBatch batch(device, scene, kNoOutputs, 1);
  batch.begin(0, 1);
  for (std::size_t f = 0; f < grasp.fingers.size(); ++f) {
    GraspFingerTrace& finger = result.fingers.emplace_back();
    finger.name = grasp.sensors[static_cast<std::size_t>(grasp.fingers[f].sensor)].name;
    finger.target = batch.targetForces()[f];
  }
  for (int frame = 0; frame < scene.num_steps; ++frame) {
    batch.step();
    result.time.push_back(batch.time());
    for (std::size_t f = 0; f < grasp.fingers.size(); ++f) {
      const int sensor = grasp.fingers[f].sensor;
      result.fingers[f].force.push_back(batch.robots().frame(sensor).ground_truth.total_force[batch.robots().row(sensor, 0)]);
    }
  }
  for (GraspFingerTrace& finger : result.fingers) measure(finger, scene);
  return result;
}

}  // namespace

std::vector<GraspRun> runGraspExperiment(const Device& device, const GraspExperiment& experiment) {
  checkScene(experiment.scene);
  if (!experiment.scene.grasp) throw Error(ErrorKind::kInput, experiment.name + ": the scene is not of kind grasp");
  for (const double gain : experiment.gains) checkNumber("gains", gain, Allowed::aboveUpTo(0, experiment.scene.simulation_rate, "1/s"));
  std::vector<GraspRun> runs;
  for (const double gain : experiment.gains) {
    Scene scene = experiment.scene;
    scene.grasp->gain = gain;
    runs.push_back(run(device, scene));
  }
  return runs;
}

}  // namespace taxelsim
