// Stage 3 of the reference: the point spread function (paper eq. (1)), patch by patch or by distance along the skin.
#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "reference/friction.h"
#include "taxelsim/sensor.h"

namespace taxelsim::reference {

// Force per taxel -> spread force per taxel, (num_taxels), N. Per source, a taxel's force is shared among its neighbours inside the patch
// in proportion to the kernel; a kernel with no weight inside the patch spreads nothing.
std::vector<double> spread(const Sensor& sensor, std::span<const double> taxel_force);

// spread() as a sparse matrix: what `taxel` gets of the force on `source`; every pair stands at most once.
struct Share {
  std::size_t source = 0;
  std::size_t taxel = 0;
  double share = 0;
};
std::vector<Share> spreadMatrix(const Sensor& sensor);

// spread() of shear, (num_taxels), N along x and y of each taxel: with the weights of the normal force, component by component, since the
// taxels of a patch have one frame. Along the skin a force turns with it: by the shortest turn that takes the source's normal to the
// taxel's.
std::vector<Shear> spreadShear(const Sensor& sensor, std::span<const Shear> taxel_shear);

}  // namespace taxelsim::reference
