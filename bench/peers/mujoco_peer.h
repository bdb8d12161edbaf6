// MuJoCo's `tactile` sensor, then our taxel stage. The sensor evaluates the object's signed distance field at points of the skin. No time
// step: kinematics, collision and sensor only.
#pragma once

#include <memory>
#include <vector>

#include "peers/peer.h"
#include "taxelsim/object.h"
#include "taxelsim/sensor.h"

namespace taxelsim::bench {

// Vertices of the sensor's mesh: the middle of every taxel, or every sample.
enum class MujocoPoints { kTaxels, kSamples };

class MujocoPeer : public Peer {
 public:
  // Takes meshes and cylinders. Throws Error(kInput) for other objects, an object that MuJoCo rejects, and a sensor that TaxelStage does
  // not support.
  MujocoPeer(const Sensor& sensor, const std::vector<Object>& objects, MujocoPoints points, int num_threads);
  ~MujocoPeer() override;

  std::string name() const override;
  std::string what() const override;
  Trust trust() const override { return Trust::kOtherModel; }
  void run(std::span<const int> ids, std::span<const Pose> X_SO, PeerFrame& frame) override;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace taxelsim::bench
