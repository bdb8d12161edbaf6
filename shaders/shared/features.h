// Features of a frame: the one table of names, offsets, units and texts.
#ifndef TAXELSIM_SHADERS_SHARED_FEATURES_H
#define TAXELSIM_SHADERS_SHARED_FEATURES_H

#include "shared/types.h"

TAXELSIM_LAYOUT_BEGIN

// One table per group of features. Each row: X(constant, name, offset, width, unit, frame, recorded, text).
//   constant  the offset's name in shaders and in taxelsim::layout
//   name      field of the view in include/taxelsim/simulator.h, column of a data set, key of JSON
//   offset    number of the block's first component in its buffer, in components
//   width     components
//   unit      SI; "1" for numbers without a unit
//   frame     frame of the components: S sensor, P patch, "-" none
//   recorded  in which data sets the feature is a column: "always", "never", or "elastic_layer" for those of that law
//   text      description of the column; {} is replaced by the source of the feature
// src/simulation/feature_table.cpp makes views, columns, JSON and text of them; docs/data_set.md is tested against them.

// Features of the measured image. In the buffer they start at 0; those of the clean image start at kNumImageFeatures. Block after block,
// each (num_instances x width).
#define TAXELSIM_IMAGE_FEATURES(X)                                                                                                        \
  X(kFeatureTotalForce, total_force, 0u, 1u, "N", "-", "always", "Sum of {}.")                                                            \
  X(kFeaturePeakForce, peak_force, 1u, 1u, "N", "-", "always", "Largest of {}.")                                                          \
  X(kFeatureCenterOfPressure, center_of_pressure, 2u, 3u, "m", "S", "always",                                                             \
    "Mean position in the sensor frame, weighted by {}; 0 without contact.")                                                              \
  X(kFeatureSecondMoments, second_moments, 5u, 3u, "m^2", "P", "always", "Second moments xx, xy, yy of {} about the centre of pressure.") \
  X(kFeatureEigenvalues, eigenvalues, 8u, 2u, "m^2", "-", "always", "Eigenvalues of the second moments of {}, larger first.")             \
  X(kFeatureEdgeAngle, edge_angle, 10u, 1u, "rad", "P", "always", "Angle of the major axis of {}, in (-pi/2, pi/2]; 0 where undefined.")  \
  X(kFeatureEdgeConfidence, edge_confidence, 11u, 1u, "1", "-", "always", "Difference of the eigenvalues of {} over their sum, 0 to 1.")  \
  X(kFeatureContactArea, contact_area, 12u, 1u, "m^2", "-", "always", "Area of the taxels above the trigger, from {}.")
TAXELSIM_CONSTANT kNumImageFeatures = 13u;

// Further features of an instance, in the same buffer after both groups of image features.
#define TAXELSIM_READOUT_FEATURES(X) \
  X(kFeatureSaturated, saturated, 26u, 1u, "1", "-", "always", "Fraction of the taxels at the upper end of their range.")
#define TAXELSIM_TRUTH_FEATURES(X)                                                                                    \
  X(kFeatureContactWrench, contact_wrench, 27u, 6u, "N, N m", "S", "always",                                          \
    "Force and torque on the sensor at the origin of its frame, in that frame, before the point spread function.")    \
  X(kFeatureOverPenetration, over_penetration, 33u, 1u, "1", "-", "always",                                           \
    "Fraction of the samples at least as deep as the skin is thick.")                                                 \
  X(kFeatureLoadOffset, load_offset, 34u, 1u, "m", "S", "never",                                                      \
    "Displacement of the objects along z by the load search; 0 when pose-driven.")                                    \
  X(kFeatureLoadReached, load_reached, 35u, 1u, "1", "-", "never",                                                    \
    "1 when pose-driven or the load is carried, 0 when it is out of reach.")                                          \
  X(kFeatureOffArrayLoad, off_array_load, 36u, 1u, "N", "-", "elastic_layer",                                         \
    "Normal force on the margin of the skin, outside the taxels.")                                                    \
  X(kFeatureOffArrayContacts, off_array_contacts, 37u, 1u, "1", "-", "never", "Contact points that lie on no taxel.") \
  X(kFeatureContactResidual, contact_residual, 38u, 1u, "1", "-", "elastic_layer",                                    \
    "Root mean square error of the surface displacements, relative to the deepest one.")                              \
  X(kFeatureContactIterations, contact_iterations, 39u, 1u, "1", "-", "elastic_layer", "Iterations of the contact solver.")
TAXELSIM_CONSTANT kNumFeatures = 40u;

