// Commands a slice by a policy of the caller.
#pragma once

#include <vector>

#include "episodes/controller.h"
#include "taxelsim/policy.h"

namespace taxelsim {

// Throws Error(kInput) for a policy that cannot act in the scene.
void checkPolicy(const Policy& policy, const Scene& scene);

// Value of EpisodeRecord::controller under a policy.
inline constexpr int kPolicyActs = -1;

class PolicyController : public Controller {
 public:
  // `policy` must have passed checkPolicy() and outlive this. first_instance: number of the slice's instance 0 in the whole batch.
  PolicyController(const Policy& policy, const EpisodePlan& plan, int num_instances, int first_instance);

  void start(int instance, const EpisodeDraw& draw) override;
  void command(EpisodeBatch& batch) override;
  void describe(int instance, EpisodeRecord& record) const override;

 private:
  const Policy& policy_;
  int first_instance_;
  std::vector<int> due_;                      // (num_due)
  std::vector<Twist> twists_;                 // (num_instances)
  std::vector<double> joint_velocities_;      // (num_instances x num_joints)
  std::vector<double> exploration_velocity_;  // (num_instances), m/s, drawn; the policy may ignore it
};

}  // namespace taxelsim
