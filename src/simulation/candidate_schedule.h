// When a batch's candidates are looked after: shaders/keep_candidates.comp.
#pragma once

namespace taxelsim {

// Where objects move too fast, or touch nothing, no instance has candidates, and the two passes that keep and find them are for nothing.
// After a few such frames they are left out, for ever longer; in between they are taken up again to see whether objects have become slow.
class CandidateSchedule {
 public:
  // Whether the frame to come has these passes.
  bool keeps() {
    if (pause_ == 0) return true;
    --pause_;
    return false;
  }

  // What a frame with them has come to: whether any instance has candidates now.
  void found(bool any) {
    if (any) {
      num_without_ = 0;
      next_pause_ = kShortestPause;
    } else if (++num_without_ == kFramesToTell) {
      num_without_ = 0;
      pause_ = next_pause_;
      if (next_pause_ < kLongestPause) next_pause_ *= 2;
    }
  }

 private:
  static constexpr int kFramesToTell = 2;                       // how an object moves takes two poses
  static constexpr int kShortestPause = 4, kLongestPause = 32;  // frames

  int num_without_ = 0;  // frames in a row
  int pause_ = 0;        // frames still to go
  int next_pause_ = kShortestPause;
};

}  // namespace taxelsim
