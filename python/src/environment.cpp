// Batches of episodes. Python's Environment checks arrays before it calls the class here.
#include "taxelsim/environment.h"

#include <nanobind/ndarray.h>
#include <nanobind/stl/array.h>
#include <nanobind/stl/pair.h>
#include <nanobind/stl/string.h>
#include <nanobind/stl/tuple.h>
#include <nanobind/stl/vector.h>

#include <limits>
#include <optional>
#include <tuple>
#include <vector>

#include "environment_views.h"
#include "handles.h"
#include "shared.h"
#include "shared_arrays.h"
#include "verdict_arrays.h"
#include "without_gil.h"

namespace taxelsim::python {
namespace {

template <typename Element>
using Column = nb::ndarray<const Element, nb::ndim<1>, nb::c_contig, nb::device::cpu>;
template <typename Element>
using Table = nb::ndarray<const Element, nb::ndim<2>, nb::c_contig, nb::device::cpu>;

static_assert(sizeof(Twist) == 6 * sizeof(double));

// An Environment whose images another interface of the GPU may share.
class SharedEnvironment : public Shared<Environment> {
 public:
  // `platform`: that interface, if any.
  SharedEnvironment(const Device& device, const Scene& scene, const EnvironmentOptions& options, std::optional<interop::Platform> platform)
      : Shared(device, scene, options) {
    if (platform) shared_.emplace(batch().simulator(), *platform);
  }

  // Calls `use(environment)`, which computes frames, in the order of the streams that use the images.
  template <typename Use>
  void computeWith(Use use) {
    with([&](Environment& environment) {
      if (shared_) shared_->get().holdNextStep();
      use(environment);
      if (shared_) shared_->get().releaseStep();
    });
  }

  SharedArrays* shared() { return shared_ ? &shared_->get() : nullptr; }

  template <typename Use>
  auto withShared(Use use) {
    return with([&](Environment&) { return use(requireShared(shared())); });
  }

