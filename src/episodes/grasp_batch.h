// Episodes of a scene of kind grasp on the instances of one batch: objects move as prescribed. Joints follow the law of the scene, in
// lockstep: fingers close until each reads its target force, and a tactile servo moves the arm (taxelsim/grasp.h has the law). Or they
// follow velocities of the caller. An episode is a function of the scene, its number and these velocities. Not thread-safe.
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "episodes/clearance.h"
#include "episodes/grasp_servo.h"
#include "episodes/sensed_robots.h"
#include "taxelsim/contact_misses.h"
#include "taxelsim/scene.h"

namespace taxelsim {

// Factor on a finger's closing velocities. force, target: N. slope: N/s, change of the force at full closing speed; gain: 1/s.
// disturbance: N/s, change of the force by the motion of other joints.
double closingSpeed(double force, double target, double slope, double gain, double disturbance = 0);

class GraspBatch {
 public:
  enum class Joints { kByLaw, kByCaller };

  // outputs: those that the caller reads. `scene` must outlive this.
  GraspBatch(const Device& device, const Scene& scene, const OutputOptions& outputs, int num_instances, Joints joints = Joints::kByLaw);

  int numInstances() const { return robots_.numInstances(); }
  const SensedRobots& robots() const { return robots_; }

  // Starts an episode on one instance, at the initial posture. Its first frame is computed by firstFrames().
  void start(int instance, std::uint64_t episode);
  // Computes the first frames of the instances that have started, `instances` (num_instances) != 0, while all others hold.
  void firstFrames(std::span<const std::uint8_t> instances);
  // Moves the joints of all instances by `velocities` (num_instances x num_joints; rad/s or m/s), within their limits, and computes the
  // next frame.
  void step(std::span<const double> velocities);

  // Starts these episodes on the first instances, one or more. The other instances repeat the last one.
  void begin(std::span<const std::uint64_t> episodes);
  // The episodes first, ..., first + count - 1.
  void begin(std::uint64_t first, int count);
  // Computes the next frame of all instances, which are in lockstep. The first one has the initial posture; joints follow the law then.
  void step();
  // Adds the episodes of the first `count` instances, as far as they have run, to `misses` (num_fingers).
  void addMisses(int count, std::span<ContactMisses> misses) const;

  double dt() const { return dt_; }                                      // s, from one frame to the next
  std::span<const int> frames() const { return frames_; }                // (num_instances), number of the frame; -1 before the first
  std::span<const std::uint64_t> episodes() const { return episodes_; }  // (num_instances)
  double time(int instance = 0) const { return frames_[static_cast<std::size_t>(instance)] * dt_; }  // s, of the frame
  std::span<const Pose> X_WO() const { return X_WO_; }                          // (num_instances x num_objects), of the frame
  std::span<const ReadoutVariation> variations() const { return variations_; }  // (num_instances x num_sensors)
  std::span<const double> targetForces() const { return target_forces_; }       // (num_instances x num_fingers), N

 private:
  double forceRate(int instance, int sensor, std::span<const double> joint_velocities) const;
  void command();
  void computeFrame(std::span<const std::uint8_t> instances);
  void noteContacts(std::span<const std::uint8_t> instances);

  const Scene& scene_;
  const Grasp& grasp_;
  double dt_;
  SensedRobots robots_;
  std::optional<GraspServoLoop> servo_;
  std::vector<int> frames_;                              // (num_instances)
  std::vector<std::uint64_t> episodes_;                  // (num_instances)
  std::vector<Pose> X_WO_;                               // (num_instances x num_objects)
  std::vector<std::optional<Trajectory>> trajectories_;  // (num_instances x num_objects), of objects that move
  std::vector<ReadoutVariation> variations_;             // (num_instances x num_sensors)
  std::vector<double> target_forces_;                    // (num_instances x num_fingers)
  std::vector<Clearance> clearances_;                    // (num_fingers)
  std::vector<std::uint8_t> touched_;                    // (num_instances x num_fingers), 1: has had contact in the episode
  std::vector<double> nearest_;                          // likewise, m: least distance of an object before a contact
  std::vector<double> velocities_;                       // (num_instances x num_joints), rad/s or m/s
  std::vector<double> arm_velocities_;                   // the same, of the servo's joints; 0 for all others
  std::vector<Twist> no_twists_;                         // (num_instances)
  std::vector<std::uint8_t> by_joints_;
};

}  // namespace taxelsim
