/// @file
/// A policy of the caller that acts in evaluate() and generate() instead of the scene's controllers.
#pragma once

#include <functional>
#include <span>
#include <string>

#include "taxelsim/environment.h"
#include "taxelsim/grasp_environment.h"
#include "taxelsim/pose.h"
#include "taxelsim/simulator.h"

namespace taxelsim {

/// What a policy observes: one frame of a slice, a part of the batch.
struct PolicyInput {
  EnvironmentView view;            ///< All N instances of the slice. Valid during the call.
  std::span<const int> instances;  ///< (num_due), ascending, >= 1: instances of the view whose control tick is due. Only these may be read.
  /// Number of the view's instance 0 in the whole batch. first_instance + i identifies the memory of a policy that has one for each
  /// instance; frame_numbers[i] == 0 starts a new episode on it.
  int first_instance = 0;
};

/// The same in a scene of kind grasp, whose instances are in lockstep: all episodes of a batch are due at once.
struct GraspPolicyInput {
  GraspView view;                  ///< All N instances of the batch. Valid during the call.
  std::span<const int> instances;  ///< (num_due), 0, 1, ..., >= 1: instances of the view that run an episode. Only these may be read.
};

/// A policy: a function of a batch of observations. Exactly one of `act`, `act_joints` and, in a scene of kind grasp, `act_grasp` must be
/// set.
///
/// It is called once per slice and frame in which any instance is due, for all of them, in the one thread that simulates. An exception that
/// it throws ends the run and is thrown by it. So does a value that is not finite: Error(kInput) names the episode and the instance.
/// Results depend on the batch size if a row that the policy computes depends on other rows, or on the order of the calls.
struct Policy {
  std::string name = "policy";  ///< Name in Evaluation::controller, other than those of the scene's controllers.
  std::string id = {};          ///< Identity that a data set stores, such as the SHA-256 of an ONNX file. Required by generate().
  /// Optional outputs in PolicyInput::view. Default: none.
  OutputOptions outputs = kNoOutputs;
  /// Rows of contact features for regions, 0 to kMaxRegions. As many as the scene records, if it records contact features.
  int max_regions = 0;
  /// Writes the twists (N) of sensor 0 in S, all rows of `instances`. Others are ignored.
  std::function<void(const PolicyInput&, std::span<Twist>)> act{};
  /// The same for joint velocities (N x num_joints; rad/s or m/s) of a manipulator; see Environment::actJoints().
  std::function<void(const PolicyInput&, std::span<double>)> act_joints{};
  /// The same in a scene of kind grasp: writes joint velocities (N x num_joints; rad/s or m/s), all rows of `instances`.
  std::function<void(const GraspPolicyInput&, std::span<double>)> act_grasp{};
};

}  // namespace taxelsim
