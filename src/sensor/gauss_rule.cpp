#include "sensor/gauss_rule.h"

#include <array>

namespace taxelsim {
namespace {

// Points and weights on [-1, 1], positive half.
constexpr std::array<std::array<double, 2>, 4> kGauss8{{{0.1834346424956498, 0.3626837833783620},
                                                        {0.5255324099163290, 0.3137066458778873},
                                                        {0.7966664774136267, 0.2223810344533745},
                                                        {0.9602898564975363, 0.1012285362903763}}};

}  // namespace

QuadratureRule gaussRule(double length, int num_panels) {
  QuadratureRule rule;
  const double width = length / num_panels;
  for (int panel = 0; panel < num_panels; ++panel) {
    const double middle = (panel + 0.5) * width;
    for (const auto& [point, weight] : kGauss8) {
      for (const double sign : {-1.0, 1.0}) {
        rule.points.push_back(middle + sign * point * width / 2);
        rule.weights.push_back(weight * width / 2);
      }
    }
  }
  return rule;
}

}  // namespace taxelsim
