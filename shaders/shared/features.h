// Features of a frame: their places in the feature buffers.
#ifndef TAXELSIM_SHADERS_SHARED_FEATURES_H
#define TAXELSIM_SHADERS_SHARED_FEATURES_H

#include "shared/types.h"

TAXELSIM_LAYOUT_BEGIN

// ---- features of an instance ----
// Block after block, each (num_instances x width). A number is that of the block's first component.

TAXELSIM_CONSTANT kFeatureTotalForce = 0u;
TAXELSIM_CONSTANT kFeaturePeakForce = 1u;
TAXELSIM_CONSTANT kFeatureCenterOfPressure = 2u;  // 3
TAXELSIM_CONSTANT kFeatureSecondMoments = 5u;     // 3
TAXELSIM_CONSTANT kFeatureEigenvalues = 8u;       // 2
TAXELSIM_CONSTANT kFeatureEdgeAngle = 10u;
TAXELSIM_CONSTANT kFeatureEdgeConfidence = 11u;
TAXELSIM_CONSTANT kFeatureContactArea = 12u;
TAXELSIM_CONSTANT kNumImageFeatures = 13u;  // features of the measured image start at 0, those of the clean image here
TAXELSIM_CONSTANT kFeatureSaturated = 26u;
TAXELSIM_CONSTANT kFeatureContactWrench = 27u;  // 6
TAXELSIM_CONSTANT kFeatureOverPenetration = 33u;
TAXELSIM_CONSTANT kFeatureLoadOffset = 34u;
TAXELSIM_CONSTANT kFeatureLoadReached = 35u;
TAXELSIM_CONSTANT kFeatureOffArrayLoad = 36u;
TAXELSIM_CONSTANT kFeatureOffArrayContacts = 37u;
// Globally coupled laws only.
TAXELSIM_CONSTANT kFeatureContactResidual = 38u;
TAXELSIM_CONSTANT kFeatureContactIterations = 39u;
TAXELSIM_CONSTANT kNumFeatures = 40u;

// ---- contact features ----
// Rows of an instance: the sensor, its patches (none for a list of taxels), its regions. Block after block, each (num_instances x num_rows
// x width): the image features at the numbers above, then these, then the number of regions (num_instances).

TAXELSIM_CONSTANT kContactWindowedEdgeAngle = 13u;
TAXELSIM_CONSTANT kContactWindowedEdgeConfidence = 14u;
TAXELSIM_CONSTANT kContactTilt = 15u;  // 2
TAXELSIM_CONSTANT kContactTiltConfidence = 17u;
TAXELSIM_CONSTANT kContactType = 18u;
TAXELSIM_CONSTANT kContactPatch = 19u;
TAXELSIM_CONSTANT kNumContactFeatures = 20u;

// ContactType of include/taxelsim/simulator.h.
TAXELSIM_FLOAT kContactNone = 0.0f;
TAXELSIM_FLOAT kContactPoint = 1.0f;
TAXELSIM_FLOAT kContactEdge = 2.0f;
TAXELSIM_FLOAT kContactArea = 3.0f;

// One word per taxel: its region, which is the number of the lowest taxel in it, or kNoRegion for a silent taxel. Flags: kCoreTaxel, the
// taxel lies so far inside the region that its force is that of a wide face; kCoreInRow, the same along its row only.
TAXELSIM_CONSTANT kNoRegion = 0x3FFFFFFFu;
TAXELSIM_CONSTANT kCoreInRow = 0x40000000u;
TAXELSIM_CONSTANT kCoreTaxel = 0x80000000u;

// ---- tactile Jacobian ----
// Derivatives of features by the six coordinates (v, w) of the sensor's twist in S. Rows as for contact features, without regions. Block
// after block, each (num_instances x num_rows x components x 6), then the wrench's (num_instances x 6 x 6).

TAXELSIM_CONSTANT kJacobianCenterOfPressure = 0u;  // 3 x 6
TAXELSIM_CONSTANT kJacobianTotalForce = 18u;       // 6
TAXELSIM_CONSTANT kJacobianEdgeAngle = 24u;        // 6
TAXELSIM_CONSTANT kNumJacobian = 30u;
TAXELSIM_CONSTANT kNumWrenchJacobian = 36u;  // 6 x 6

TAXELSIM_LAYOUT_END

#endif
