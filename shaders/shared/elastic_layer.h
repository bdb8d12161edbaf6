// Arrays of the elastic layer's solver over its nodes: rows of nodes, padded to strips of kStrip. An instance has one
// array of each kind.
#ifndef TAXELSIM_SHADERS_SHARED_ELASTIC_LAYER_H
#define TAXELSIM_SHADERS_SHARED_ELASTIC_LAYER_H

#include "shared/types.h"

TAXELSIM_LAYOUT_BEGIN

TAXELSIM_CONSTANT kStrip = 4u;
TAXELSIM_CONSTANT kLayerPressure = 0u;   // p as the displacement of its own cell, in thicknesses; kept from frame to frame
TAXELSIM_CONSTANT kLayerTarget = 1u;     // prescribed displacement, in thicknesses
TAXELSIM_CONSTANT kLayerResidual = 2u;   // residual: A p - target, in thicknesses
TAXELSIM_CONSTANT kLayerDirection = 3u;  // search direction d of the conjugate gradient method
TAXELSIM_CONSTANT kLayerProduct = 4u;    // A d
TAXELSIM_CONSTANT kNumLayerArrays = 5u;
// A skin that relaxes has these as well, kept from frame to frame, in the units of p. A further array follows for each further term.
TAXELSIM_CONSTANT kLayerStrain = 5u;
TAXELSIM_CONSTANT kLayerOverstress = 6u;
// With area sampling the last array is a node's own compliance less that of a whole cell, 1. A skin that relaxes has that of the dent
// before it, kept from frame to frame.

// The part of a node's cell that an object covers, with area sampling. Words: mean height (m, as bits, with the slot in the lowest ones)
// over the covered part; covered share (a float's bits), 0 where nothing touches; centroid from the middle of the cell in its widths (2 x
// kCentroidBits, times kCentroidUnit) and how far an edge bounds the covered part (kEdgeBits, 0 to 1), from the lowest bits.
TAXELSIM_CONSTANT kNodeCellWords = 3u;
TAXELSIM_CONSTANT kCentroidBits = 11u;
TAXELSIM_CONSTANT kEdgeBits = 10u;

TAXELSIM_LAYOUT_END

#endif
