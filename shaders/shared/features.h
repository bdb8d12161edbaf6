// Offsets of the features in their buffers, from include/taxelsim/feature_table.h. A feature is a block (num_rows x width); blocks follow
// each other.
#ifndef TAXELSIM_SHADERS_SHARED_FEATURES_H
#define TAXELSIM_SHADERS_SHARED_FEATURES_H

#include "shared/types.h"
#include "taxelsim/feature_table.h"

TAXELSIM_LAYOUT_BEGIN

#define TAXELSIM_PLUS_WIDTH(constant, name, offset, width, type, unit, frame, recorded, text) +width

// Features of a frame, in components per instance: those of the measured image, those of the clean image, then the others.
TAXELSIM_CONSTANT kNumImageFeatures = 0u TAXELSIM_IMAGE_FEATURES(TAXELSIM_PLUS_WIDTH);
TAXELSIM_CONSTANT kFirstReadoutFeature = 2u * kNumImageFeatures;
TAXELSIM_CONSTANT kFirstTruthFeature = kFirstReadoutFeature TAXELSIM_READOUT_FEATURES(TAXELSIM_PLUS_WIDTH);
TAXELSIM_CONSTANT kNumFeatures = kFirstTruthFeature TAXELSIM_TRUTH_FEATURES(TAXELSIM_PLUS_WIDTH);

// Contact features, in components per row, then the number of regions (num_instances). Rows of an instance: the sensor, its patches (none
// for a list of taxels), its regions. The image features of the row come first.
TAXELSIM_CONSTANT kNumContactFeatures = kNumImageFeatures TAXELSIM_CONTACT_FEATURES(TAXELSIM_PLUS_WIDTH);

// Tactile Jacobian, in components per row, then the Jacobian of the wrench (num_instances). Rows as for contact features, without regions.
TAXELSIM_CONSTANT kNumJacobian = 0u TAXELSIM_JACOBIAN_FEATURES(TAXELSIM_PLUS_WIDTH);
TAXELSIM_CONSTANT kNumWrenchJacobian = 0u TAXELSIM_WRENCH_JACOBIAN(TAXELSIM_PLUS_WIDTH);

#define TAXELSIM_OFFSET(constant, name, offset, width, type, unit, frame, recorded, text) TAXELSIM_CONSTANT constant = offset;
#define TAXELSIM_READOUT_OFFSET(constant, name, offset, width, type, unit, frame, recorded, text) \
  TAXELSIM_CONSTANT constant = kFirstReadoutFeature + offset;
#define TAXELSIM_TRUTH_OFFSET(constant, name, offset, width, type, unit, frame, recorded, text) \
  TAXELSIM_CONSTANT constant = kFirstTruthFeature + offset;
#define TAXELSIM_CONTACT_OFFSET(constant, name, offset, width, type, unit, frame, recorded, text) \
  TAXELSIM_CONSTANT constant = kNumImageFeatures + offset;
#define TAXELSIM_REGION_OFFSET(constant, name, offset, width, type, unit, frame, recorded, text) \
  TAXELSIM_CONSTANT constant = kNumContactFeatures + offset;
#define TAXELSIM_WRENCH_OFFSET(constant, name, offset, width, type, unit, frame, recorded, text) \
  TAXELSIM_CONSTANT constant = kNumJacobian + offset;
TAXELSIM_IMAGE_FEATURES(TAXELSIM_OFFSET)
TAXELSIM_READOUT_FEATURES(TAXELSIM_READOUT_OFFSET)
TAXELSIM_TRUTH_FEATURES(TAXELSIM_TRUTH_OFFSET)
TAXELSIM_CONTACT_FEATURES(TAXELSIM_CONTACT_OFFSET)
TAXELSIM_REGION_FEATURES(TAXELSIM_REGION_OFFSET)
TAXELSIM_JACOBIAN_FEATURES(TAXELSIM_OFFSET)
TAXELSIM_WRENCH_JACOBIAN(TAXELSIM_WRENCH_OFFSET)

// ContactType of include/taxelsim/contact_type.h.
TAXELSIM_FLOAT kContactNone = 0.0f;
TAXELSIM_FLOAT kContactPoint = 1.0f;
TAXELSIM_FLOAT kContactEdge = 2.0f;
TAXELSIM_FLOAT kContactArea = 3.0f;

// One word per taxel: its region, which is the number of the lowest taxel in it, or kNoRegion for a silent taxel. Flags: kCoreTaxel, the
// taxel lies so far inside the region that its force is that of a wide face; kCoreInRow, the same along its row only.
TAXELSIM_CONSTANT kNoRegion = 0x3FFFFFFFu;
TAXELSIM_CONSTANT kCoreInRow = 0x40000000u;
TAXELSIM_CONSTANT kCoreTaxel = 0x80000000u;
// Flag of the largest region of an instance: no taxel outside of it has a force.
TAXELSIM_CONSTANT kOnlyRegion = 0x80000000u;

TAXELSIM_LAYOUT_END

#endif
