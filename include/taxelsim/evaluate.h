/// @file
/// How well controllers perform the task of a scene: the same episodes for every controller, judged one by one, then counted.
#pragma once

#include <array>
#include <atomic>
#include <cstdint>
#include <functional>
#include <limits>
#include <optional>
#include <string>
#include <vector>

#include "taxelsim/device.h"
#include "taxelsim/policy.h"
#include "taxelsim/progress.h"
#include "taxelsim/scene.h"
#include "taxelsim/task.h"
#include "taxelsim/verdict.h"

namespace taxelsim {

/// Quantiles of a sample. All NaN if the sample is empty.
struct Quantiles {
  double median = std::numeric_limits<double>::quiet_NaN();  ///< 50 %.
  double p95 = std::numeric_limits<double>::quiet_NaN();     ///< 95 %.
  double max = std::numeric_limits<double>::quiet_NaN();     ///< Largest value.
};

/// Statistics of a set of verdicts.
struct Score {
  std::string name;                                      ///< Name of the set: a controller, object or range of start errors.
  std::array<double, 2> start_error{0, 0};               ///< Range of start errors of a set in Evaluation::by_start, else 0.
  std::uint64_t num_episodes = 0;                        ///< Number of verdicts.
  std::uint64_t num_successes = 0;                       ///< Verdicts that are a success.
  double success_rate = 0;                               ///< num_successes / num_episodes; 0 of none.
  double success_low = 0;                                ///< Lower end of the 95 % Wilson interval (E. B. Wilson 1927).
  double success_high = 1;                               ///< Upper end of that interval.
  Quantiles settling_time;                               ///< s, over the episodes that settle.
  std::array<Quantiles, kNumTaskMeasures> steady_error;  ///< By TaskMeasure, over the episodes in contact to the end.
  Quantiles peak_force;                                  ///< N, largest clean total force of each episode.
  std::uint64_t num_lost = 0;                            ///< Episodes that lost contact at least once.
  std::uint64_t num_saturated = 0;                       ///< Episodes in which a taxel was at its upper end.
  std::array<std::uint64_t, 4> num_robot{};              ///< Episodes in which each bit of Verdict::robot occurred.
};

/// Evaluation of one controller.
struct Evaluation {
  std::string controller;         ///< Name in the scene, or Policy::name.
  std::vector<Verdict> verdicts;  ///< (num_episodes), in order of episodes.
  Score total;                    ///< Over all episodes.
  std::vector<Score> by_object;   ///< (num_objects), in the order of the scene.
  int start_measure = 0;          ///< TaskMeasure whose start errors vary most relative to its tolerance.
  std::vector<Score> by_start;    ///< Over five equal parts of the range of its start errors; empty if all start alike.
};

/// Episodes with the numbers first, ..., end - 1.
struct EpisodeRange {
  std::uint64_t first = 0;  ///< Number of the first episode.
  std::uint64_t end = 0;    ///< Number after the last episode, >= first.

  std::uint64_t size() const { return end - first; }  ///< Number of episodes.
};

/// Options of evaluate(). The others than `policy` and `episodes` do not change a verdict.
struct EvaluateOptions {
  int batch_size = 2048;  ///< Instances over all slices, >= 1. Default 2048.
  int num_slices = 2;     ///< Slices of the batch in flight at once, >= 1. Default 2.
  /// Called after every step of a slice from the thread of evaluate()'s scheduler; Progress::num_episodes counts the episodes of all
  /// controllers. An exception that it throws ends evaluate() and is thrown by it. Default: none.
  std::function<void(const Progress&)> on_progress{};
  /// Called with each evaluation as soon as it is complete, in the order of the result, so that an exception later loses none of them.
  /// Called from the thread of evaluate()'s caller. Default: none.
  std::function<void(const Evaluation&)> on_evaluation{};
  /// Graceful stop: when *stop becomes true, evaluate() returns the controllers that are complete. May be set from any thread. Not owned;
  /// must outlive the call. Default: none.
  const std::atomic<bool>* stop = nullptr;
  /// Policy to evaluate on the same episodes. Its Evaluation is the first of the result. Default: none.
  std::optional<Policy> policy{};
  /// Plays these episodes of the scene only; not empty. evaluation_part.h puts evaluations of ranges together. Default: all.
  std::optional<EpisodeRange> episodes{};
};

/// Plays the episodes of the scene with the policy, if any, and with each of the controllers. Blocks until all are judged
/// or *stop is true.
///
/// `controllers`: names as in the scene, for comparison with a policy; empty for all, or for none if there is a policy. At most 2^24
/// episodes. Throws Error(kInput) for a scene without a task, an unknown name, options out of range and a policy that cannot act in the
/// scene, and what Model, Simulator and the policy throw.
///
/// Threads: may be called from several threads at once. It simulates in one thread of its own.
std::vector<Evaluation> evaluate(const Device& device, const Scene& scene, const std::vector<std::string>& controllers = {},
                                 const EvaluateOptions& options = {});

/// Statistics of verdicts, under a name.
Score scoreOf(const std::string& name, const std::vector<Verdict>& verdicts);

}  // namespace taxelsim
