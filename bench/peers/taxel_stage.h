// From force per taxel to image and features, as fast as we can write it: the half of a frame that all peers on the CPU share, so that none
// is slow for want of it. Spread, readout and both sets of moments in one pass over the rows that have force. Not general: one grid
// patch at the sensor's origin, a 3 x 3 PSF per source, a straight curve, no noise, no memory.
#pragma once

#include <vector>

#include "peers/lanes.h"
#include "peers/peer.h"
#include "taxelsim/sensor.h"

namespace taxelsim::bench {

class TaxelStage {
 public:
  // Throws Error(kInput) for a sensor that it cannot do.
  explicit TaxelStage(const Sensor& sensor);

  int numRows() const { return num_rows_; }
  int numCols() const { return num_cols_; }
  int numTaxels() const { return num_rows_ * num_cols_; }
  float pitchX() const { return pitch_x_; }
  float pitchY() const { return pitch_y_; }
  float thickness() const { return thickness_; }
  // N per m of penetration of one of the taxel's 4 x 4 samples; of the whole taxel.
  float sampleForce() const { return sample_force_; }
  float taxelStiffness() const { return 16 * sample_force_; }

  // Forces of one instance on a grid with borders; all zero between frames.
  struct Scratch {
    std::vector<float> force, scaled;
  };
  Scratch scratch() const;
  // Where the force of a taxel goes, N.
  float& force(Scratch& scratch, int row, int col) const { return scratch.force[placeOf(row, col)]; }

  // Turns the forces, none of them outside rows first to last, into frame number `instance`, and clears them.
  void finish(Scratch& scratch, int first_row, int last_row, std::size_t instance, PeerFrame& frame) const;

 private:
  std::size_t placeOf(int row, int col) const { return static_cast<std::size_t>((row + 1) * row_length_ + kLanes + col); }

  int num_rows_, num_cols_, num_chunks_, row_length_;
  float pitch_x_, pitch_y_, thickness_, sample_force_;
  float gain_, inverse_gain_, trigger_, saturation_, taxel_area_;
  float kernel_[9];
  std::vector<float> inverse_divisor_;  // on the grid with borders: 1 / what of the kernel lies inside, seen from a source; 0 outside
  std::vector<float> row_x_, col_y_;    // m; columns past the last: 0
};

}  // namespace taxelsim::bench
