// taxelsim itself: setObjects(), step(), read().
#pragma once

#include <vector>

#include "peers/peer.h"
#include "taxelsim/simulator.h"

namespace taxelsim::bench {

class TaxelsimPeer : public Peer {
 public:
  struct Options {
    bool with_forces = false;   // whether to read back the taxels' forces
    bool device_clock = false;  // for timing()
  };
  TaxelsimPeer(const Model& model, int num_instances, const Options& options);
  TaxelsimPeer(const Model& model, int num_instances) : TaxelsimPeer(model, num_instances, Options()) {}

  std::string name() const override { return "taxelsim"; }
  std::string what() const override;

  // With forces: copies the frame. Otherwise leaves `frame` unchanged: a caller would use the spans of read().
  void run(std::span<const int> ids, std::span<const Pose> X_SO, PeerFrame& frame) override;

  // s from step() to the end of read() in the last run().
  double submitToRead() const { return submit_to_read_; }
  StepTiming timing() const { return simulator_.timing(); }

 private:
  void copy(const FrameView& view, PeerFrame& frame) const;

  bool with_forces_;
  Simulator simulator_;
  double submit_to_read_ = 0;
};

}  // namespace taxelsim::bench
