// How the gains of presses depend on their load. A bench does not carry every weight alike: a stamp sticks in its guide, a holder takes a
// part of the load. The deviation of the press gains from 1 is then a smooth function of the load, which repeated presses share.
#pragma once

#include <cstddef>
#include <vector>

namespace taxelsim {

// A Gaussian process in log(load) for log(press gain), with a mean of 0 and a squared-exponential covariance. Its length and its variance
// relative to that of single presses are those of a fixed list that predict each load best from the others (leave-one-load-out
// cross-validation); no deviation at all is one of them.
class LoadDeviation {
 public:
  struct Press {
    double load = 0;      // N
    double log_gain = 0;  // of the fit
  };

  // Fewer than kLeastLoads different loads: no deviation.
  explicit LoadDeviation(std::vector<Press> presses);

  // Expected log(press gain) under a load (N); 0 beyond the loads of the presses, where nothing is known of the bench.
  double at(double load) const;

 private:
  static constexpr std::size_t kLeastLoads = 4;

  std::vector<Press> presses_;
  double length_ = 1;  // in log(load)
  double ratio_ = 0;   // variance of the process / variance of single presses
};

}  // namespace taxelsim
