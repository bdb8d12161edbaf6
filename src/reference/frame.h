// All stages of the reference in a row for one sensor instance: the double-precision twin of a Simulator's frame.
//
//   poses -> heights -> penetration -> pressure, shear, taxel forces -> spread forces -> lagged force -> counts -> features
//
// Not a simulator: the caller keeps what lasts from frame to frame (penetration and friction of the frame before, held frames).
#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "reference/contact.h"
#include "reference/depth.h"
#include "reference/elastic_layer.h"
#include "reference/features.h"
#include "reference/friction.h"
#include "reference/lag.h"
#include "reference/load.h"
#include "reference/readout.h"
#include "reference/relaxation.h"
#include "reference/taxel_laws.h"

namespace taxelsim::reference {

struct FrameInput {
  std::vector<PlacedObject> objects{};         // empty slots left out
  std::optional<double> load{};                // N; none when pose-driven
  std::vector<double> previous_penetration{};  // of the frame before; empty in the first one. A load-driven frame is at rest and ignores it
  std::vector<TaxelState> taxel_state{};       // the same
  FrictionState previous_friction{};           // Frame::shear.state of the frame before
  double dt = 0;                               // s since then
  SkinHistory* skin = nullptr;                 // of a skin that relaxes, advanced by dt; none: it was never pressed
  ReadoutDraw draw{};
  Lag* lag = nullptr;  // stage 4, advanced by dt; none: a frame shows the spread force itself
};

// Every intermediate value, in the order in which it is computed.
struct Frame {
  LoadResult load;                  // offset 0 and reached when pose-driven; of ElasticLayer offset and reached only
  std::vector<double> heights;      // (num_taxels x s x s), m
  std::vector<double> penetration;  // (num_taxels x s x s), m, 0 to thickness
  Contact contact;                  // its wrench is that of the pressures alone; of ElasticLayer without `pressure` and `strain`
  ContactShear shear;
  LayerContact layer;                   // of ElasticLayer
  double off_array_load = 0;            // N: what the skin's margin carries
  std::array<double, 6> wrench{};       // force (N) and torque (N m) on the sensor at S's origin, in S
  std::vector<TaxelState> taxel_state;  // of laws with one
  std::vector<double> taxel_force;      // (num_taxels), N: contact's, as the law's taxels read them
  std::vector<Shear> taxel_shear;       // (num_taxels), N, the same
  std::vector<double> spread_force;     // (num_taxels), N
  std::vector<Shear> spread_shear;      // (num_taxels), N
  std::vector<double> lagged_force;     // (num_taxels), N
  std::vector<std::uint32_t> counts;    // (num_taxels)
  std::vector<double> measured_force;   // (num_taxels), N
  double saturated = 0;
  Features clean;
  Features measured;
};

Frame simulateFrame(const Sensor& sensor, const FrameInput& input);

}  // namespace taxelsim::reference
