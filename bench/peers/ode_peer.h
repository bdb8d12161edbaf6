// The paper's way: the Open Dynamics Engine's contacts between a mesh of the sensor and one of the object, uncapped, clustered into taxels,
// whose force is their stiffness times the mean depth of their contacts along z; then our taxel stage. Debian's ODE meets meshes in one
// thread at a time, so its workers are processes, started when the peer is made.
#pragma once

#include <memory>
#include <vector>

#include "peers/peer.h"
#include "taxelsim/object.h"
#include "taxelsim/sensor.h"

namespace taxelsim::bench {

// What two triangles of the sensor's mesh cover.
enum class OdeCells { kSamples, kTaxels };

class OdePeer : public Peer {
 public:
  // Meshes and cylinders. At most `max_instances` a run. Throws Error(kInput) for other objects, and for a sensor that the taxel stage
  // cannot do.
  OdePeer(const Sensor& sensor, const std::vector<Object>& objects, OdeCells cells, int max_instances, int num_workers);
  ~OdePeer() override;

  std::string name() const override;
  std::string what() const override;
  Trust trust() const override { return Trust::kOtherModel; }
  void run(std::span<const int> ids, std::span<const Pose> X_SO, PeerFrame& frame) override;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace taxelsim::bench
