// The machine's limit: the frame as fast as this CPU does it when one writes it by hand, sixteen values at once, for the three kinds of
// object that the comparison has. Not a simulator and no part of one.
#pragma once

#include <memory>
#include <vector>

#include "peers/peer.h"
#include "taxelsim/object.h"
#include "taxelsim/sensor.h"

namespace taxelsim::bench {

class VectorPeer : public Peer {
 public:
  // Meshes and cylinders; a convex mesh of few faces is met as the polyhedron that it is, as taxelsim does. Throws Error(kInput) for other
  // objects, and for a sensor that the taxel stage cannot do.
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
