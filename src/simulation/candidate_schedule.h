// Which frames of a batch run the candidate passes: shaders/keep_candidates.comp, find_candidates.comp.
#pragma once

namespace taxelsim {

// Skips both passes while no instance has candidates, since objects move too fast or touch nothing; retries with exponential back-off.
class CandidateSchedule {
 public:
  // Whether the next frame runs the passes. Call once per frame.
  bool keeps() {
    if (pause_ == 0) return true;
    --pause_;
    return false;
  }

  // Result of a frame that ran them: whether any instance has candidates.
  void found(bool any) {
    if (any) {
      num_without_ = 0;
      next_pause_ = kShortestPause;
    } else if (++num_without_ == kMaxWithout) {
      num_without_ = 0;
      pause_ = next_pause_;
      if (next_pause_ < kLongestPause) next_pause_ *= 2;
    }
  }

 private:
  static constexpr int kMaxWithout = 2;                         // frames; a motion takes two poses
  static constexpr int kShortestPause = 4, kLongestPause = 32;  // frames

  int num_without_ = 0;  // frames in a row
  int pause_ = 0;        // frames left
  int next_pause_ = kShortestPause;
};

}  // namespace taxelsim
