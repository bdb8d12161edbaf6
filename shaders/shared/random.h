// Purposes of random numbers, part of the Philox counter. base/philox.h has the same values.
#ifndef TAXELSIM_SHADERS_SHARED_RANDOM_H
#define TAXELSIM_SHADERS_SHARED_RANDOM_H

#include "shared/types.h"

TAXELSIM_LAYOUT_BEGIN

TAXELSIM_CONSTANT kPurposeReadoutNoise = 1u;
TAXELSIM_CONSTANT kPurposeTaxelGain = 2u;
TAXELSIM_CONSTANT kPurposeBias = 4u;
TAXELSIM_CONSTANT kPurposeDeadTaxel = 5u;
TAXELSIM_CONSTANT kPurposeRandomWalk = 6u;
TAXELSIM_CONSTANT kPurposeAxisNoise = 12u;  // and the two after it: one per axis
TAXELSIM_CONSTANT kPurposeTaxelTrigger = 15u;

TAXELSIM_LAYOUT_END

#endif
