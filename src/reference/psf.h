// Stage 3 of the reference, spread: the point spread function (PSF) of the skin, Kappassov, Corrales and Perdereau, AIM 2020, eq. (1).
//
//   I_t = sum_j F_j g_tj / sum_k g_kj    normalization per_source: the sum of forces is conserved, at borders too
//   I_t = sum_j F_j g_tj                 normalization none: the paper's kernel
//
// g is either a kernel over the rows and columns of a grid (sensor.psf.kernel; does not cross patch borders), or a Gaussian of the distance
// along the skin (sensor.psf.sigma > 0; any arrangement of taxels).
#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "reference/friction.h"
#include "taxelsim/sensor.h"

namespace taxelsim::reference {

// Spread force per taxel from force per taxel, both (num_taxels), N. With per_source, a source whose kernel has no weight inside its patch
// spreads nothing.
std::vector<double> spread(const Sensor& sensor, std::span<const double> taxel_force);

// Non-zero entry of the matrix of spread(): `taxel` receives `share` of the force on `source`.
struct Share {
  std::size_t source = 0;
  std::size_t taxel = 0;
  double share = 0;
};
// The matrix of spread(), sparse; every pair (source, taxel) at most once.
std::vector<Share> spreadMatrix(const Sensor& sensor);

// Spread shear per taxel, (num_taxels), N along x and y of each taxel, with the weights of spread(), so that Coulomb's bound is preserved.
// On a grid the components spread separately. Along a curved skin the force is parallel-transported: rotated by the shortest rotation that
// takes the source's normal to the taxel's.
std::vector<Shear> spreadShear(const Sensor& sensor, std::span<const Shear> taxel_shear);

}  // namespace taxelsim::reference
