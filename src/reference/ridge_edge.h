// Ridge of the reference: direction of an edge from taxels whose gains differ. The forces of a part are fitted by the exponential of a
// quadratic in the place, as a regression with a log link whose deviations grow with the force (P. McCullagh and J. A. Nelder, Generalized
// Linear Models, 1989, chapter 8): iteratively reweighted least squares, two rounds from the Gaussian with the second moments of the
// forces, which is a weak prior as well. The major axis of the quadratic is the ridge. A Gaussian that the array cuts off is the same
// Gaussian, so that borders do not turn it.
#pragma once

#include <array>
#include <span>

namespace taxelsim::reference {

// A taxel, as the fit sees it.
struct RidgeTaxel {
  std::array<double, 2> place;  // m: mean place of what it receives by the point spread under even pressure, in the plane
  double force;                 // N, over reception and calibrated gain; 0 if silent
  double trigger;               // N, over the same: least force that it reports
  double noise;                 // N, over the same: standard deviation
};

// What the fit starts from: moments of the forces as they are.
struct RidgeStart {
  std::array<double, 2> center;          // m
  std::array<double, 3> second_moments;  // m^2: xx, xy, yy
  double peak;                           // N, > 0
  double pitch;                          // m
};

struct RidgeEdge {
  double angle = 0;       // rad in (-pi/2, pi/2]; 0 where undefined
  double confidence = 0;  // 0 to 1
};

RidgeEdge ridgeEdge(std::span<const RidgeTaxel> taxels, const RidgeStart& start);

}  // namespace taxelsim::reference
