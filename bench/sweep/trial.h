// A case under one setting: the timed batch, and a small one with all outputs for checking.
#pragma once

#include <optional>
#include <vector>

#include "sweep/cases.h"
#include "sweep/descent.h"
#include "sweep/outputs.h"
#include "taxelsim/simulator.h"

namespace taxelsim::bench {

// Instances whose outputs are checked in full and hashed. The number is fixed, so that hashes of two runs can be compared.
inline constexpr int kChecked = 64;

// Input shared by all trials of a case.
struct Batch {
  std::vector<int> ids;    // (num_instances)
  std::vector<Pose> X_SO;  // (num_instances); a smaller batch takes the first
};

Batch batchOf(const SweepCase& work, int num_instances);

class Trial {
 public:
  // `setting`: empty for the device's default. `batch` has at least kChecked instances; the first `num_instances` are timed. Throws Error
  // if the device refuses.
  Trial(const Device& device, const SweepCase& work, const Batch& batch, int num_instances, const std::optional<Setting>& setting);

  // Largest number of instances that fit on the device.
  static std::uint64_t mostInstances(const Device& device, const SweepCase& work);

  const Setting& setting() const { return setting_; }
  FrameTime frame();                            // computes and times the timed batch
  FrameView timed() { return timed_->read(); }  // the outputs of the last frame()
  FrameView checked();                          // computes the checked batch

 private:
  std::optional<Simulator> timed_, checked_;
  Setting setting_{};
};

// Medians of `repetitions` frames after a warm-up.
FrameTime timeOf(const DeviceInfo& device, Trial& trial, int repetitions);

FrameTime medianOf(const std::vector<FrameTime>& times);

}  // namespace taxelsim::bench
