// Embree 3 for the depth, our taxel stage for the rest; given every advantage that we know of: packets of one taxel, rays no longer than
// the skin, taxels beside the object skipped where asked, no allocation per frame.
#pragma once

#include <memory>
#include <vector>

#include "peers/peer.h"
#include "taxelsim/object.h"
#include "taxelsim/sensor.h"

namespace taxelsim::bench {

// Which samples get a ray: every one, or those of taxels under the box of the turned object.
enum class Rays { kAll, kUnderBox };

class EmbreePeer : public Peer {
 public:
  // Builds a scene per mesh. Throws Error(kInput) for a sensor that the taxel stage cannot do.
  EmbreePeer(const Sensor& sensor, const std::vector<const Mesh*>& meshes, Rays rays, int num_threads);
  ~EmbreePeer() override;

  std::string name() const override;
  std::string what() const override;
  void run(std::span<const int> ids, std::span<const Pose> X_SO, PeerFrame& frame) override;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace taxelsim::bench
