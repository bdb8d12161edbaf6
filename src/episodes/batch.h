// A batch of instances, cut into slices that take turns.
#pragma once

#include <atomic>
#include <functional>
#include <memory>
#include <span>
#include <vector>

#include "episodes/slice.h"

namespace taxelsim {

// A scene need not come from loadScene(). Throws Error(kInput).
void checkScene(const Scene& scene);

// Throws Error(kInput) unless value is at least 1.
void checkCount(const char* name, std::int64_t value);

// The scene's sensor and objects, for a Model.
ModelOptions modelOptionsOf(const Scene& scene);

// Instances of each slice; none is empty. Each simulator checks its own part against the device; together they must fit as well: throws
// Error(kInput).
std::vector<int> splitBatch(const Model& model, const EpisodePlan& plan, int batch_size, int num_slices);

// Plays all episodes. Slices take turns: when a slice's turn comes its frame is read and its next one started; meanwhile the others' frames
// are computed. `after_turn` hears what each turn brought. When *stop (or null) becomes true, what is under way is given up. All of this
// happens on a thread of its own, in the background where `device` is the processor; returns when it has ended, and throws what was thrown.
void runEpisodes(const Device& device, std::span<const std::unique_ptr<Slice>> slices, const std::atomic<bool>* stop,
                 const std::function<void(const Slice::Stats&)>& after_turn);

}  // namespace taxelsim
