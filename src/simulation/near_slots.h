// The objects of an instance that can reach its sensor. The passes of a frame get these alone, so that an object that is far away costs the
// device nothing.
#pragma once

#include <cstdint>
#include <limits>
#include <span>
#include <vector>

#include "base/thread_team.h"
#include "shared/batch.h"
#include "simulation/model_data.h"

namespace taxelsim {

class NearSlots {
 public:
  // `model` must outlive this.
  NearSlots(const ModelData& model, std::size_t num_instances, std::size_t num_slots);

  void place(std::size_t instance, std::size_t slot, int id, const Pose& X_SO);
  // Sets the slots of the instances from `first` to before `last`; ids, X_SO: (num_instances x num_slots). In passes over some instances,
  // so that the processor overlaps independent operations. Threads may set parts that do not overlap.
  void placeAll(std::span<const int> ids, std::span<const Pose> X_SO, std::size_t first, std::size_t last);

  // Writes the poses of the near objects to `poses` (num_instances x the result), in the order of their slots, then empty slots. Returns
  // the largest number of near objects of an instance, at least 1. A load search moves objects: where an instance is driven by load, all
  // its objects are near. The threads of `team` share the instances.
  std::size_t pack(std::span<const float> loads, std::span<layout::PoseRecord> poses, ThreadTeam& team);

  // The pose of the one slot of an instance, as pack() writes it.
  layout::PoseRecord packOnly(std::size_t instance, float load) const;

  layout::SkinBase skinBase() const { return {{region_.normal, region_.low.z}, {region_.p_RS.z, 0, 0, 0}}; }

  // The near slots of an instance after pack(), as bits.
  std::uint32_t of(std::size_t instance) const { return packed_[instance]; }

 private:
  bool reaches(const layout::ObjectRecord& object, const layout::PoseRecord& X_SO) const;
  // Whether the object is wholly below the region along z of R, behind the skin.
  bool isBehind(const layout::ObjectRecord& object, const layout::PoseRecord& X_SO) const;

  // Box around all points that can touch the sensor, m, in the frame R of its one patch, or in S.
  struct Region {
    glm::mat3 R_RS{1};
    glm::vec3 p_RS{};
    glm::vec3 low{std::numeric_limits<float>::infinity()}, high{-std::numeric_limits<float>::infinity()};
    glm::vec3 normal{0, 0, 1};  // z of R, in S
  };

  const ModelData& model_;
  std::size_t num_slots_;
  Region region_;
  std::vector<layout::PoseRecord> placed_;              // (num_instances x num_slots), of objects
  std::vector<std::uint8_t> occupied_, near_, packed_;  // (num_instances), a bit per slot
};

}  // namespace taxelsim
