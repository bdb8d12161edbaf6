// Loop iterations that work takes, as estimated: by the host, which gives a workgroup no more than the driver permits, and by the contact
// pass, which counts those of the tiles so far (shaders/driver/loops.glsl).
#ifndef TAXELSIM_SHADERS_SHARED_ITERATIONS_H
#define TAXELSIM_SHADERS_SHARED_ITERATIONS_H

#include "shared/types.h"

TAXELSIM_LAYOUT_BEGIN

TAXELSIM_CONSTANT kIterationsPerSample = 3u;
TAXELSIM_CONSTANT kIterationsPerSampleOfTorus = 48u;  // of at most 96
TAXELSIM_CONSTANT kIterationsPerTriangle = 2u;
// With area sampling: triangles next to each other share cells; of a solid, most cells on an edge take scan lines.
TAXELSIM_CONSTANT kIterationsPerTriangleOfCells = 4u;
TAXELSIM_CONSTANT kIterationsPerCell = 8u;

TAXELSIM_LAYOUT_END

#endif
