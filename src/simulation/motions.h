// Displacements of the objects of a batch from step to step, which friction needs.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "shared/batch.h"
#include "taxelsim/pose.h"

namespace taxelsim {

class Motions {
 public:
  Motions(std::size_t num_instances, std::size_t num_slots);

  // Object and pose of slot `index` of (num_instances x num_slots), for the next pack(). The rotation is normalised here.
  void place(std::size_t index, int id, const Pose& X_SO);
  // Discards the poses of the step before: the instance's next step is its first.
  void forget(std::size_t instance);

  // Writes the displacements of an instance since its last call: of the slots in `near`, bits, in their order, then empty records.
  // `load_offset`: how far a load search has moved the objects of its last step, m along z of S.
  void pack(std::size_t instance, float load_offset, std::uint32_t near, std::span<layout::MotionRecord> records);

 private:
  struct Placed {
    int id;
    Pose X_SO;
  };
  std::size_t num_slots_;
  std::vector<Placed> now_, before_;  // (num_instances x num_slots)
};

}  // namespace taxelsim
