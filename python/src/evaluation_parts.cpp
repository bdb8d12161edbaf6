// Evaluations in parts.
#include <nanobind/stl/optional.h>
#include <nanobind/stl/pair.h>
#include <nanobind/stl/string.h>
#include <nanobind/stl/tuple.h>
#include <nanobind/stl/vector.h>

#include "handles.h"
#include "interruptible.h"
#include "policy_argument.h"
#include "taxelsim/evaluation_part.h"

namespace taxelsim::python {
namespace {

using FirstAndEnd = std::tuple<std::uint64_t, std::uint64_t>;

EvaluationPart runEvaluatePart(const DeviceHandle& device, const Scene& scene, const std::vector<std::string>& controllers,
                               const FirstAndEnd& episodes, int batch_size, int num_slices, const nb::object& on_progress,
                               const PolicyArgument& policy) {
  const auto run = [&](auto report, const std::atomic<bool>& stop, CallingThread& calling_thread) {
    return evaluatePart(device.get(), scene, controllers,
                        {.batch_size = batch_size,
                         .num_slices = num_slices,
                         .on_progress = report,
                         .stop = &stop,
                         .policy = policyOf(policy, scene, calling_thread),
                         .episodes = EpisodeRange{std::get<0>(episodes), std::get<1>(episodes)}});
  };
  return runInterruptibly<EvaluationPart>(on_progress, run, [](const EvaluationPart&) {});
}

EvaluationPart runEvaluateGraspPart(const DeviceHandle& device, const Scene& scene, const std::vector<double>& gains,
                                    const FirstAndEnd& episodes, int batch_size, const nb::object& on_progress,
                                    const PolicyArgument& policy) {
  const auto run = [&](auto report, const std::atomic<bool>& stop, CallingThread& calling_thread) {
    return evaluateGraspPart(device.get(), scene, gains,
                             {.batch_size = batch_size,
                              .on_progress = report,
                              .stop = &stop,
                              .episodes = EpisodeRange{std::get<0>(episodes), std::get<1>(episodes)},
                              .policy = policyOf(policy, scene, calling_thread)});
  };
  return runInterruptibly<EvaluationPart>(on_progress, run, [](const EvaluationPart&) {});
}

using Parts = std::vector<std::tuple<std::string, const EvaluationPart*>>;

std::vector<NamedPart> named(const Parts& parts) {
  std::vector<NamedPart> all;
  for (const auto& [name, part] : parts) all.push_back({.name = name, .part = *part});
  return all;
}

}  // namespace

void bindEvaluationParts(nb::module_& module) {
  nb::class_<EvaluationPart>(module, "EvaluationPart")
      .def_prop_ro("controllers",
                   [](const EvaluationPart& self) {
                     std::vector<std::string> names;
                     for (const EvaluationPart::Verdicts& evaluation : self.evaluations) names.push_back(evaluation.controller);
                     return names;
                   })
      .def_prop_ro("episodes",
                   [](const EvaluationPart& self) {
                     return FirstAndEnd{self.episodes.first, self.episodes.end};
                   })
      .def_ro("policy", &EvaluationPart::policy)
      .def_ro("device", &EvaluationPart::device)
      .def("text", &evaluationPartText);
  module.def("evaluate_part", &runEvaluatePart, "device"_a, "scene"_a, "controllers"_a, "episodes"_a, "batch_size"_a, "num_slices"_a,
             "on_progress"_a.none(), "policy"_a.none());
  module.def(
      "part_of_episodes",
      [](std::uint64_t num_episodes, std::uint64_t part, std::uint64_t num_parts) {
        const EpisodeRange range = partOfEpisodes(num_episodes, part, num_parts);
        return std::pair(range.first, range.end);
      },
      "num_episodes"_a, "part"_a, "num_parts"_a);
  module.def("parse_evaluation_part", &parseEvaluationPart, "text"_a, "name"_a);
  module.def(
      "check_evaluation_part",
      [](const std::string& name, const EvaluationPart& part, const Scene& scene) {
        checkEvaluationPart({.name = name, .part = part}, scene);
      },
      "name"_a, "part"_a, "scene"_a);
  module.def("evaluate_grasp_part", &runEvaluateGraspPart, "device"_a, "scene"_a, "gains"_a, "episodes"_a, "batch_size"_a,
             "on_progress"_a.none(), "policy"_a.none());
  module.def("gain_name", &gainName, "gain"_a);
  module.def(
      "merge_evaluation_parts", [](const Scene& scene, const Parts& parts) { return mergeEvaluationParts(scene, named(parts)); }, "scene"_a,
      "parts"_a);
  module.def(
      "merge_grasp_parts", [](const Scene& scene, const Parts& parts) { return mergeGraspParts(scene, named(parts)); }, "scene"_a,
      "parts"_a);
}

}  // namespace taxelsim::python
