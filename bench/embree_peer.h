// The same frame on the CPU: Embree 3 for the depth, plain C++ for the rest. The peer that taxelsim is timed against, given every advantage
// that we know of: packets of one taxel, rays no longer than the skin, taxels beside the object skipped, no allocation per frame, all
// cores. Not a general simulator: one grid patch with 4 x 4 samples, linear winkler springs at a given pose, no noise.
#pragma once

#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include "taxelsim/object.h"
#include "taxelsim/pose.h"
#include "taxelsim/sensor.h"

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

struct PeerFrame {
  std::vector<float> spread_force;            // (num_instances x num_taxels), N, after the PSF
  std::vector<std::uint32_t> tactile_image;   // (num_instances x num_taxels), counts
  std::vector<PeerFeatures> measured, clean;  // (num_instances)
};

// Which samples get a ray: every one, or those of taxels under the box of the turned object.
enum class Rays { kAll, kUnderBox };

class EmbreePeer {
 public:
  // Builds the scene; `threads` workers, 0 for one per core. Throws Error(kInput) for a sensor that it cannot do.
  EmbreePeer(const Sensor& sensor, const Mesh& mesh, Rays rays, int threads = 0);
  ~EmbreePeer();

  int numThreads() const;

  // Computes a frame of every pose X_SO. The frame's arrays are sized on first use and reused.
  void run(std::span<const Pose> X_SO, PeerFrame& frame);

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace taxelsim::bench
