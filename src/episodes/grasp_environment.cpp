#include "taxelsim/grasp_environment.h"

#include <algorithm>
#include <stdexcept>
#include <string>

#include "base/field_checks.h"
#include "base/length_check.h"
#include "episodes/batch.h"
#include "episodes/grasp_batch.h"
#include "episodes/grasp_judge.h"
#include "episodes/grasp_player.h"
#include "scene/scene_checks.h"
#include "taxelsim/error.h"

namespace taxelsim {
namespace {

const Scene& checkedGrasp(const Scene& scene, const EnvironmentOptions& options) {
  checkCount("num_instances", options.num_instances);
  if (!scene.grasp) {
    throw Error(ErrorKind::kInput,
                scene.file.generic_string() + ": kind: " + wordOf(scene.kind) + " found, a hand's environment needs grasp");
  }
  if (options.max_regions != 0) {
    throw Error(ErrorKind::kInput, "max_regions: " + std::to_string(options.max_regions) +
                                       " is not allowed: 0, since a hand's regions are those of its scene");
  }
  checkScene(scene);
  checkBelow("task", [&] { checkGraspTask(scene.grasp->task, scene.num_steps / scene.simulation_rate); });
  return scene;
}

}  // namespace

struct GraspEnvironment::Impl {
  Impl(const Device& device, const Scene& scene_to_run, const EnvironmentOptions& options)
      : scene(checkedGrasp(scene_to_run, options)),
        num_fingers(scene.grasp->fingers.size()),
        batch(device, scene, options.outputs, options.num_instances, GraspBatch::Joints::kByCaller),
        all(static_cast<std::size_t>(options.num_instances), 1),
        forces(all.size() * num_fingers),
        peak_forces(forces.size()),
        num_losses(forces.size()),
        were_in_contact(forces.size()),
        velocities(all.size() * static_cast<std::size_t>(batch.robots().robots().numJoints())) {
    instances.resize(all.size());
    for (std::size_t i = 0; i < all.size(); ++i) instances[i] = static_cast<int>(i);
    for (const int i : instances) judges.push_back(judgeOf(i));
  }

  GraspJudge judgeOf(int instance) const {
    const auto i = static_cast<std::size_t>(instance);
    return {scene.grasp->task, scene.num_steps, batch.dt(), batch.episodes()[i],
            batch.targetForces().subspan(i * num_fingers, num_fingers)};
  }

  // Judges the new frames of some instances.
  void judgeFrames(std::span<const std::uint8_t> computed) {
    for (const int i : instances) {
      const auto instance = static_cast<std::size_t>(i);
      const int frame = batch.frames()[instance];
      if (!computed[instance] || frame >= scene.num_steps) continue;
      if (frame == 0) judges[instance] = judgeOf(i);
      const std::vector<GraspJudge::Touch> touches = touchesOf(batch, *scene.grasp, i);
      judges[instance].frame(touches);
      const GraspVerdict verdict = judges[instance].verdict();
      for (std::size_t f = 0; f < num_fingers; ++f) {
        const std::size_t k = instance * num_fingers + f;
        forces[k] = touches[f].force;
        peak_forces[k] = verdict.fingers[f].peak_force;
        num_losses[k] = verdict.fingers[f].num_losses;
        were_in_contact[k] = verdict.fingers[f].peak_force > 0;
      }
    }
  }

  void requireFrame() const {
    if (!has_frame) throw std::logic_error("environment: reset() must come first");
  }

  const Scene scene;
  std::size_t num_fingers;
  GraspBatch batch;
  std::vector<GraspJudge> judges;  // (num_instances)
  std::vector<std::uint8_t> all;   // (num_instances), 1
  std::vector<int> instances;      // (num_instances), 0, 1, ...
  bool has_frame = false;

  // (num_instances x num_fingers)
  std::vector<double> forces, peak_forces;  // N
  std::vector<int> num_losses;
  std::vector<std::uint8_t> were_in_contact;

  std::vector<double> velocities;  // (num_instances x num_joints), rad/s or m/s, of the latest step()
};

GraspEnvironment::GraspEnvironment(const Device& device, const Scene& scene, const EnvironmentOptions& options)
    : impl_(std::make_unique<Impl>(device, scene, options)) {}
GraspEnvironment::~GraspEnvironment() = default;
GraspEnvironment::GraspEnvironment(GraspEnvironment&&) noexcept = default;
GraspEnvironment& GraspEnvironment::operator=(GraspEnvironment&&) noexcept = default;

int GraspEnvironment::numInstances() const {
  return impl_->batch.numInstances();
}

int GraspEnvironment::numJoints() const {
  return impl_->batch.robots().robots().numJoints();
}

int GraspEnvironment::numFrames() const {
  return impl_->scene.num_steps;
}

double GraspEnvironment::dt() const {
  return impl_->batch.dt();
}

int GraspEnvironment::controlPeriod() const {
  return taxelsim::controlPeriod(impl_->scene);
}

const Scene& GraspEnvironment::scene() const {
  return impl_->scene;
}

void GraspEnvironment::reset(std::span<const std::uint8_t> mask, std::span<const std::uint64_t> episodes) {
  checkLength("mask", mask.size(), impl_->all.size());
  checkLength("episodes", episodes.size(), impl_->all.size());
  if (std::ranges::all_of(mask, [](std::uint8_t chosen) { return chosen == 0; })) return;
  for (std::size_t i = 0; i < mask.size(); ++i) {
    if (!mask[i]) continue;
    impl_->batch.start(static_cast<int>(i), episodes[i]);
    std::fill_n(impl_->velocities.begin() + static_cast<std::ptrdiff_t>(i) * numJoints(), numJoints(), 0.0);
  }
  impl_->batch.firstFrames(mask);
  impl_->has_frame = true;
  impl_->judgeFrames(mask);
}

GraspView GraspEnvironment::observe() const {
  impl_->requireFrame();
  return viewOf(impl_->batch, impl_->scene);
}

void GraspEnvironment::step(std::span<const double> velocities, int num_frames) {
  checkLength("joint velocities", velocities.size(), impl_->all.size() * static_cast<std::size_t>(numJoints()));
  impl_->requireFrame();
  checkJointVelocities(impl_->batch, velocities, impl_->instances);
  impl_->velocities.assign(velocities.begin(), velocities.end());
  advance(num_frames);
}

void GraspEnvironment::advance(int num_frames) {
  impl_->requireFrame();
  for (int frame = 0; frame < num_frames; ++frame) {
    impl_->batch.step(impl_->velocities);
    impl_->judgeFrames(impl_->all);
  }
}

GraspState GraspEnvironment::state() const {
  impl_->requireFrame();
  return {.forces = impl_->forces,
          .peak_forces = impl_->peak_forces,
          .num_losses = impl_->num_losses,
          .were_in_contact = impl_->were_in_contact};
}

GraspVerdict GraspEnvironment::judge(int instance) const {
  if (instance < 0 || instance >= numInstances()) {
    throw Error(ErrorKind::kInput, "instance: " + std::to_string(instance) + " is not allowed: 0 to " + std::to_string(numInstances() - 1));
  }
  impl_->requireFrame();
  return impl_->judges[static_cast<std::size_t>(instance)].verdict();
}

}  // namespace taxelsim
