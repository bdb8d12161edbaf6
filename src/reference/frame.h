// One frame of one sensor instance in double precision: all stages in sequence. The test oracle of Simulator.
//
//   poses -> heights -> penetration -> pressure, shear -> taxel forces -> spread forces -> lagged forces -> counts -> features
//    (load search)       depth.h,     contact.h,          taxel_laws.h     psf.h            lag.h            readout.h  features.h
//      load.h                         elastic_layer.h,
//                                     friction.h
//
// simulateFrame() is stateless: the caller passes in what persists between frames and keeps it afterwards.
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
  std::vector<PlacedObject> objects{};  // without empty slots
  std::optional<double> load{};         // N; empty: pose-driven
  std::vector<double>
      previous_penetration{};             // of the preceding frame; empty in the first. Ignored when load-driven, which is a rest state
  std::vector<TaxelState> taxel_state{};  // of the preceding frame; likewise
  FrictionState previous_friction{};      // Frame::shear.state of the preceding frame
  double dt = 0;                          // s since the preceding frame
  SkinHistory* skin = nullptr;            // of a relaxing skin, advanced by dt; null: never loaded
  ReadoutDraw draw{};
  Lag* lag = nullptr;  // stage 4, advanced by dt; null: no dynamics
};

// All intermediate values, in order of computation. Fields marked "ElasticLayer only" are empty or 0 for other laws.
struct Frame {
  LoadResult load;                  // pose-driven: offset 0, reached. ElasticLayer: only offset and reached are set
  std::vector<double> heights;      // (num_taxels x s x s), m, at the middle of each cell
  std::vector<double> penetration;  // (num_taxels x s x s), m, 0 to thickness
  std::vector<double> share;        // (num_taxels x s x s): of each cell, what is covered; empty with point sampling
  std::vector<CellPoints> points;   // (num_taxels x s x s), AreaDepths::points
  Contact contact;                  // wrench: of the pressures alone. ElasticLayer: without `pressure` and `strain`
  ContactShear shear;
  LayerContact layer;                   // ElasticLayer only
  double off_array_load = 0;            // N, carried by the margin of the skin; ElasticLayer only
  std::array<double, 6> wrench{};       // force (N) and torque (N m) on the sensor at the origin of S, in S
  std::vector<TaxelState> taxel_state;  // for the next frame, of laws with a state
  std::vector<double> taxel_force;      // (num_taxels), N: readings after taxel_laws.h
  std::vector<Shear> taxel_shear;       // (num_taxels), N, likewise
  std::vector<double> spread_force;     // (num_taxels), N
  std::vector<Shear> spread_shear;      // (num_taxels), N
  std::vector<double> lagged_force;     // (num_taxels), N
  std::vector<std::uint32_t> counts;    // (num_taxels)
  std::vector<double> measured_force;   // (num_taxels), N
  double saturated = 0;                 // fraction of taxels at saturation
  Features clean;
  Features measured;
};

Frame simulateFrame(const Sensor& sensor, const FrameInput& input);

}  // namespace taxelsim::reference
