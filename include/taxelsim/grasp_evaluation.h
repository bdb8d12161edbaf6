/// @file
/// How well the fingers of a scene of kind grasp hold their forces: the same episodes for every gain, judged one by one, then counted.
#pragma once

#include <atomic>
#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "taxelsim/contact_misses.h"
#include "taxelsim/device.h"
#include "taxelsim/evaluate.h"
#include "taxelsim/policy.h"
#include "taxelsim/progress.h"
#include "taxelsim/scene.h"
#include "taxelsim/verdict.h"

namespace taxelsim {

/// Statistics of one finger, or of all fingers of an episode together: then with the largest value of its fingers, and the sum of losses.
struct FingerScore {
  std::string name;                ///< Name of the finger's sensor, or "all fingers".
  std::uint64_t num_episodes = 0;  ///< Number of verdicts.
  std::uint64_t num_held = 0;      ///< Episodes in which the finger, or every finger, held.
  double held_rate = 0;            ///< num_held / num_episodes; 0 of none.
  double held_low = 0;             ///< Lower end of the 95 % Wilson interval (E. B. Wilson 1927).
  double held_high = 1;            ///< Upper end of that interval.
  Quantiles force_error;           ///< N, of FingerVerdict::force_error.
  Quantiles settling_time;         ///< s, over the episodes that settle.
  Quantiles peak_force;            ///< N.
  Quantiles drift;                 ///< m, over the episodes in contact to the end.
  std::uint64_t num_lost = 0;      ///< Episodes that lost contact at least once.
};

/// Evaluation of one gain, or of a policy.
struct GraspEvaluation {
  double gain = 0;                     ///< 1/s, Grasp::gain; 0 of a policy.
  std::string policy = {};             ///< Policy::name; empty for a gain.
  std::vector<GraspVerdict> verdicts;  ///< (num_episodes), in order of episodes.
  FingerScore total;                   ///< Over all fingers of each episode.
  std::vector<FingerScore> fingers;    ///< (num_fingers), in the order of Grasp::fingers.
  std::vector<ContactMisses> misses;   ///< (num_fingers), episodes without contact. evaluateGrasp() of all episodes logs a warning of them.
};

/// Options of evaluateGrasp(). They do not change a verdict.
struct GraspEvaluateOptions {
  int batch_size = 256;  ///< Instances of the hand, >= 1. Default 256.
  /// Called after every frame of a batch from the caller's thread; Progress::num_episodes counts the episodes of all gains. Default: none.
  std::function<void(const Progress&)> on_progress{};
  /// Called with each evaluation as soon as it is complete, in the order of the result. Default: none.
  std::function<void(const GraspEvaluation&)> on_evaluation{};
  /// Graceful stop: when *stop becomes true, evaluateGrasp() returns the gains that are complete. May be set from any thread. Not owned;
  /// must outlive the call. Default: none.
  const std::atomic<bool>* stop = nullptr;
  /// Plays these episodes of the scene only; not empty. graspEvaluationOf() puts the verdicts of ranges together. Default: all.
  std::optional<EpisodeRange> episodes{};
  /// Policy that moves the joints instead of the law of the scene. Its evaluation comes first. Default: none.
  std::optional<Policy> policy{};
};

/// Plays the episodes of a scene of kind grasp with each gain, and judges them by Grasp::task. Submits and waits; blocks until all are
/// judged or *stop is true.
///
/// `gains`: 1/s, > 0 to the simulation rate; empty for that of the scene, or for none if there is a policy. At most 2^24 episodes. Throws
/// Error(kInput) for a scene of another kind, a gain out of range and options out of range, and what Model and Simulator throw.
///
/// Threads: may be called from several threads at once.
std::vector<GraspEvaluation> evaluateGrasp(const Device& device, const Scene& scene, const std::vector<double>& gains = {},
                                           const GraspEvaluateOptions& options = {});

/// The evaluation of a gain from its verdicts, in order of episodes, and its misses.
GraspEvaluation graspEvaluationOf(const Scene& scene, double gain, std::vector<GraspVerdict> verdicts, std::vector<ContactMisses> misses);

}  // namespace taxelsim
