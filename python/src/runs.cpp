// Runs over whole scenes: data sets and evaluations.
#include <nanobind/stl/array.h>
#include <nanobind/stl/filesystem.h>
#include <nanobind/stl/optional.h>
#include <nanobind/stl/pair.h>
#include <nanobind/stl/string.h>
#include <nanobind/stl/tuple.h>
#include <nanobind/stl/vector.h>

#include <optional>
#include <tuple>
#include <utility>

#include "handles.h"
#include "interruptible.h"
#include "policy_argument.h"
#include "structs.h"
#include "taxelsim/evaluate.h"
#include "taxelsim/generate.h"
#include "verdict_arrays.h"

namespace taxelsim::python {
namespace {

GenerateResult runGenerate(const DeviceHandle& device, const Scene& scene, const std::filesystem::path& directory, int batch_size,
                           int num_slices, const nb::object& on_progress, const PolicyArgument& policy,
                           const std::vector<std::uint64_t>& episodes, bool repair,
                           const std::optional<std::tuple<std::uint64_t, std::uint64_t>>& shards) {
  const auto run = [&](auto report, const std::atomic<bool>& stop, CallingThread& calling_thread) {
    return generate(device.get(), scene, directory,
                    {.batch_size = batch_size,
                     .num_slices = num_slices,
                     .on_progress = report,
                     .repair = repair,
                     .shards = shards ? std::optional(ShardRange{std::get<0>(*shards), std::get<1>(*shards)}) : std::nullopt,
                     .stop = &stop,
                     .policy = policyOf(policy, scene, calling_thread),
                     .episodes = episodes});
  };
  return runInterruptibly<GenerateResult>(on_progress, run, [](const GenerateResult&) {});
}

// on_progress takes (verified, all) shards. Returns the number of shards.
std::uint64_t runFinish(const std::filesystem::path& directory, const nb::object& on_progress) {
  using Shards = std::pair<std::uint64_t, std::uint64_t>;
  std::uint64_t num_shards = 0;
  const auto run = [&](auto report, const std::atomic<bool>& stop, CallingThread&) {
    const auto on_verify = [&](std::uint64_t num_verified, std::uint64_t num_found) {
      report(Shards(num_verified, num_shards = num_found));
    };
    return finishDataset(directory, {.on_verify = on_verify, .stop = &stop});
  };
  runInterruptibly<bool, Shards>(on_progress, run, [](bool) {});
  return num_shards;
}

// complete: list to which the complete evaluations of a run that is interrupted are appended.
std::vector<Evaluation> runEvaluate(const DeviceHandle& device, const Scene& scene, const std::vector<std::string>& controllers,
                                    int batch_size, int num_slices, const nb::object& on_progress, const PolicyArgument& policy,
                                    nb::list complete) {
  using Evaluations = std::vector<Evaluation>;
  const auto run = [&](auto report, const std::atomic<bool>& stop, CallingThread& calling_thread) {
    return evaluate(device.get(), scene, controllers,
                    {.batch_size = batch_size,
                     .num_slices = num_slices,
                     .on_progress = report,
                     .stop = &stop,
                     .policy = policyOf(policy, scene, calling_thread)});
  };
  return runInterruptibly<Evaluations>(on_progress, run, [&](Evaluations evaluations) {
    for (Evaluation& evaluation : evaluations) complete.append(nb::cast(std::move(evaluation)));
  });
}

void bindProgress(nb::module_& module) {
  nb::class_<Progress> progress(module, "Progress", "Progress of generate() or evaluate().");
  addFields(progress, field("episodes_done", &Progress::episodes_done, "Episodes simulated or found on disk."),
            field("num_episodes", &Progress::num_episodes, "Episodes of the whole run."),
            field("frames_done", &Progress::frames_done, "Frames simulated in this run."),
            field("num_frames", &Progress::num_frames, "Frames of the whole run, without those found on disk."),
            field("episodes_resumed", &Progress::episodes_resumed, "Episodes found on disk."),
            field("seconds", &Progress::seconds, "s since this run began simulating."));
  nb::class_<LoadMisses> misses(module, "LoadMisses", "Episodes of one object whose load was out of reach.");
  addFields(
      misses, field("num_episodes", &LoadMisses::num_episodes, "Episodes with the object that this run simulated."),
      field("num_misses", &LoadMisses::num_misses, "Those whose load was out of reach."),
      field("carried", &LoadMisses::carried, "(2), N, smallest and largest load that the object could carry there; 0 without misses."));
  nb::class_<GenerateResult>(module, "GenerateResult", "Result of generate().")
      .def_ro("progress", &GenerateResult::progress, "Progress at the end.")
      .def_ro("complete", &GenerateResult::complete, "Whether the data set is complete.")
      .def_ro("num_load_misses", &GenerateResult::num_load_misses, "Contacts whose load was out of reach.")
      .def_ro("load_misses", &GenerateResult::load_misses, "(num_objects), the same by object.");
}

void bindEvaluation(nb::module_& module) {
  nb::class_<Quantiles> quantiles(module, "Quantiles", "Quantiles of a sample. All NaN if the sample is empty.");
  addFields(quantiles, field("median", &Quantiles::median, "50 %."), field("p95", &Quantiles::p95, "95 %."),
            field("max", &Quantiles::max, "Largest value."));
  nb::class_<Score>(module, "Score", "Statistics of a set of verdicts.")
      .def_ro("name", &Score::name, "Name of the set: a controller, object or range of start errors.")
      .def_ro("start_error", &Score::start_error, "(2), range of start errors of a set in Evaluation.by_start, else 0.")
      .def_ro("num_episodes", &Score::num_episodes, "Number of verdicts.")
      .def_ro("num_successes", &Score::num_successes, "Verdicts that are a success.")
      .def_ro("success_rate", &Score::success_rate, "num_successes / num_episodes; 0 of none.")
      .def_ro("success_low", &Score::success_low, "Lower end of the 95 % Wilson interval.")
      .def_ro("success_high", &Score::success_high, "Upper end of that interval.")
      .def_ro("settling_time", &Score::settling_time, "s, over the episodes that settle.")
      .def_ro("steady_error", &Score::steady_error, "(4), by TASK_MEASURES, over the episodes in contact to the end.")
      .def_ro("peak_force", &Score::peak_force, "N, largest clean total force of each episode.")
      .def_ro("num_lost", &Score::num_lost, "Episodes that lost contact at least once.")
      .def_ro("num_saturated", &Score::num_saturated, "Episodes in which a taxel was at its upper end.")
      .def("__repr__", [](const Score& self) {
        return "<taxelsim.Score " + self.name + ": " + std::to_string(self.num_successes) + " of " + std::to_string(self.num_episodes) +
               " episodes succeed>";
      });
  nb::class_<Evaluation>(module, "Evaluation", "Evaluation of one controller.")
      .def_ro("controller", &Evaluation::controller, "Name in the scene.")
      .def_prop_ro(
          "verdicts", [](const Evaluation& self) { return arraysOf(self.verdicts); },
          nb::sig("def verdicts(self) -> dict[str, numpy.typing.NDArray[typing.Any]]"),
          R"(Verdict of every episode, as a dict of arrays (num_episodes, ...); a copy.

episode, object (index), success, start_error and steady_error (num_episodes, 4) in the units of TASK_MEASURES, settling_time (s), travel (m),
laps, peak_force (N), saturated (fraction of frames), num_losses, robot (status bits), load_reached.)")
      .def_ro("total", &Evaluation::total, "Score over all episodes.")
      .def_ro("by_object", &Evaluation::by_object, "(num_objects), in the order of the scene.")
      .def_ro("start_measure", &Evaluation::start_measure, "Index into TASK_MEASURES of the start errors of by_start.")
      .def_ro("by_start", &Evaluation::by_start, "Over five equal parts of the range of start errors; empty if all start alike.");
  nb::list names;
  for (const char* name : kTaskMeasureNames) names.append(name);
  module.attr("TASK_MEASURES") = nb::tuple(names);
}

}  // namespace

void bindRuns(nb::module_& module) {
  bindProgress(module);
  bindEvaluation(module);
  module.def("generate", &runGenerate, "device"_a, "scene"_a, "directory"_a, "batch_size"_a, "num_slices"_a, "on_progress"_a.none(),
             "policy"_a.none(), "episodes"_a, "repair"_a, "shards"_a.none());
  module.def("finish", &runFinish, "directory"_a, "on_progress"_a = nb::none());
  module.def("evaluate", &runEvaluate, "device"_a, "scene"_a, "controllers"_a, "batch_size"_a, "num_slices"_a, "on_progress"_a.none(),
             "policy"_a.none(), "complete"_a);
}

}  // namespace taxelsim::python
