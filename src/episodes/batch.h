// Runs the episodes of a scene in a batch of instances, split into slices.
//
// Each slice has a simulator of its own. With two slices in flight the device computes the frame of one while the host handles the frame of
// the other:
//
//   device   | frame 1 of A | frame 1 of B | frame 2 of A | frame 2 of B | ...
//   host     |              | A: read 1,   | B: read 1,   | A: read 2,   |
//            |              | control,     | control,     | control,     |
//            |              | record,      | record,      | record,      |
//            |              | submit 2     | submit 2     | submit 3     |
//
// The results do not depend on the batch size or on the number of slices: an episode is a function of scene, seed and episode number
// (draw.h).
#pragma once

#include <atomic>
#include <functional>
#include <memory>
#include <span>
#include <vector>

#include "episodes/slice.h"
#include "taxelsim/environment.h"

namespace taxelsim {

// Throws Error(kInput) unless value >= 1; `name` names the value in the message.
void checkCount(const char* name, std::int64_t value);

// Splits batch_size (>= 1) instances into at most num_slices (>= 1) slices; returns their sizes, which differ by at most 1. Throws
// Error(kInput) if all slices together do not fit into device memory.
std::vector<int> splitBatch(const Model& model, const SlicePlan& plan, int batch_size, int num_slices);

// Runs the slices until no instance has an episode left. Calls after_frame with the statistics of each collected frame. When *stop (may be
// null) becomes true, unfinished episodes are abandoned.
//
// Threads: runs in a thread of its own, in which after_frame and the sinks are called; at background priority if `device` is a CPU. Blocks
// until that thread ends, and rethrows its exception.
void runEpisodes(const Device& device, std::span<const std::unique_ptr<Slice>> slices, const std::atomic<bool>* stop,
                 const std::function<void(const Slice::Stats&)>& after_frame);

}  // namespace taxelsim
