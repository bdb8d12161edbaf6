#include "taxelsim/environment.h"

#include <algorithm>
#include <array>
#include <bit>
#include <optional>
#include <stdexcept>
#include <string>
#include <type_traits>
#include <vector>

#include "base/length_check.h"
#include "base/philox.h"
#include "dataset/scene_difference.h"
#include "episodes/batch.h"
#include "episodes/environment_view.h"
#include "episodes/episode_batch.h"
#include "episodes/task_judge.h"
#include "scene/scene_checks.h"
#include "taxelsim/error.h"

namespace taxelsim {
namespace {

const Scene& checked(const Scene& scene, const EnvironmentOptions& options) {
  checkCount("num_instances", options.num_instances);
  if (scene.kind != Scene::Kind::kServo) {
    throw Error(ErrorKind::kInput, scene.file.generic_string() + ": kind: " + wordOf(scene.kind) + " found, an environment needs servo");
  }
  if (options.max_regions != 0 && !hasContactFeatures(options.outputs)) {
    throw Error(ErrorKind::kInput, "max_regions: " + std::to_string(options.max_regions) + " is not allowed: 0 without contact features");
  }
  checkScene(scene);
  return scene;
}

// The first setting that differs, "readout.trigger: 0.02 there, 0.03 requested"; empty if both sensors give the same results. The name
// changes no result.
std::string differenceOf(Sensor found, const Sensor& expected) {
  found.name = expected.name;
  return dataset::describeSceneDifference(sensorText(found), sensorText(expected));
}

bool areEqual(const Shape& a, const Shape& b) {
  if (a.index() != b.index()) return false;
  const auto equals_b = [&](const auto& shape) {
    using Kind = std::remove_cvref_t<decltype(shape)>;
    const Kind& other = std::get<Kind>(b);
    if constexpr (std::is_same_v<Kind, Mesh>) {
      return shape.vertices == other.vertices && shape.triangles == other.triangles;
    } else if constexpr (std::is_empty_v<Kind>) {
      return true;
    } else {
      using Numbers = std::array<double, sizeof(Kind) / sizeof(double)>;
      return std::bit_cast<Numbers>(shape) == std::bit_cast<Numbers>(other);
    }
  };
  return std::visit(equals_b, a);
}

const Model& checked(const Model& model, const Scene& scene) {
  const auto refuse = [](const std::string& what) {
    throw Error(ErrorKind::kInput, "model: " + what + "; make the model from modelOptionsOf(scene)");
  };
  if (const std::string difference = differenceOf(model.sensor(), scene.sensor); !difference.empty()) {
    refuse("another sensor than the scene's: " + difference);
  }
  if (model.objects().size() != scene.objects.size()) {
    refuse(std::to_string(model.objects().size()) + " objects are not allowed: the scene has " + std::to_string(scene.objects.size()));
  }
  for (std::size_t i = 0; i < scene.objects.size(); ++i) {
    if (!areEqual(model.objects()[i].shape, scene.objects[i].object.shape)) {
      refuse("object " + std::to_string(i) + " (" + model.objects()[i].name + ") differs from the scene's");
    }
  }
  return model;
}

EpisodePlan planOf(const Scene& scene, const EnvironmentOptions& options) {
  EpisodePlan plan(scene, options.outputs, options.max_regions);
  plan.export_memory = options.export_memory;
  return plan;
}

}  // namespace

std::uint64_t episodeKey(std::uint64_t seed, std::uint32_t instance, std::uint64_t num_resets) {
  const auto low = [](std::uint64_t value) { return static_cast<std::uint32_t>(value); };
  // The last word holds the purpose as in the counters of base/philox.cpp, so that no other random number has this counter.
  const std::array<std::uint32_t, 4> words =
      philox({low(num_resets), low(num_resets >> 32), instance, static_cast<std::uint32_t>(Purpose::kEpisodeKey) << 24},
             {low(seed), low(seed >> 32)});
  return words[0] | static_cast<std::uint64_t>(words[1]) << 32;
}

struct Environment::Impl {
  Impl(const Model& model_to_use, const Scene& scene_to_run, const EnvironmentOptions& options)
      : scene(checked(scene_to_run, options)),
        model(checked(model_to_use, scene_to_run)),
        plan(planOf(scene, options)),
        batch(model, plan, options.num_instances),
        computed(options.num_instances, 0),
        draws(options.num_instances),
        has_run(options.num_instances, 0) {
    if (scene.task) judge.emplace(plan, options.num_instances);
  }

  void requireFrame() const {
    if (!has_frame) throw std::logic_error("environment: reset() must come first");
  }

  TaskJudge& requireJudge() {
    if (!judge) throw Error(ErrorKind::kInput, scene.file.generic_string() + ": this scene has no `task`, which a judgement needs");
    requireFrame();
    finishFrame();
    return *judge;
  }

  // Waits for the submitted frame, if any.
  void finishFrame() {
    if (!is_submitted) return;
    is_submitted = false;
    batch.read();
    batch.beginFrame();
    judgeFrames(batch.active());
  }

