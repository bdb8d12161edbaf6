// One case of a sweep from beginning to end: the batch that fits, what the device gets by itself, the descent, and both ends once more in
// turns.
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "sweep/cases.h"
#include "sweep/descent.h"
#include "sweep/outputs.h"
#include "taxelsim/device.h"

namespace taxelsim::bench {

struct CaseOptions {
  Descent descent;
  int most_instances = 0;  // 0: those of the case
  int repetitions = 15;
  double warm_up = 0.5;  // s, before anything is timed
};

// A setting that was tried.
struct Tried {
  Setting setting{};
  FrameTime time;          // where it was timed
  std::string refused;     // why it was not; empty: it was
  std::string difference;  // the first output that is not bit-equal to that of the setting chosen by the device; empty: none
};

struct CaseResult {
  int num_instances = 0;  // timed
  std::string cut;        // why fewer than the case has; empty: as many
  int without_force = 0;  // of the timed instances: the object lies between the samples
  Setting chosen{}, best{};
  FrameTime chosen_time, best_time;
  double gain = 1;  // times faster by `best` than by `chosen`, median over turns; where it is not, `best` is `chosen`
  std::vector<Tried> tried;
  OutputHashes hashes;
};

// Called with a line for each setting.
using Progress = std::function<void(const std::string&)>;

// Throws Error where not even the chosen setting works, where most frames have no force, and where the device is lost.
CaseResult runCase(const Device& device, const SweepCase& work, const CaseOptions& options, const Progress& progress);

// Taxels that the device computes in a second.
double taxelsPerSecond(const SweepCase& work, const CaseResult& result, const FrameTime& time);

// Microseconds of the device for one instance's frame; of the wall clock where the device has no clock.
double microsecondsPerFrame(const CaseResult& result, const FrameTime& time);

}  // namespace taxelsim::bench
