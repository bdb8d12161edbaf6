#include "policy_argument.h"

#include <nanobind/ndarray.h>

#include <algorithm>

#include "environment_views.h"
#include "taxelsim/error.h"

namespace taxelsim::python {
namespace {

using Commands = nb::ndarray<const double, nb::ndim<2>, nb::c_contig, nb::device::cpu>;

// Calls act(arrays, instances, first_instance). commands: (num_instances x width), of which the rows of the instances that are due are
// written.
void callPolicy(const nb::callable& act, const nb::dict& arrays, std::span<const int> due, int first_instance, std::size_t num_instances,
                std::span<double> commands) {
  const std::size_t num_due = due.size(), width = commands.size() / num_instances;
  const nb::object instances = nb::ndarray<nb::numpy, const int>(due.data(), {num_due}, nb::none()).cast();
  const auto found = nb::cast<Commands>(act(arrays, instances, first_instance));
  if (found.shape(0) != num_due || found.shape(1) != width) throw Error(ErrorKind::kInput, "policy: one command per instance expected");
  for (std::size_t k = 0; k < num_due; ++k) {
    std::copy_n(found.data() + width * k, width, &commands[width * static_cast<std::size_t>(due[k])]);
  }
}

}  // namespace

std::optional<Policy> policyOf(const PolicyArgument& argument, const Scene& scene, CallingThread& calling_thread) {
  if (!argument) return {};
  const auto& [name, id, by_joints, outputs, function] = *argument;
  const auto call = [&](const PolicyInput& input, std::span<double> commands) {
    const std::size_t num_instances = input.view.active.size();
    calling_thread.run([&] {
      const auto num_sensors = static_cast<int>(input.view.X_WS.size() / num_instances);
      callPolicy(function, arraysOf(input.view, scene.sensor, num_sensors, nb::none()), input.instances, input.first_instance,
                 num_instances, commands);
    });
  };
  const auto call_grasp = [&](const GraspPolicyInput& input, std::span<double> commands) {
    calling_thread.run(
        [&] { callPolicy(function, arraysOf(input.view, nb::none()), input.instances, 0, input.view.episodes.size(), commands); });
  };
  if (scene.grasp) return Policy{.name = name, .id = id, .outputs = outputs, .act_grasp = call_grasp};
  if (by_joints) return Policy{.name = name, .id = id, .outputs = outputs, .act_joints = call};
  return Policy{.name = name, .id = id, .outputs = outputs, .act = [call](const PolicyInput& input, std::span<Twist> twists) {
                  call(input, {reinterpret_cast<double*>(twists.data()), 6 * twists.size()});
                }};
}

}  // namespace taxelsim::python
