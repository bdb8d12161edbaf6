// Quadrature by Gauss-Legendre rules of eight points on panels of equal width.
#pragma once

#include <vector>

namespace taxelsim {

struct QuadratureRule {
  std::vector<double> points, weights;
};

// Rule on [0, length], exact for polynomials of degree 15 on each panel.
QuadratureRule gaussRule(double length, int num_panels);

}  // namespace taxelsim
