// Upper bound for this CPU: a hand-vectorised frame, sixteen values at once, for the three kinds of object of the comparison. Not part of
// the simulator.
#pragma once

#include <memory>
#include <vector>

#include "peers/peer.h"
#include "taxelsim/object.h"
#include "taxelsim/sensor.h"

namespace taxelsim::bench {

class VectorPeer : public Peer {
 public:
  // Takes meshes and cylinders; a convex mesh of few faces is treated as a polyhedron, as in taxelsim. Throws Error(kInput) for other
  // objects, and a sensor that TaxelStage does not support.
  VectorPeer(const Sensor& sensor, const std::vector<Object>& objects, int num_threads);
  ~VectorPeer() override;

  std::string name() const override { return "vector"; }
  std::string what() const override;
  void run(std::span<const int> ids, std::span<const Pose> X_SO, PeerFrame& frame) override;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace taxelsim::bench
