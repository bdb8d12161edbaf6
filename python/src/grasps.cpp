// Batches of grasps and their evaluations. Python's Environment checks arrays before it calls the class here.
#include <nanobind/ndarray.h>
#include <nanobind/stl/optional.h>
#include <nanobind/stl/string.h>
#include <nanobind/stl/tuple.h>
#include <nanobind/stl/vector.h>

#include <algorithm>
#include <tuple>

#include "environment_views.h"
#include "handles.h"
#include "interruptible.h"
#include "policy_argument.h"
#include "shared.h"
#include "taxelsim/grasp_environment.h"
#include "taxelsim/grasp_evaluation.h"

namespace taxelsim::python {
namespace {

template <typename Element>
using Column = nb::ndarray<const Element, nb::ndim<1>, nb::c_contig, nb::device::cpu>;
template <typename Element>
using Table = nb::ndarray<const Element, nb::ndim<2>, nb::c_contig, nb::device::cpu>;

// complete: list to which the complete evaluations of a run that is interrupted are appended.
std::vector<GraspEvaluation> runEvaluateGrasp(const DeviceHandle& device, const Scene& scene, const std::vector<double>& gains,
                                              int batch_size, const nb::object& on_progress, const PolicyArgument& policy,
                                              nb::list complete) {
  using Evaluations = std::vector<GraspEvaluation>;
  const auto run = [&](auto report, const std::atomic<bool>& stop, CallingThread& calling_thread) {
    return evaluateGrasp(
        device.get(), scene, gains,
        {.batch_size = batch_size, .on_progress = report, .stop = &stop, .policy = policyOf(policy, scene, calling_thread)});
  };
  return runInterruptibly<Evaluations>(on_progress, run, [&](Evaluations evaluations) {
    for (GraspEvaluation& evaluation : evaluations) complete.append(nb::cast(std::move(evaluation)));
  });
}

// Array of its own (num_episodes), or (num_episodes, num_fingers) with num_fingers > 0, filled by value(episode, finger).
template <typename Element, typename Value>
nb::object filled(std::size_t num_episodes, std::size_t num_fingers, Value value) {
  const std::size_t width = std::max<std::size_t>(num_fingers, 1);
  auto* const values = new Element[num_episodes * width];
  const nb::capsule owner(values, [](void* p) noexcept { delete[] static_cast<Element*>(p); });
  for (std::size_t i = 0; i < num_episodes; ++i) {
    for (std::size_t f = 0; f < width; ++f) values[i * width + f] = value(i, f);
  }
  const std::size_t shape[2] = {num_episodes, width};
  return nb::ndarray<nb::numpy, Element>(values, num_fingers == 0 ? 1 : 2, shape, owner).cast();
}

nb::dict graspVerdictArrays(const std::vector<GraspVerdict>& verdicts, std::size_t num_fingers) {
  nb::dict arrays;
  arrays["episode"] = filled<std::uint64_t>(verdicts.size(), 0, [&](auto i, auto) { return verdicts[i].episode; });
  arrays["success"] = filled<bool>(verdicts.size(), 0, [&](auto i, auto) { return verdicts[i].success; });
  const auto add = [&]<typename Member>(const char* name, Member FingerVerdict::*member) {
    arrays[name] = filled<Member>(verdicts.size(), num_fingers, [&](auto i, auto f) { return verdicts[i].fingers[f].*member; });
  };
  add("held", &FingerVerdict::held);
  add("target_force", &FingerVerdict::target);
  add("force_error", &FingerVerdict::force_error);
  add("settling_time", &FingerVerdict::settling_time);
  add("peak_force", &FingerVerdict::peak_force);
  add("drift", &FingerVerdict::drift);
  add("num_losses", &FingerVerdict::num_losses);
  return arrays;
}

using SharedGrasps = Shared<GraspEnvironment>;

void bindBatch(nb::module_& module) {
  nb::class_<SharedGrasps>(module, "GraspEnvironment", "The batch behind taxelsim.Environment of a scene of kind grasp.")
      .def(
          "__init__",
          [](SharedGrasps* self, const DeviceHandle& device, const Scene& scene, int num_instances, const OutputOptions& outputs) {
            new (self) SharedGrasps(device.get(), scene, EnvironmentOptions{.num_instances = num_instances, .outputs = outputs});
          },
          "device"_a, "scene"_a, "num_instances"_a, "outputs"_a, nb::call_guard<WithoutGil>())
      .def(
          "reset",
          [](SharedGrasps& self, const Column<std::uint8_t>& mask, const Column<std::uint64_t>& episodes) {
            self.with([&](GraspEnvironment& batch) { batch.reset({mask.data(), mask.shape(0)}, {episodes.data(), episodes.shape(0)}); });
          },
          "mask"_a, "episodes"_a)
      .def(
          "step_joints",
          [](SharedGrasps& self, const Table<double>& velocities, int num_frames) {
            self.with([&](GraspEnvironment& batch) { batch.step({velocities.data(), velocities.size()}, num_frames); });
          },
          "velocities"_a, "num_frames"_a)
      .def(
          "advance", [](SharedGrasps& self, int num_frames) { self.with([&](GraspEnvironment& batch) { batch.advance(num_frames); }); },
          "num_frames"_a)
      .def("arrays",
           [](nb::handle self) {
             const GraspView view = nb::cast<SharedGrasps&>(self).with([](GraspEnvironment& batch) { return batch.observe(); });
             return arraysOf(view, self);
           })
      .def("task_arrays",
           [](nb::handle self) {
             auto& shared = nb::cast<SharedGrasps&>(self);
             return arraysOf(shared.with([](GraspEnvironment& batch) { return batch.state(); }), shared.get().numInstances(), self);
           })
      .def(
          "judge",
          [](SharedGrasps& self, const Column<int>& instances) {
            std::vector<GraspVerdict> verdicts;
            self.with([&](GraspEnvironment& batch) {
              for (std::size_t k = 0; k < instances.shape(0); ++k) verdicts.push_back(batch.judge(instances.data()[k]));
            });
            return graspVerdictArrays(verdicts, self.get().scene().grasp->fingers.size());
          },
          "instances"_a)
      .def_prop_ro("num_instances", [](const SharedGrasps& self) { return self.get().numInstances(); })
      .def_prop_ro("num_joints", [](const SharedGrasps& self) { return self.get().numJoints(); })
      .def_prop_ro("num_frames", [](const SharedGrasps& self) { return self.get().numFrames(); })
      .def_prop_ro("dt", [](const SharedGrasps& self) { return self.get().dt(); })
      .def_prop_ro("control_period", [](const SharedGrasps& self) { return self.get().controlPeriod(); });
  module.def(
      "grasp_gain_of", [](const Scene& scene) { return scene.grasp->gain; }, "scene"_a, "1/s, gain of the scene, of kind grasp.");
  module.def(
      "grasp_task_of",
      [](const Scene& scene) {
        const GraspTask& task = scene.grasp->task;
        std::vector<std::string> fingers;
        for (const GraspFinger& finger : scene.grasp->fingers)
          fingers.push_back(scene.grasp->sensors[static_cast<std::size_t>(finger.sensor)].name);
        return std::tuple(task.tolerance, task.hold, task.drift, fingers);
      },
      "scene"_a, "Tolerance, fraction of the target force; hold, s; drift, m, or None; sensors of the fingers.");
}

void bindScores(nb::module_& module) {
  nb::class_<FingerScore>(module, "FingerScore",
                          "Statistics of one finger, or of all fingers of an episode together: then of the largest value of its fingers.")
      .def_ro("name", &FingerScore::name, "Name of the finger's sensor, or \"all fingers\".")
      .def_ro("num_episodes", &FingerScore::num_episodes, "Number of verdicts.")
      .def_ro("num_held", &FingerScore::num_held, "Episodes in which the finger, or every finger, held.")
      .def_ro("held_rate", &FingerScore::held_rate, "num_held / num_episodes; 0 of none.")
      .def_ro("held_low", &FingerScore::held_low, "Lower end of the 95 % Wilson interval.")
      .def_ro("held_high", &FingerScore::held_high, "Upper end of that interval.")
      .def_ro("force_error", &FingerScore::force_error, "N, root mean square error at the end of each episode.")
      .def_ro("settling_time", &FingerScore::settling_time, "s, over the episodes that settle.")
      .def_ro("peak_force", &FingerScore::peak_force, "N.")
      .def_ro("drift", &FingerScore::drift, "m, of the centre of pressure, over the episodes in contact to the end.")
      .def_ro("num_lost", &FingerScore::num_lost, "Episodes that lost contact at least once.")
      .def("__repr__", [](const FingerScore& self) {
        return "<taxelsim.FingerScore " + self.name + ": " + std::to_string(self.num_held) + " of " + std::to_string(self.num_episodes) +
               " episodes held>";
      });
}

}  // namespace

void bindGrasps(nb::module_& module) {
  bindBatch(module);
  bindScores(module);
  nb::class_<GraspEvaluation>(module, "GraspEvaluation", "Evaluation of one gain of a grasp, or of a policy.")
      .def_ro("gain", &GraspEvaluation::gain, "1/s, gain of the force control; 0 of a policy.")
      .def_ro("policy", &GraspEvaluation::policy, "Name of the policy; empty for a gain.")
      .def_prop_ro(
          "verdicts", [](const GraspEvaluation& self) { return graspVerdictArrays(self.verdicts, self.fingers.size()); },
          nb::sig("def verdicts(self) -> dict[str, numpy.typing.NDArray[typing.Any]]"),
          R"(Verdict of every episode, as a dict of arrays (num_episodes) or, by finger in the order of `fingers`, (num_episodes, num_fingers); a copy.

episode, success (whether every finger held). By finger: held, target_force (N), force_error (N, root mean square at the end), settling_time
(s; NaN if it does not settle), peak_force (N), drift (m; NaN if contact was lost), num_losses.)")
      .def_ro("total", &GraspEvaluation::total, "Score over all fingers of each episode.")
      .def_ro("fingers", &GraspEvaluation::fingers, "(num_fingers), in the order of the scene.");
  module.def("evaluate_grasp", &runEvaluateGrasp, "device"_a, "scene"_a, "gains"_a, "batch_size"_a, "on_progress"_a.none(),
             "policy"_a.none(), "complete"_a);
}

}  // namespace taxelsim::python
