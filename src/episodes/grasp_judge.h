// Judges the fingers of one episode of a grasp, on clean forces (taxelsim/verdict.h has the rules).
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "episodes/grasp_batch.h"
#include "taxelsim/grasp.h"
#include "taxelsim/verdict.h"

namespace taxelsim {

class GraspJudge {
 public:
  // What a finger's sensor feels in a frame.
  struct Touch {
    double force = 0;                // N, clean total force
    std::array<double, 2> center{};  // m, clean centre of pressure in the xy plane of S
  };

  // num_frames: of an episode. dt: s, between frames. targets (num_fingers): N.
  GraspJudge(const GraspTask& task, int num_frames, double dt, std::uint64_t episode, std::span<const double> targets);

  // The next frame. touches (num_fingers).
  void frame(std::span<const Touch> touches);

  // After the last frame.
  GraspVerdict verdict() const;

 private:
  struct State {
    double within_since = 0;  // s; NaN while the force is outside of its tolerance
    double square_sum = 0;    // N^2, over the frames of the end
    std::array<double, 2> first_center{};
  };

  void judge(FingerVerdict& finger, State& state, const Touch& touch);

  GraspTask task_;
  int first_held_, num_frames_;  // the end begins with frame first_held_
  double dt_;
  int frame_ = 0;
  GraspVerdict verdict_;
  std::vector<State> states_;
  std::vector<std::uint8_t> touched_;  // (num_fingers), in the preceding frame
};

// Touches of the fingers of an instance in its present frame (num_fingers).
std::vector<GraspJudge::Touch> touchesOf(const GraspBatch& batch, const Grasp& grasp, int instance);

}  // namespace taxelsim
