// The least time that a frame can take on a machine, by option of the simulator: that of its bytes at the machine's memory bandwidth or of
// its operations at its arithmetic rate, whichever is longer, stage by stage.
//
// Bytes: what a frame must read from memory and write to it once: pose, state between frames, outputs. The object, tables and what one pass
// leaves for the next stay in the cache. Operations: additions, multiplications, divisions and roots count 1, exponentials, logarithms and
// cosines 10; comparisons, bit operations and addresses 0. They are counted from the formulas of the shaders for what contact touches. A
// frame that follows these formulas cannot be faster.
#pragma once

#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "frame_counts.h"
#include "taxelsim/sensor.h"
#include "taxelsim/simulator.h"

namespace taxelsim::bench {

// Of one stage of a frame.
struct StageWork {
  std::string stage;
  double bytes = 0, operations = 0;
};

// What a machine can do. Defaults: 2 cores of an AMD EPYC with AVX2; bench/README.md says how to measure them.
struct MachineRates {
  double bandwidth = 33e9;    // bytes/s
  double arithmetic = 225e9;  // operations/s, float32
};

// Stages of a plain frame: law winkler with exponent 1, without damping, friction, relaxation, time behaviour and imperfections; only the
// outputs that are always computed.
std::vector<StageWork> plainFrame(const FrameCounts& counts);

// The same, and the stages that the options of `sensor` and `outputs` add. `max_regions`: of the contact features. Covers all laws, winkler
// with exponent 1, on one grid patch under an object whose pose is given, contact_features and tactile_jacobian; not vary_skin, three-axis
// readout, other outputs and the tactile Jacobian of elastic_layer.
std::vector<StageWork> frameWork(const Sensor& sensor, const OutputOptions& outputs, int max_regions, const FrameCounts& counts);

// {stage: {bytes, operations}}
nlohmann::ordered_json toJson(const std::vector<StageWork>& stages);

// Seconds of one frame: the sum over stages of the longer of both times.
double limitOf(const std::vector<StageWork>& stages, const MachineRates& rates);

// Whether all bytes together take longer than all operations.
bool isBoundByBytes(const std::vector<StageWork>& stages, const MachineRates& rates);

}  // namespace taxelsim::bench
