// What a float32 device may report for a scene: lower and upper bounds from the double-precision reference.
//
// The surface over each sample is evaluated with the sample moved by +-shift in x and y (nine places) and the lowest and highest value,
// widened by a margin in z, bound the depth: where the surface is smooth the bounds are a few shifts apart, on a silhouette they are as far
// apart as the jump. Every later stage is monotone in the depth, so the bounds are carried through it as intervals, widened by that stage's
// rounding.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "reference/depth.h"
#include "reference/frame.h"

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

// The past of a skin that relaxes. Strain that a sample had earlier takes from its pressure now and adds to the strain it recovers to, so
// that bounds stay bounds: of strain each of its own kind, of pressure the upper one with the lower strains.
struct SkinEnvelope {
  explicit SkinEnvelope(std::span<const RelaxationTerm> terms) : low(terms), high(terms) {}

  reference::SkinHistory low, high;
  int num_steps = 0;
};

// `previous` is the envelope of penetration of the frame before, none in the first frame or under a load; dt in s. `skin` is moved on by
// dt.
FrameEnvelope frameEnvelope(const Sensor& sensor, std::span<const reference::PlacedObject> objects, const Rounding& rounding,
                            const std::optional<Bounded>& previous = {}, double dt = 0, SkinEnvelope* skin = nullptr);

}  // namespace taxelsim::support
