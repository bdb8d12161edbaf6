// The order of the passes of a frame.
#pragma once

#include "gpu/commands.h"
#include "simulation/batch_buffers.h"
#include "simulation/model_impl.h"

namespace taxelsim {

// What the command lists of a batch differ in.
struct FrameKind {
  // Candidates of the contact pass, of batches that keep some.
  enum class Candidates {
    kSkipped,  // both passes are skipped: no instance has candidates, and the lists of block Work stay as they were
    kKept,     // the passes run, and no instance has candidates from the step before
    kUsed,     // the passes run, and some instance may have candidates from the step before
    kLeft,     // both passes are skipped, and the contact pass takes all instances: candidates and lists stay for the next step
  };

  bool loads = false;      // some instance is driven by load
  bool random = false;     // some instance draws noise or gains
  bool many_near = false;  // some instance has several near objects
  bool places = false;     // another interface has written objects, poses and loads
  Candidates candidates = Candidates::kSkipped;
};

// Commands of one frame, not finished; they may be submitted any number of times. Timestamps 0, 1, 2: before, between and after stages 1 to
// 2 and 3 to 6. `shape` must be that of `buffers`.
// `base`: of the model's skin. `half`: of the arrays that are double.
gpu::Commands recordFrame(const Model::Impl& model, const BatchShape& shape, const BatchBuffers& buffers, const FrameKind& kind,
                          const layout::SkinBase& base, std::size_t half);

// Commands of Simulator::vjp() after a frame, not finished. `shape` must be that of `buffers`.
gpu::Commands recordGradient(const Model::Impl& model, const BatchShape& shape, const BatchBuffers& buffers, bool with_gains,
                             std::size_t half);

}  // namespace taxelsim
