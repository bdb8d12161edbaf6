// Bounds of the analytic solids over a patch, from their support functions h(n) = max n . p over the points p of the solid.
#pragma once

#include "reference/sample_grid.h"
#include "taxelsim/object.h"

namespace taxelsim::reference {

// Projection of the shape along `direction_P` (z > 0) onto the plane z = 0 of P. Infinite for half-spaces and meshes.
Rectangle projectedBounds(const Shape& shape, const Pose& X_PO, const Vector3& direction_P);

// Contains the projection along z of P of the part of the shape below z = 0. Empty if there is none; infinite for half-spaces and meshes.
// Tight within a few percent of the part.
Rectangle pressedBounds(const Shape& shape, const Pose& X_PO);

}  // namespace taxelsim::reference
