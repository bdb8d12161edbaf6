// Whether a solution of an elastic layer is the solution: in double precision, with the influence table and the solver of src/reference/.
#pragma once

#include <span>
#include <vector>

#include "reference/elastic_layer.h"
#include "taxelsim/object.h"
#include "taxelsim/sensor.h"

namespace taxelsim::bench {

// Signed overlaps of object and undeformed skin, (num_nodes), m, at most the thickness; -infinity without a surface.
std::vector<double> layerOverlaps(const Sensor& sensor, const Object& object, const Pose& X_SO);

// Forces of the taxels, (num_taxels), N, before the spread, from pressures (num_nodes), Pa.
std::vector<double> layerForces(const Sensor& sensor, std::span<const double> overlaps, std::span<const double> pressures);

// A residual of `tolerance` bounds the error of the pressures: they solve exactly the problem with the overlaps d + r, r the residual in
// contact and the penetration elsewhere, and two solutions differ by at most |r| / l, l the least eigenvalue of the influence matrix
// (complementarity: (p' - p).A (p' - p) <= (p' - p).r). A taxel's force is the sum over its nodes.
class LayerAgreement {
 public:
  explicit LayerAgreement(const Sensor& sensor);

  // Definition of `contact_residual`, in double precision.
  double residual(std::span<const double> overlaps, std::span<const double> pressures) const;
  // Solves to convergence; (num_nodes), Pa.
  std::vector<double> solution(std::span<const double> overlaps) const;
  // Bound of the root of the sum of squares over the taxels of the difference of their forces from the solution's, N, for a residual of at
  // most `tolerance` and overlaps that are off by at most `depth_error` (m) each.
  double forceBound(std::span<const double> overlaps, double tolerance, double depth_error) const;

 private:
  Sensor sensor_;
  reference::Layer layer_;
  double least_eigenvalue_;  // m/Pa
  bool bulges_;              // whether nodes without overlap may be touched
};

}  // namespace taxelsim::bench
