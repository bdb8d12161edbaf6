// A rigid, frictionless, flat circular punch on an elastic layer bonded to a rigid base.
//
// With the layer's kernel L (sensor/elastic_layer.h), w^(k) = 2 / (E* k) L(k h) p^(k) in Hankel transforms. The pressure p^(k) = int_0^a
// phi(t) cos(k t) dt vanishes outside of the radius a. Abel's inversion of w = delta for r < a leaves a Fredholm equation of the second
// kind, in lengths relative to h:
//
//     phi(s) + (2 / pi) int_0^a K(s, t) phi(t) dt = E* delta / pi,   K(s, t) = int_0^inf (L(y) - 1) cos(y s) cos(y t) dy
//
// and the force is 2 pi int_0^a phi (N. N. Lebedev and Ia. S. Ufliand, "Axisymmetric contact problem for an elastic layer", J. Appl. Math.
// Mech. 22(3), 1958). It is solved at Gauss points in t; the matrix is positive definite because L is positive.
#pragma once

namespace taxelsim {

inline constexpr double kMaxPunchRatio = 64;

// Force relative to that on a half-space, F / (2 E* a delta). `ratio`: radius / thickness, > 0 to kMaxPunchRatio; Poisson's ratio 0 to
// 0.5. Relative error below 1e-5.
double punchFactor(double ratio, double poisson_ratio);

}  // namespace taxelsim
