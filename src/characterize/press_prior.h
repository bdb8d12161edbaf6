// Prior of the gains of presses. A bench does not carry every weight alike: a stamp sticks in its guide, a holder takes a part of the load.
// The logarithm of a press gain is then the sum of a Gaussian process in log(load), which presses of neighbouring loads share, and of an
// independent part; both have a mean of 0.
#pragma once

#include <Eigen/Core>
#include <vector>

namespace taxelsim {

struct PressPrior {
  double load_spread = 0;   // standard deviation of the process; 0: none
  double length = 1;        // in log(load), of its squared-exponential covariance
  double press_spread = 0;  // standard deviation of the independent part, > 0

  bool operator==(const PressPrior&) const = default;
  // Covariance of the process at two loads (N).
  double processCovariance(double load, double other) const;
  // Covariance of log(press gain) of presses with these loads (N).
  Eigen::MatrixXd covariance(const std::vector<double>& loads) const;
};

struct PressPriorChoice {
  PressPrior prior;
  double gain = 0;  // log evidence, over that of the best prior without a process
};

// The prior of a fixed list with the largest evidence (type-II maximum likelihood): C. E. Rasmussen and C. K. I. Williams, Gaussian
// Processes for Machine Learning, MIT Press 2006, section 5.4. `fitted` and `covariance`: log(press gain) (num_presses) of a fit under the
// prior `used`, and its covariance with all other parameters free. What the images say of the gains is taken as Gaussian.
PressPriorChoice choosePressPrior(const std::vector<double>& loads, const Eigen::VectorXd& fitted, const Eigen::MatrixXd& covariance,
                                  const PressPrior& used);

}  // namespace taxelsim
