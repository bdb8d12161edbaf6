// taxelsim's CPU reference: every stage in double precision, plain loops, no culling. The oracle of the tests, not optimised.
#pragma once

#include <vector>

#include "peers/peer.h"
#include "taxelsim/object.h"
#include "taxelsim/sensor.h"

namespace taxelsim::bench {

class TwinPeer : public Peer {
 public:
  // `objects` must outlive it.
  TwinPeer(const Sensor& sensor, const std::vector<Object>& objects, int num_threads);

  std::string name() const override { return "twin"; }
  std::string what() const override { return "taxelsim's reference in double precision"; }
  void run(std::span<const int> ids, std::span<const Pose> X_SO, PeerFrame& frame) override;

 private:
  Sensor sensor_;
  const std::vector<Object>& objects_;
  int num_threads_;
};

}  // namespace taxelsim::bench
