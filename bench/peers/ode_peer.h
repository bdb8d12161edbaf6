// The paper's method: contacts of the Open Dynamics Engine between a mesh of the sensor and the object, without a limit, clustered into
// taxels; the force of a taxel is its stiffness times the mean depth of its contacts along z. Then our taxel stage. Debian's ODE collides
// meshes in one thread only, so the workers are processes, started by the constructor.
#pragma once

#include <memory>
#include <vector>

#include "peers/peer.h"
#include "taxelsim/object.h"
#include "taxelsim/sensor.h"

namespace taxelsim::bench {

// Cell of the sensor's mesh, two triangles each.
enum class OdeCells { kSamples, kTaxels };

class OdePeer : public Peer {
 public:
  // Takes meshes and cylinders. `max_instances`: largest batch of run(). Throws Error(kInput) for other objects, and a sensor that
  // TaxelStage does not support.
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
