// Interface of the compared programs: poses of objects in, frames of a tactile array out. One loop verifies and times all of them.
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
  bool with_forces = true;                    // whether to fill spread_force: for verification, not while timing
  std::vector<float> spread_force;            // (num_instances x num_taxels), N, after the PSF; unchanged without with_forces
  std::vector<std::uint32_t> tactile_image;   // (num_instances x num_taxels), counts
  std::vector<PeerFeatures> measured, clean;  // (num_instances)

  // Resizes; keeps values.
  void resize(std::size_t num_instances, std::size_t num_taxels) {
    if (with_forces) spread_force.resize(num_instances * num_taxels);
    tactile_image.resize(num_instances * num_taxels);
    measured.resize(num_instances);
    clean.resize(num_instances);
  }
};

// Relation of a peer's frame to taxelsim's.
enum class Trust {
  kSameModel,   // the same frame: equal within rounding for every taxel
  kOtherModel,  // another contact model: the same taxels touch, forces are similar
};

class Peer {
 public:
  virtual ~Peer() = default;

  // Name for `--peers`, one word.
  virtual std::string name() const = 0;
  // What it computes, for tables.
  virtual std::string what() const = 0;
  virtual Trust trust() const { return Trust::kSameModel; }

  // Computes the frames of the objects `ids` (num_instances), indices into those of the constructor, at poses X_SO (num_instances). Starts
  // and joins its threads: the time includes that.
  virtual void run(std::span<const int> ids, std::span<const Pose> X_SO, PeerFrame& frame) = 0;
};

}  // namespace taxelsim::bench
