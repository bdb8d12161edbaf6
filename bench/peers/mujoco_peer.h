// MuJoCo's `tactile` sensor: at the middle of every taxel, how deep it lies inside the object, from the object's signed distance field;
// then our taxel stage. Nothing is stepped: poses go in, positions, collision and sensor are computed.
#pragma once

#include <memory>
#include <vector>

#include "peers/peer.h"
#include "taxelsim/object.h"
#include "taxelsim/sensor.h"

namespace taxelsim::bench {

// Where the sensor's mesh has its vertices: in the middle of every taxel, or at every sample.
enum class MujocoPoints { kTaxels, kSamples };

class MujocoPeer : public Peer {
 public:
  // Meshes and cylinders. Throws Error(kInput) for other objects, for one that MuJoCo refuses, and for a sensor that the taxel stage cannot
  // do.
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
