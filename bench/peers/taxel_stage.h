// From forces per taxel to image and features: the optimised second half of a frame, shared by all CPU peers, so that none is slow because
// of it. One pass over the rows with force computes spread, readout and both sets of moments. Supports one grid patch at the sensor's
// origin, a 3 x 3 per-source PSF and a linear curve; no noise and no state.
#pragma once

#include <vector>

#include "peers/lanes.h"
#include "peers/peer.h"
#include "taxelsim/sensor.h"

namespace taxelsim::bench {

class TaxelStage {
 public:
  // Throws Error(kInput) for any other sensor.
  explicit TaxelStage(const Sensor& sensor);

  int numRows() const { return num_rows_; }
  int numCols() const { return num_cols_; }
  int numTaxels() const { return num_rows_ * num_cols_; }
  float pitchX() const { return pitch_x_; }
  float pitchY() const { return pitch_y_; }
  float thickness() const { return thickness_; }
  // N/m, force per penetration of one of the 4 x 4 samples of a taxel, and of the taxel.
  float sampleForce() const { return sample_force_; }
  float taxelStiffness() const { return 16 * sample_force_; }

  // Forces of one instance on a padded grid; all 0 between frames.
  struct Scratch {
    std::vector<float> force, scaled;
  };
  Scratch scratch() const;
  // N, force of a taxel.
  float& force(Scratch& scratch, int row, int col) const { return scratch.force[placeOf(row, col)]; }

  // Computes frame `instance` from the forces in rows `first` to `last`, and clears them.
  void finish(Scratch& scratch, int first_row, int last_row, std::size_t instance, PeerFrame& frame) const;

 private:
  std::size_t placeOf(int row, int col) const { return static_cast<std::size_t>((row + 1) * row_length_ + kLanes + col); }

  int num_rows_, num_cols_, num_chunks_, row_length_;
  float pitch_x_, pitch_y_, thickness_, sample_force_;
  float gain_, inverse_gain_, trigger_, saturation_, taxel_area_;
  float kernel_[9];
  std::vector<float> inverse_divisor_;  // on the padded grid: 1 / sum of the kernel inside the array, by source; 0 outside
  std::vector<float> row_x_, col_y_;    // m; 0 beyond the last column
};

}  // namespace taxelsim::bench
