// Runs one case of a sweep: finds the batch that fits, times the default setting, runs the descent, then times default and best setting in
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
};

// A setting that was tried.
struct Tried {
  Setting setting{};
  FrameTime time;          // if timed
  std::string refused;     // why the device refused it; empty: timed
  std::string difference;  // first output that differs bitwise from that of the default setting; empty: none
};

struct CaseResult {
  int num_instances = 0;  // timed
  std::string cut;        // why the batch is smaller than that of the case; empty: it is not
  int without_force = 0;  // timed instances without force: the object lies between samples
  Setting chosen{}, best{};
  FrameTime chosen_time, best_time;
  double gain = 1;  // speed of `best` over `chosen`, median over turns; 1 if `best` is `chosen`
  std::vector<Tried> tried;
  OutputHashes hashes;
};

// Receives one line per setting.
using Progress = std::function<void(const std::string&)>;

// Throws Error if the default setting fails, most frames have no force, or the device is lost.
CaseResult runCase(const Device& device, const SweepCase& work, const CaseOptions& options, const Progress& progress);

// Taxels per second of the device.
double taxelsPerSecond(const SweepCase& work, const CaseResult& result, const FrameTime& time);

// us of the device per instance and frame; wall clock if the device has no clock.
double microsecondsPerFrame(const CaseResult& result, const FrameTime& time);

}  // namespace taxelsim::bench
