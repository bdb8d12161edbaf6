// How finely triangles are seen by the samples of a sensor; shaders/depth/raster.glsl.
#pragma once

#include <cstdint>

#include "taxelsim/object.h"

namespace taxelsim {

// The samples that meshes are rastered to.
struct SampleGrid {
  double spacing;           // the finest, m
  std::uint32_t tile_side;  // the most samples along a side of a tile
};

// How a mesh is: vertices are rounded to 2^-subpixel_bits of the spacing, 14 bits at best where triangles are small, and large ones go row
// by row.
struct Raster {
  int subpixel_bits;  // 0 to 22
  bool large;
};
Raster chooseRaster(const Mesh& mesh, const SampleGrid& grid);

}  // namespace taxelsim