// Contact features. Rows of an instance: the sensor, its patches (none for a list of taxels), its regions. Block after block, each
// (num_instances x num_rows x width): the image features at the offsets above, then these, then the number of regions (num_instances).
#define TAXELSIM_CONTACT_FEATURES(X)                                                                                                      \
  X(kContactWindowedEdgeAngle, windowed_edge_angle, 13u, 1u, "rad", "P", "always",                                                        \
    "Angle of the major axis of {} under a Gaussian window, in (-pi/2, pi/2]; 0 where undefined.")                                        \
  X(kContactWindowedEdgeConfidence, windowed_edge_confidence, 14u, 1u, "1", "-", "always",                                                \
    "Difference of the eigenvalues under that window over their sum, 0 to 1.")                                                            \
  X(kContactTilt, tilt, 15u, 2u, "rad", "P", "always", "Rotation of a flat face about x and y of its patch, from {}; 0 where undefined.") \
  X(kContactTiltConfidence, tilt_confidence, 17u, 1u, "1", "-", "always", "How well a flat face explains {} inside the contact, 0 to 1.") \
  X(kContactType, contact_type, 18u, 1u, "1", "-", "always", "0 none, 1 point, 2 edge, 3 area.")                                          \
  X(kContactPatch, patch, 19u, 1u, "1", "-", "always",                                                                                    \
    "Number of the patch, of a list the taxel, in whose plane moments and angles are; -1 the xy plane of the sensor frame.")              \
  X(kContactRidgeEdgeAngle, ridge_edge_angle, 20u, 1u, "rad", "P", "always",                                                              \
    "Angle of the ridge of a Gaussian fitted to {}, in (-pi/2, pi/2]; 0 where undefined. Robust to gains that differ between taxels.")    \
  X(kContactRidgeEdgeConfidence, ridge_edge_confidence, 21u, 1u, "1", "-", "always",                                                      \
    "Difference of the curvatures of that Gaussian across and along the ridge over their sum, 0 to 1.")
TAXELSIM_CONSTANT kNumContactFeatures = 22u;
#define TAXELSIM_REGION_FEATURES(X) \
  X(kContactNumRegions, num_regions, 22u, 1u, "1", "-", "always", "Regions of connected taxels; the largest have rows.")

// Tactile Jacobian: derivatives of features by the six coordinates (v, w) of the sensor's twist in S. Rows as for contact features, without
// regions. Block after block, each (num_instances x num_rows x width), then the wrench's (num_instances x 36). Each width is 6 per
// component of the feature.
#define TAXELSIM_JACOBIAN_FEATURES(X)                                                                                        \
  X(kJacobianCenterOfPressure, center_of_pressure, 0u, 18u, "1, m/rad", "S", "always",                                       \
    "Derivative of the centre of pressure by the sensor's twist, v then w in the sensor frame, from {}; 0 without contact.") \
  X(kJacobianTotalForce, total_force, 18u, 6u, "N/m, N/rad", "S", "always",                                                  \
    "Derivative of the total force by the sensor's twist, v then w in the sensor frame, from {}.")                           \
  X(kJacobianEdgeAngle, edge_angle, 24u, 6u, "rad/m, 1", "P", "always",                                                      \
    "Derivative of the edge angle by the sensor's twist, v then w in the sensor frame, from {}; 0 where undefined.")
TAXELSIM_CONSTANT kNumJacobian = 30u;
#define TAXELSIM_WRENCH_JACOBIAN(X)                                                            \
  X(kJacobianContactWrench, contact_wrench, 30u, 36u, "N/m, N/rad, N, N m/rad", "S", "always", \
    "Derivative of the contact wrench by the sensor's twist, v then w in the sensor frame, of the normal forces.")
TAXELSIM_CONSTANT kNumWrenchJacobian = 36u;  // 6 x 6

#define TAXELSIM_OFFSET(constant, name, offset, width, unit, frame, recorded, text) TAXELSIM_CONSTANT constant = offset;
TAXELSIM_IMAGE_FEATURES(TAXELSIM_OFFSET)
TAXELSIM_READOUT_FEATURES(TAXELSIM_OFFSET)
TAXELSIM_TRUTH_FEATURES(TAXELSIM_OFFSET)
TAXELSIM_CONTACT_FEATURES(TAXELSIM_OFFSET)
TAXELSIM_REGION_FEATURES(TAXELSIM_OFFSET)
TAXELSIM_JACOBIAN_FEATURES(TAXELSIM_OFFSET)
TAXELSIM_WRENCH_JACOBIAN(TAXELSIM_OFFSET)

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
// Flag of the largest region of an instance: no taxel outside of it has a force.
TAXELSIM_CONSTANT kOnlyRegion = 0x80000000u;

TAXELSIM_LAYOUT_END

#endif
