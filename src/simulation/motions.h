// What the objects of a batch do from step to step: poses in, displacements out, as friction needs them.
#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "shared/batch.h"
#include "taxelsim/pose.h"

namespace taxelsim {

class Motions {
 public:
  Motions(std::size_t num_instances, std::size_t num_slots);

  // For the next pack(): what slot `index` of (num_instances x num_slots) holds, and where. The rotation need not be quite of unit length.
  void place(std::size_t index, int id, const Pose& X_SO);
  // The instance's next step is its first.
  void forget(std::size_t instance);

  // Records of all slots, (num_instances x num_slots), from the poses of the call before, moved by the `load_offsets` (num_instances), m
  // along z of S, that a load search found for them, to those of now.
  void pack(std::span<const float> load_offsets, std::span<layout::MotionRecord> records);

 private:
  struct Placed {
    int id;
    Pose X_SO;
  };
  std::size_t num_slots_;
  std::vector<Placed> now_, before_;  // (num_instances x num_slots)
};

}  // namespace taxelsim
