// Closed forms of a relaxing skin. The twin and the device run the same cases, which check with GoogleTest's expectations.
//
// A skin of stiffness k(t) = k0 [1 - sum fraction (1 - e^(-t / time))] pressed ever deeper carries F(t) = int k(t - s) dV(s), V being the
// volume that the object takes up below the undeformed surface; under a dead load F0 that volume is V(t) = F0 J(t), with the creep
// compliance J of int k(t - s) dJ(s) = 1 (W. N. Findley, J. S. Lai and K. Onaran, Creep and Relaxation of Nonlinear Viscoelastic Materials,
// 1976, chapter 5). Of an elastic layer the force of an instantaneous press takes the place of the volume, as long as the contact grows (E.
// H. Lee and J. R. M. Radok, J. Appl. Mech. 27, 438-444, 1960).
#pragma once

#include "support/test.h"
#include "taxelsim/object.h"
#include "taxelsim/sensor.h"

namespace taxelsim::support {

// One step: where the object is, for how long, and the load that drives it, if one does.
struct Press {
  Pose X_SO;
  double dt = 0;                 // s
  std::optional<double> load{};  // N
};

// Results of a step.
struct Pressed {
  double force = 0;     // N, sum over the taxels
  double smallest = 0;  // N, of a taxel
  double offset = 0;    // m, of the load search
  bool reached = true;  // by the load search
};

// Simulates a frame per step after a reset.
using SimulatePresses = std::function<std::vector<Pressed>(const Sensor& sensor, const Object& object, const std::vector<Press>& steps)>;

// `depth_error` (m): largest error of a depth. `few`: anyTimes() runs a third of its settings.
struct RelaxationCases {
  SimulatePresses simulate;
  double depth_error = 0;
  bool few = false;

  void stepOfDepth() const;
  void anyTimes() const;
  void ramp() const;
  void growingSphere() const;
  void deadLoadOnAFlat() const;
  void deadLoadOnASphere() const;
  void freeRecovery() const;
  void pressedAgain() const;
  void lossOfACycle() const;
  void cyclesLose() const;
  void layerUnderAPunch() const;
  void layerUnderASphere() const;
};

// A case by name, for INSTANTIATE_TEST_SUITE_P.
struct RelaxationCase {
  const char* name;
  void (RelaxationCases::*check)() const;
};

inline constexpr RelaxationCase kRelaxationCases[] = {
    {"StepOfDepth", &RelaxationCases::stepOfDepth},
    {"AnyTimes", &RelaxationCases::anyTimes},
    {"Ramp", &RelaxationCases::ramp},
    {"GrowingSphere", &RelaxationCases::growingSphere},
    {"DeadLoadOnAFlat", &RelaxationCases::deadLoadOnAFlat},
    {"DeadLoadOnASphere", &RelaxationCases::deadLoadOnASphere},
    {"FreeRecovery", &RelaxationCases::freeRecovery},
    {"PressedAgain", &RelaxationCases::pressedAgain},
    {"LossOfACycle", &RelaxationCases::lossOfACycle},
    {"CyclesLose", &RelaxationCases::cyclesLose},
    {"LayerUnderAPunch", &RelaxationCases::layerUnderAPunch},
    {"LayerUnderASphere", &RelaxationCases::layerUnderASphere},
};

}  // namespace taxelsim::support
