// Arrays of the elastic layer's solver over its nodes: rows of strips of kStrip nodes, the last strip of a row padded. An instance has one
// array of each kind.
#ifndef TAXELSIM_SHADERS_SHARED_ELASTIC_LAYER_H
#define TAXELSIM_SHADERS_SHARED_ELASTIC_LAYER_H

#include "shared/types.h"

TAXELSIM_LAYOUT_BEGIN

TAXELSIM_CONSTANT kStrip = 8u;
TAXELSIM_CONSTANT kLayerPressure = 0u;   // p as the displacement of its own cell, in thicknesses; kept from frame to frame
TAXELSIM_CONSTANT kLayerTarget = 1u;     // prescribed displacement, in thicknesses
TAXELSIM_CONSTANT kLayerResidual = 2u;   // residual: A p - target, in thicknesses
TAXELSIM_CONSTANT kLayerDirection = 3u;  // search direction d of the conjugate gradient method
TAXELSIM_CONSTANT kLayerProduct = 4u;    // A d
TAXELSIM_CONSTANT kNumLayerArrays = 5u;
// A skin that relaxes has these as well, kept from frame to frame, in the units of p. A further array follows for each further term.
TAXELSIM_CONSTANT kLayerStrain = 5u;
TAXELSIM_CONSTANT kLayerOverstress = 6u;

TAXELSIM_LAYOUT_END

#endif
