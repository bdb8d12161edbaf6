// How a mesh is rastered to the samples of a sensor; shaders/depth/raster.glsl.
#pragma once

#include <cstdint>

#include "taxelsim/object.h"

namespace taxelsim {

// The samples of a sensor, as far as rounding needs them.
struct SampleGrid {
  double spacing;           // the finest, m
  std::uint32_t tile_side;  // the most samples along a side of a tile
};

struct Raster {
  int subpixel_bits;  // vertices are rounded to 2^-subpixel_bits of the spacing; 0 to 22, at most 14 for small triangles
  bool large;         // triangles are rastered row by row, else sample by sample
};
Raster chooseRaster(const Mesh& mesh, const SampleGrid& grid);

}  // namespace taxelsim
