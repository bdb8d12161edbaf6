// How well controllers do what a scene's task asks: the same episodes for every controller, judged one by one, then counted.
#pragma once

#include <array>
#include <atomic>
#include <cstdint>
#include <functional>
#include <limits>
#include <string>
#include <vector>

#include "taxelsim/device.h"
#include "taxelsim/progress.h"
#include "taxelsim/scene.h"
#include "taxelsim/task.h"
#include "taxelsim/verdict.h"

namespace taxelsim {

struct Quantiles {
  double median = std::numeric_limits<double>::quiet_NaN();  // all NaN of nothing
  double p95 = std::numeric_limits<double>::quiet_NaN();
  double max = std::numeric_limits<double>::quiet_NaN();
};

// Verdicts, counted.
struct Score {
  std::string name;
  std::array<double, 2> start_error{0, 0};  // of a score by start: from, to
  std::uint64_t num_episodes = 0;
  std::uint64_t num_successes = 0;
  // Of the success rate: Wilson's interval at 95 % (E. B. Wilson, J. Am. Stat. Assoc. 22, 1927).
  double success_rate = 0, success_low = 0, success_high = 1;
  Quantiles settling_time;                               // s, of those that settle
  std::array<Quantiles, kNumTaskMeasures> steady_error;  // of all that are in contact to the end
  Quantiles peak_force;                                  // N
  std::uint64_t num_lost = 0;                            // episodes that lost contact at least once
  std::uint64_t num_saturated = 0;                       // in which a taxel was at its upper end
  std::array<std::uint64_t, 4> num_robot{};              // in which each bit of Verdict::robot came up
};

struct Evaluation {
  std::string controller;
  std::vector<Verdict> verdicts;  // (num_episodes), in order
  Score total;
  std::vector<Score> by_object;  // (objects)
  int start_measure = 0;         // the TaskMeasure whose errors at the start differ most for their tolerance
  std::vector<Score> by_start;   // five equal parts of their range; none if all start alike
};

struct EvaluateOptions {
  int batch_size = 2048;  // instances over all slices, >= 1; does not change a verdict
  int num_slices = 2;
  // Called after every turn of a slice by a thread of evaluate()'s own; num_episodes counts those of all controllers. What it throws
  // evaluate() throws.
  std::function<void(const Progress&)> on_progress{};
  const std::atomic<bool>* stop = nullptr;  // evaluate() then returns the controllers that are done
};

// Plays episodes 0 to num_episodes - 1 (at most 2^24) of the scene with each of the controllers, which are named as in the scene; none: all
// of them. Waits. Throws Error(kInput) for a scene without a task and for a name that it does not have, and what Model and Simulator throw.
std::vector<Evaluation> evaluate(const Device& device, const Scene& scene, const std::vector<std::string>& controllers = {},
                                 const EvaluateOptions& options = {});

// Counts verdicts.
Score scoreOf(const std::string& name, const std::vector<Verdict>& verdicts);

}  // namespace taxelsim
