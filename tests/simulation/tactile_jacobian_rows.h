// The tactile Jacobian of the device against the twin's, within tolerances derived here.
#pragma once

#include <span>

#include "reference/depth.h"
#include "reference/imperfections.h"
#include "simulation/comparison.h"

namespace taxelsim::support {

// All rows of one instance, measured and clean, and the wrench's.
void expectJacobian(const FrameView& frame, int instance, const Sensor& sensor, std::span<const reference::PlacedObject> objects,
                    const reference::ReadoutDraw& draw = {});

}  // namespace taxelsim::support
