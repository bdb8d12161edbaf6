// Embree 3 for the depth, then our taxel stage. Tuned as well as we know: one packet per taxel, rays as short as the skin is thick, an
// option to skip taxels outside the object's box, no allocation per frame.
#pragma once

#include <memory>
#include <vector>

#include "peers/peer.h"
#include "taxelsim/object.h"
#include "taxelsim/sensor.h"

namespace taxelsim::bench {

// Samples that get a ray: all, or those of taxels under the object's rotated box.
enum class Rays { kAll, kUnderBox };

class EmbreePeer : public Peer {
 public:
  // Builds a scene per mesh. A sample's depth is the mean over rays_per_side x rays_per_side rays in its cell. Throws Error(kInput) for a
  // sensor that TaxelStage does not support.
  EmbreePeer(const Sensor& sensor, const std::vector<const Mesh*>& meshes, Rays rays, int num_threads, int rays_per_side = 1);
  ~EmbreePeer() override;

  std::string name() const override;
  std::string what() const override;
  void run(std::span<const int> ids, std::span<const Pose> X_SO, PeerFrame& frame) override;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace taxelsim::bench
