// Lower and upper bounds for the outputs of a float32 device, from the double-precision reference.
//
// The depth is bounded by the lowest and highest surface at nine positions of the sample, moved by +-shift in x and y, plus a margin in z:
// on a smooth surface the bounds are a few shifts apart, on a silhouette as far as the jump. Later stages are monotone in depth, so the
// bounds pass through them as intervals and are widened by the rounding of each stage.
#pragma once

#include "reference/depth.h"
#include "reference/frame.h"
#include "support/test.h"

namespace taxelsim::support {

// A lower and an upper bound for every element of an array.
struct Bounded {
  std::vector<double> low;
  std::vector<double> high;
};

// Heights (num_taxels x s x s), m.
Bounded heightEnvelope(const Sensor& sensor, std::span<const reference::PlacedObject> objects, double shift, double margin_z);

struct FrameEnvelope {
  Bounded penetration;                   // (num_taxels x s x s), m
  Bounded mean_penetration;              // (num_taxels), m
  Bounded taxel_force;                   // (num_taxels), N
  Bounded spread_force;                  // (num_taxels), N
  Bounded wrench;                        // (6)
  Bounded over_penetration;              // (1)
  double total_low = 0, total_high = 0;  // N: sum over the taxels, before the PSF
};

struct Rounding {
  double shift = 0;           // m, in x and y
  double margin_z = 0;        // m
  double relative_force = 0;  // of a taxel's force
  double absolute_force = 0;  // N
};

// History of a relaxing skin. Earlier strain of a sample reduces its present pressure and adds to its recovery, so the bounds are combined
// accordingly: for strain each with its own kind, for pressure the upper bound with the lower strains.
struct SkinEnvelope {
  explicit SkinEnvelope(std::span<const RelaxationTerm> terms) : low(terms), high(terms) {}

  reference::SkinHistory low, high;
  int num_steps = 0;
};

// `previous`: envelope of the penetration of the previous frame; none for the first frame or under a load. dt in s. `skin` advances by dt.
FrameEnvelope frameEnvelope(const Sensor& sensor, std::span<const reference::PlacedObject> objects, const Rounding& rounding,
                            const std::optional<Bounded>& previous = {}, double dt = 0, SkinEnvelope* skin = nullptr);

}  // namespace taxelsim::support
