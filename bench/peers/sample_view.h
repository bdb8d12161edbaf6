// Sample coordinates of the hand-written peer: u and v count samples along x and y of the array, integers being samples; z is in metres.
// Also the sums of sixteen taxels at once.
#pragma once

#include <array>

#include "peers/lanes.h"
#include "peers/taxel_stage.h"
#include "taxelsim/pose.h"

namespace taxelsim::bench {

inline constexpr int kSide = 4;  // samples per taxel, per side
inline constexpr float kHalfTaxel = (kSide - 1) / 2.0f;

// Lane k is sample (k / 4, k % 4) of a taxel.
inline constexpr Floats kLaneU{0, 0, 0, 0, 1, 1, 1, 1, 2, 2, 2, 2, 3, 3, 3, 3};
inline constexpr Floats kLaneV{0, 1, 2, 3, 0, 1, 2, 3, 0, 1, 2, 3, 0, 1, 2, 3};
inline constexpr Floats kCount{0, 1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12, 13, 14, 15};

struct SampleView {
  // Coordinates of a point p of O: u = u[0] p_x + u[1] p_y + u[2] p_z + u[3], and so on.
  std::array<float, 4> u, v, z;
  std::array<float, 9> R;  // R_SO, row-major
  std::array<float, 3> p;  // of O's origin in S, m
  float pitch_u, pitch_v;  // m from sample to sample
  float first_x, first_y;  // m, of sample (0, 0)
  int num_u, num_v;
};

inline SampleView viewOf(const Pose& X_SO, const TaxelStage& stage) {
  const std::array<double, 9> R = rotationMatrix(X_SO.rotation);
  SampleView view;
  for (std::size_t k = 0; k < 9; ++k) view.R[k] = static_cast<float>(R[k]);
  for (std::size_t k = 0; k < 3; ++k) view.p[k] = static_cast<float>(X_SO.position[k]);
  view.num_u = kSide * stage.numRows();
  view.num_v = kSide * stage.numCols();
  view.pitch_u = stage.pitchX() / kSide;
  view.pitch_v = stage.pitchY() / kSide;
  view.first_x = -0.5f * static_cast<float>(view.num_u - 1) * view.pitch_u;
  view.first_y = -0.5f * static_cast<float>(view.num_v - 1) * view.pitch_v;
  const float per_u = 1 / view.pitch_u, per_v = 1 / view.pitch_v;
  for (std::size_t k = 0; k < 3; ++k) {
    view.u[k] = view.R[k] * per_u;
    view.v[k] = view.R[3 + k] * per_v;
    view.z[k] = view.R[6 + k];
  }
  view.u[3] = (view.p[0] - view.first_x) * per_u;
  view.v[3] = (view.p[1] - view.first_y) * per_v;
  view.z[3] = view.p[2];
  return view;
}

// Inclusive range of rows and columns of taxels; empty if first > last.
struct TaxelRange {
  int first_row = 0, last_row = -1, first_col = 0, last_col = -1;
};

// Sums sample depths to taxel forces, sixteen taxels at once.
class TaxelSums {
 public:
  TaxelSums(const TaxelStage& stage, TaxelStage::Scratch& scratch) : stage_(stage), scratch_(scratch) {}
  ~TaxelSums() { flush(); }
  TaxelSums(const TaxelSums&) = delete;
  TaxelSums& operator=(const TaxelSums&) = delete;

  // `height`: m, lowest surface above each sample of the taxel.
  void add(int row, int col, Floats height) {
    depth_[count_] = smaller(larger(-height, Floats{}), all(stage_.thickness()));
    place_[count_] = &stage_.force(scratch_, row, col);
    if (++count_ == kLanes) flush();
  }

 private:
  void flush() {
    const Floats force = sumsOf(depth_) * stage_.sampleForce();
    for (int k = 0; k < count_; ++k) *place_[k] = force[static_cast<std::size_t>(k)];
    count_ = 0;
  }

  const TaxelStage& stage_;
  TaxelStage::Scratch& scratch_;
  Floats depth_[kLanes]{};
  float* place_[kLanes];
  int count_ = 0;
};

}  // namespace taxelsim::bench