  // Judges the new frames of some instances.
  void judgeFrames(std::span<const std::uint8_t> instances) {
    if (!judge) return;
    for (int i = 0; i < batch.numInstances(); ++i) {
      if (instances[i] && batch.frameNumbers()[i] == 0) judge->begin(i, batch.record(i));
    }
    FrameContext context = batch.context();
    context.active = instances;
    judge->frame(batch.frame(), context);
  }

  void reset(std::span<const std::uint8_t> mask, std::span<const std::uint64_t> episodes);

  const Scene scene;
  Model model;
  EpisodePlan plan;
  EpisodeBatch batch;
  std::optional<TaskJudge> judge;  // if the scene has a task
  bool is_submitted = false;       // a frame that has not been read
  bool has_frame = false;          // reset() has been called
  bool is_prepared = false;

  // (num_instances)
  std::vector<std::uint8_t> computed;  // computed by the latest reset()
  std::vector<EpisodeDraw> draws;
  std::vector<std::uint8_t> has_run;
};

void Environment::Impl::reset(std::span<const std::uint8_t> mask, std::span<const std::uint64_t> episodes) {
  const int num_instances = batch.numInstances();
  checkLength("mask", mask.size(), static_cast<std::size_t>(num_instances));
  checkLength("episodes", episodes.size(), static_cast<std::size_t>(num_instances));
  // Drawn in advance, so that an error changes nothing.
  for (int i = 0; i < num_instances; ++i) {
    if (mask[i]) draws[i] = plan.drawer.draw(episodes[i]);
  }
  finishFrame();
  for (int i = 0; i < num_instances; ++i) {
    computed[i] = mask[i] != 0;
    if (!computed[i]) continue;
    batch.start(i, episodes[i], draws[i]);
    has_run[i] = 1;
  }
  if (std::find(computed.begin(), computed.end(), 1) == computed.end()) return;
  has_frame = true;
  if (!is_prepared) batch.prepare();
  is_prepared = true;
  batch.computeFirstFrames(computed);
  judgeFrames(computed);
}

Environment::Environment(const Model& model, const Scene& scene, const EnvironmentOptions& options)
    : impl_(std::make_unique<Impl>(model, scene, options)) {}

Environment::Environment(const Device& device, const Scene& scene, const EnvironmentOptions& options)
    : Environment(Model(device, modelOptionsOf(checked(scene, options))), scene, options) {}

Environment::~Environment() = default;
Environment::Environment(Environment&&) noexcept = default;
Environment& Environment::operator=(Environment&&) noexcept = default;

int Environment::numInstances() const {
  return impl_->batch.numInstances();
}

int Environment::numSensors() const {
  return impl_->plan.num_sensors;
}

int Environment::numJoints() const {
  return impl_->plan.num_joints;
}

int Environment::numFrames() const {
  return impl_->plan.num_frames;
}

int Environment::controlPeriod() const {
  return impl_->plan.control_period;
}

double Environment::dt() const {
  return impl_->plan.dt;
}

const Scene& Environment::scene() const {
  return impl_->scene;
}

const Model& Environment::model() const {
  return impl_->model;
}

Simulator& Environment::simulator() {
  return impl_->batch.simulator();
}

void Environment::reset(std::span<const std::uint8_t> mask, std::span<const std::uint64_t> episodes) {
  impl_->reset(mask, episodes);
}

EnvironmentView Environment::observe() {
  impl_->requireFrame();
  impl_->finishFrame();
  return viewOf(impl_->batch);
}

void Environment::act(std::span<const Twist> twists) {
  checkLength("twists", twists.size(), static_cast<std::size_t>(numInstances()));
  impl_->requireFrame();
  impl_->finishFrame();
  impl_->batch.checkActions(twists);
  impl_->batch.act(twists);
}

void Environment::actJoints(std::span<const double> velocities) {
  if (numJoints() == 0) throw Error(ErrorKind::kInput, "joint velocities: this robot has no joints");
  checkLength("joint velocities", velocities.size(), static_cast<std::size_t>(numInstances()) * static_cast<std::size_t>(numJoints()));
  impl_->requireFrame();
  impl_->finishFrame();
  impl_->batch.checkJointActions(velocities);
  impl_->batch.actJoints(velocities);
}

void Environment::step() {
  impl_->requireFrame();
  impl_->finishFrame();
  impl_->batch.advance();
  impl_->batch.setInputs();
  impl_->batch.submit();
  impl_->is_submitted = true;
}

TaskState Environment::taskState() {
  const TaskJudge& task_judge = impl_->requireJudge();
  return {.errors = task_judge.errors(),
          .within = task_judge.within(),
          .contact = task_judge.contact(),
          .travel = task_judge.travel(),
          .laps = task_judge.laps(),
          .peak_force = task_judge.peakForce(),
          .num_losses = task_judge.numLosses()};
}

Verdict Environment::judge(int instance) {
  const TaskJudge& task_judge = impl_->requireJudge();
  if (instance < 0 || instance >= numInstances()) {
    throw Error(ErrorKind::kInput, "instance: " + std::to_string(instance) + " is not allowed: 0 to " + std::to_string(numInstances() - 1));
  }
  if (!impl_->has_run[static_cast<std::size_t>(instance)]) {
    throw std::logic_error("environment: instance " + std::to_string(instance) + " has run no episode");
  }
  return task_judge.verdict(instance);
}

}  // namespace taxelsim
