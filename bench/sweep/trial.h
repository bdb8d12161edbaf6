// A case under one setting, made ready: the batch that is timed, and beside it a small one that gives every output.
#pragma once

#include <optional>
#include <vector>

#include "sweep/cases.h"
#include "sweep/descent.h"
#include "sweep/outputs.h"
#include "taxelsim/simulator.h"

namespace taxelsim::bench {

// Instances whose outputs are checked in full, and hashed: as many in every run, so that hashes of two runs can be compared.
inline constexpr int kChecked = 64;

// What all trials of a case have in common.
struct Batch {
  std::vector<int> ids;    // (num_instances)
  std::vector<Pose> X_SO;  // (num_instances), of which a smaller batch has the first
};

Batch batchOf(const SweepCase& work, int num_instances);

class Trial {
 public:
  // `setting`: none for what the device gets by itself. `batch` has at least kChecked instances, of which the first `num_instances` are
  // timed. Throws Error where the device refuses.
  Trial(const Device& device, const SweepCase& work, const Batch& batch, int num_instances, const std::optional<Setting>& setting);

  // Instances that the device holds.
  static std::uint64_t mostInstances(const Device& device, const SweepCase& work);

  const Setting& setting() const { return setting_; }
  FrameTime frame();                            // of the timed batch
  FrameView timed() { return timed_->read(); }  // the outputs of the last frame()
  FrameView checked();                          // the small batch, one frame

 private:
  std::optional<Simulator> timed_, checked_;
  Setting setting_{};
};

// Medians of `repetitions` frames, after some that are not counted, for `warm_up` seconds or two of them.
FrameTime timeOf(Trial& trial, int repetitions, double warm_up);

FrameTime medianOf(const std::vector<FrameTime>& times);

}  // namespace taxelsim::bench
