// Moves the hands of a GraspBatch in lockstep, by the law of the scene or by a policy of the caller.
#pragma once

#include <optional>
#include <vector>

#include "episodes/grasp_batch.h"
#include "taxelsim/grasp_environment.h"
#include "taxelsim/policy.h"

namespace taxelsim {

// The public view of a batch, valid until its next frame.
GraspView viewOf(const GraspBatch& batch, const Scene& scene);

// Frames from one action to the next.
int controlPeriod(const Scene& scene);

// Throws Error(kInput), which names the instance and its episode, unless all velocities (num_instances x num_joints) of `instances` are
// finite.
void checkJointVelocities(const GraspBatch& batch, std::span<const double> velocities, std::span<const int> instances);

class GraspPlayer {
 public:
  // Without a policy joints follow the law of the scene. Throws Error(kInput) for a policy that cannot act in the scene. `scene` and
  // `policy` must outlive this.
  GraspPlayer(const Scene& scene, const std::optional<Policy>& policy);

  // Arguments of the batch: its mover of joints, and its outputs, which are those of `caller` and of the policy.
  GraspBatch::Joints joints() const { return policy_ ? GraspBatch::Joints::kByCaller : GraspBatch::Joints::kByLaw; }
  OutputOptions outputs(const OutputOptions& caller) const;

  // Computes the next frame of a batch that is in lockstep. The policy acts on the first `count` instances; the others follow the last one.
  void step(GraspBatch& batch, int count);

 private:
  const Scene& scene_;
  const Policy* policy_;
  std::vector<int> instances_;      // (count)
  std::vector<double> velocities_;  // (num_instances x num_joints), rad/s or m/s
};

}  // namespace taxelsim