 private:
  std::optional<Owned<SharedArrays>> shared_;  // destroyed before the environment
};

void init(SharedEnvironment* self, const DeviceHandle& device, const Scene& scene, int num_instances, const OutputOptions& outputs,
          int max_regions, std::optional<interop::Platform> platform) {
  const EnvironmentOptions options{
      .num_instances = num_instances, .outputs = outputs, .max_regions = max_regions, .export_memory = platform.has_value()};
  new (self) SharedEnvironment(device.get(), scene, options, platform);
}

void resetEpisodes(SharedEnvironment& self, const Column<std::uint8_t>& mask, const Column<std::uint64_t>& episodes) {
  self.computeWith([&](Environment& environment) {
    environment.reset({mask.data(), mask.shape(0)}, {episodes.data(), episodes.shape(0)});
  });
}

// The robots take the action, then follow it for some frames. Waits for the last one.
template <typename Act>
void step(SharedEnvironment& self, int num_frames, Act act) {
  self.computeWith([&](Environment& environment) {
    act(environment);
    for (int frame = 0; frame < num_frames; ++frame) environment.step();
    environment.observe();
  });
}

void stepTwists(SharedEnvironment& self, const Table<double>& twists, int num_frames) {
  step(self, num_frames, [&](Environment& environment) {
    environment.act({reinterpret_cast<const Twist*>(twists.data()), twists.shape(0)});
  });
}

void stepJoints(SharedEnvironment& self, const Table<double>& velocities, int num_frames) {
  step(self, num_frames, [&](Environment& environment) { environment.actJoints({velocities.data(), velocities.size()}); });
}

void advance(SharedEnvironment& self, int num_frames) {
  step(self, num_frames, [](Environment&) {});
}

nb::dict arrays(nb::handle self) {
  auto& shared = nb::cast<SharedEnvironment&>(self);
  const EnvironmentView view = shared.with([](Environment& environment) { return environment.observe(); });
  const Sensor& sensor = shared.get().model().sensor();
  nb::dict result = arraysOf(view, sensor, shared.get().numSensors(), self);
  if (shared.shared() == nullptr) return result;
  std::vector<std::size_t> rows{view.active.size()};
  if (shared.get().numSensors() > 1) rows.push_back(static_cast<std::size_t>(shared.get().numSensors()));
  result.update(imagesOf(shared.shared()->frame(), sensor, rows, {self, shared.shared()->device()}));
  return result;
}

nb::dict taskArrays(nb::handle self) {
  const TaskState state = nb::cast<SharedEnvironment&>(self).with([](Environment& environment) { return environment.taskState(); });
  return arraysOf(state, self);
}

nb::dict judge(SharedEnvironment& self, const Column<int>& instances) {
  std::vector<Verdict> verdicts;
  self.with([&](Environment& environment) {
    for (std::size_t k = 0; k < instances.shape(0); ++k) verdicts.push_back(environment.judge(instances.data()[k]));
  });
  return arraysOf(verdicts);
}

nb::object episodeKeys(const Column<std::uint64_t>& seeds, const Column<std::uint32_t>& instances,
                       const Column<std::uint64_t>& num_resets) {
  const std::size_t size = seeds.shape(0);
  if (instances.shape(0) != size || num_resets.shape(0) != size) throw nb::value_error("arrays of different lengths");
  auto* const keys = new std::uint64_t[size];
  const nb::capsule owner(keys, [](void* p) noexcept { delete[] static_cast<std::uint64_t*>(p); });
  for (std::size_t i = 0; i < size; ++i) keys[i] = episodeKey(seeds.data()[i], instances.data()[i], num_resets.data()[i]);
  return nb::ndarray<nb::numpy, std::uint64_t>(keys, {size}, owner).cast();
}

// Tolerances by TaskMeasure (NaN: no criterion), laps, travel, hold.
std::tuple<std::array<double, kNumTaskMeasures>, double, double, double> taskOf(const Scene& scene) {
  std::array<double, kNumTaskMeasures> tolerances;
  for (std::size_t m = 0; m < tolerances.size(); ++m) {
    const std::optional<TaskCriterion>& criterion = scene.task->criteria[m];
    tolerances[m] = criterion ? criterion->tolerance : std::numeric_limits<double>::quiet_NaN();
  }
  return {tolerances, scene.task->laps, scene.task->travel, scene.task->hold};
}

std::pair<double, double> servoLimits(const Scene& scene) {
  const TactileServo& servo = scene.controllers.front().servo;
  return {servo.max_linear_velocity, servo.max_angular_velocity};
}

// Name, whether it is revolute, velocity limit, and lower and upper position limit of each joint; empty without joints.
std::vector<std::tuple<std::string, bool, double, double, double>> jointsOf(const Scene& scene) {
  std::vector<std::tuple<std::string, bool, double, double, double>> joints;
  const auto* robot = std::get_if<Manipulator>(&scene.robot);
  if (robot == nullptr) return joints;
  for (const Joint& joint : robot->joints)
    joints.emplace_back(joint.name, joint.type == JointType::kRevolute, joint.max_velocity, joint.lower, joint.upper);
  return joints;
}

}  // namespace

void bindEnvironment(nb::module_& module) {
  nb::class_<SharedEnvironment> environment(module, "Environment", "The batch behind taxelsim.Environment.");
  bindShared(environment);
  environment
      .def("__init__", &init, "device"_a, "scene"_a, "num_instances"_a, "outputs"_a, "max_regions"_a, "platform"_a.none(),
           nb::call_guard<WithoutGil>())
      .def("reset", &resetEpisodes, "mask"_a, "episodes"_a)
      .def("step", &stepTwists, "twists"_a, "num_frames"_a)
      .def("step_joints", &stepJoints, "velocities"_a, "num_frames"_a)
      .def("advance", &advance, "num_frames"_a)
      .def("arrays", &arrays)
      .def("task_arrays", &taskArrays)
      .def("judge", &judge, "instances"_a)
      .def_prop_ro("num_instances", [](const SharedEnvironment& self) { return self.get().numInstances(); })
      .def_prop_ro("num_sensors", [](const SharedEnvironment& self) { return self.get().numSensors(); })
      .def_prop_ro("num_joints", [](const SharedEnvironment& self) { return self.get().numJoints(); })
      .def_prop_ro("num_frames", [](const SharedEnvironment& self) { return self.get().numFrames(); })
      .def_prop_ro("control_period", [](const SharedEnvironment& self) { return self.get().controlPeriod(); })
      .def_prop_ro("dt", [](const SharedEnvironment& self) { return self.get().dt(); });
  module.def("episode_keys", &episodeKeys, "seeds"_a, "instances"_a, "num_resets"_a);
  module.def("task_of", &taskOf, "scene"_a, "Tolerances by TASK_MEASURES (NaN: no criterion), laps, travel (m), hold (s).");
  module.def("joints_of", &jointsOf, "scene"_a,
             "Name, whether it is revolute, velocity limit (rad/s or m/s), lower and upper position limit (rad or m) of each joint.");
  module.def("servo_limits", &servoLimits, "scene"_a, "Largest linear (m/s) and angular velocity (rad/s) of the first controller.");
}

}  // namespace taxelsim::python
