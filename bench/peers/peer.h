// What stands beside whom: everything that turns poses of objects into frames of a tactile array, behind one interface, so that one loop
// verifies and times them all.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "taxelsim/pose.h"

namespace taxelsim::bench {

// Features of one image of forces; the fields of FeatureView.
struct PeerFeatures {
  float total_force = 0, peak_force = 0;
  float center_of_pressure[2] = {0, 0};
  float second_moments[3] = {0, 0, 0};
  float eigenvalues[2] = {0, 0};
  float edge_angle = 0, edge_confidence = 0;
  float contact_area = 0;
};

// A frame of every instance.
struct PeerFrame {
  bool with_forces = true;                    // asked for: to verify; nobody is timed with it
  std::vector<float> spread_force;            // (num_instances x num_taxels), N, after the PSF; untouched unless asked for
  std::vector<std::uint32_t> tactile_image;   // (num_instances x num_taxels), counts
  std::vector<PeerFeatures> measured, clean;  // (num_instances)

  // Makes room; what is there stays.
  void resize(std::size_t num_instances, std::size_t num_taxels) {
    if (with_forces) spread_force.resize(num_instances * num_taxels);
    tactile_image.resize(num_instances * num_taxels);
    measured.resize(num_instances);
    clean.resize(num_instances);
  }
};

// How a peer's frame must compare with taxelsim's.
enum class Trust {
  kSameModel,   // the same frame by other means: taxel by taxel within rounding
  kOtherModel,  // another idea of contact: touches where we touch, forces alike
};

class Peer {
 public:
  virtual ~Peer() = default;

  // One word, as `--peers` takes it.
  virtual std::string name() const = 0;
  // What it computes, for the reader of a table.
  virtual std::string what() const = 0;
  virtual Trust trust() const { return Trust::kSameModel; }

  // Computes a frame of every pose X_SO (num_instances) of the objects `ids` (num_instances), indices into those that the peer was made
  // with. Poses in to features out: threads are started and joined in here.
  virtual void run(std::span<const int> ids, std::span<const Pose> X_SO, PeerFrame& frame) = 0;
};

}  // namespace taxelsim::bench
