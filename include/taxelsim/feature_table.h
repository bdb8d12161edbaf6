// Features of a frame: the one table of their names, offsets, types, units and texts, for C++, GLSL and Python.
#pragma once

// One table per group of features. Each row: X(constant, name, offset, width, type, unit, frame, recorded, text).
//   constant  the offset's name in shaders and in taxelsim::layout
//   name      field of the view in taxelsim/features.h and of the arrays in Python, column of a data set, key of JSON
//   offset    number of the block's first component in its group, in components: the sum of the widths above it
//   width     components
//   type      of a component: float, int, bool or ContactType; a kernel writes all as float
//   unit      SI; "1" for numbers without a unit
//   frame     frame of the components: S sensor, P patch, "-" none
//   recorded  in which data sets the feature is a column: "always", "never", or "elastic_layer" for those of that law
//   text      description; {} is replaced by the source of the feature
// shaders/shared/features.h makes offsets of them, taxelsim/features.h the views, src/simulation/feature_table.cpp columns, JSON and text,
// python/features.py the classes of taxelsim.frame. docs/reference/data_set.md is tested against them.

// Features of an image of forces.
#define TAXELSIM_IMAGE_FEATURES(X)                                                                                                   \
  X(kFeatureTotalForce, total_force, 0u, 1u, float, "N", "-", "always", "Sum of {}.")                                                \
  X(kFeaturePeakForce, peak_force, 1u, 1u, float, "N", "-", "always", "Largest of {}.")                                              \
  X(kFeatureCenterOfPressure, center_of_pressure, 2u, 3u, float, "m", "S", "always",                                                 \
    "Mean position in the sensor frame, weighted by {}; 0 without contact.")                                                         \
  X(kFeatureSecondMoments, second_moments, 5u, 3u, float, "m^2", "P", "always",                                                      \
    "Second moments xx, xy, yy of {} about the centre of pressure.")                                                                 \
  X(kFeatureEigenvalues, eigenvalues, 8u, 2u, float, "m^2", "-", "always", "Eigenvalues of the second moments of {}, larger first.") \
  X(kFeatureEdgeAngle, edge_angle, 10u, 1u, float, "rad", "P", "always",                                                             \
    "Angle of the major axis of {}, in (-pi/2, pi/2]; 0 where undefined.")                                                           \
  X(kFeatureEdgeConfidence, edge_confidence, 11u, 1u, float, "1", "-", "always",                                                     \
    "Difference of the eigenvalues of {} over their sum, 0 to 1.")                                                                   \
  X(kFeatureContactArea, contact_area, 12u, 1u, float, "m^2", "-", "always", "Area of the taxels above the trigger, from {}.")

// Features of the readout.
#define TAXELSIM_READOUT_FEATURES(X) \
  X(kFeatureSaturated, saturated, 0u, 1u, float, "1", "-", "always", "Fraction of the taxels at the upper end of their range.")

// Features that no sensor could measure.
#define TAXELSIM_TRUTH_FEATURES(X)                                                                                         \
  X(kFeatureContactWrench, contact_wrench, 0u, 6u, float, "N, N m", "S", "always",                                         \
    "Force and torque on the sensor at the origin of its frame, in that frame, before the point spread function.")         \
  X(kFeatureOverPenetration, over_penetration, 6u, 1u, float, "1", "-", "always",                                          \
    "Fraction of the samples at least as deep as the skin is thick.")                                                      \
  X(kFeatureLoadOffset, load_offset, 7u, 1u, float, "m", "S", "never",                                                     \
    "Displacement of the objects along z by the load search; 0 when pose-driven.")                                         \
  X(kFeatureLoadReached, load_reached, 8u, 1u, bool, "1", "-", "never",                                                    \
    "1 when pose-driven or the load is carried, 0 when it is out of reach.")                                               \
  X(kFeatureOffArrayLoad, off_array_load, 9u, 1u, float, "N", "-", "elastic_layer",                                        \
    "Normal force on the margin of the skin, outside the taxels.")                                                         \
  X(kFeatureOffArrayContacts, off_array_contacts, 10u, 1u, int, "1", "-", "never", "Contact points that lie on no taxel.") \
  X(kFeatureContactResidual, contact_residual, 11u, 1u, float, "1", "-", "elastic_layer",                                  \
    "Root mean square error of the surface displacements, relative to the deepest one.")                                   \
  X(kFeatureContactIterations, contact_iterations, 12u, 1u, int, "1", "-", "elastic_layer", "Iterations of the contact solver.")

// Features of a contact on a part of the sensor, in addition to the image features of that part.
#define TAXELSIM_CONTACT_FEATURES(X)                                                                                                   \
  X(kContactWindowedEdgeAngle, windowed_edge_angle, 0u, 1u, float, "rad", "P", "always",                                               \
    "Angle of the major axis of {} under a Gaussian window, in (-pi/2, pi/2]; 0 where undefined.")                                     \
  X(kContactWindowedEdgeConfidence, windowed_edge_confidence, 1u, 1u, float, "1", "-", "always",                                       \
    "Difference of the eigenvalues under that window over their sum, 0 to 1.")                                                         \
  X(kContactTilt, tilt, 2u, 2u, float, "rad", "P", "always",                                                                           \
    "Rotation of a flat face about x and y of its patch, from {}; 0 where undefined.")                                                 \
  X(kContactTiltConfidence, tilt_confidence, 4u, 1u, float, "1", "-", "always",                                                        \
    "How well a flat face explains {} inside the contact, 0 to 1.")                                                                    \
  X(kContactType, contact_type, 5u, 1u, ContactType, "1", "-", "always", "0 none, 1 point, 2 edge, 3 area.")                           \
  X(kContactPatch, patch, 6u, 1u, int, "1", "-", "always",                                                                             \
    "Number of the patch, of a list the taxel, in whose plane moments and angles are; -1 the xy plane of the sensor frame.")           \
  X(kContactRidgeEdgeAngle, ridge_edge_angle, 7u, 1u, float, "rad", "P", "always",                                                     \
    "Angle of the ridge of a Gaussian fitted to {}, in (-pi/2, pi/2]; 0 where undefined. Robust to gains that differ between taxels.") \
  X(kContactRidgeEdgeConfidence, ridge_edge_confidence, 8u, 1u, float, "1", "-", "always",                                             \
    "Difference of the curvatures of that Gaussian across and along the ridge over their sum, 0 to 1.")

// One value per instance.
#define TAXELSIM_REGION_FEATURES(X) \
  X(kContactNumRegions, num_regions, 0u, 1u, int, "1", "-", "always", "Regions of connected taxels; the largest have rows.")

// Tactile Jacobian: derivatives of features by the six coordinates (v, w) of the sensor's twist in S. Each width is 6 per component of the
// feature.
#define TAXELSIM_JACOBIAN_FEATURES(X)                                                                                        \
  X(kJacobianCenterOfPressure, center_of_pressure, 0u, 18u, float, "1, m/rad", "S", "always",                                \
    "Derivative of the centre of pressure by the sensor's twist, v then w in the sensor frame, from {}; 0 without contact.") \
  X(kJacobianTotalForce, total_force, 18u, 6u, float, "N/m, N/rad", "S", "always",                                           \
    "Derivative of the total force by the sensor's twist, v then w in the sensor frame, from {}.")                           \
  X(kJacobianEdgeAngle, edge_angle, 24u, 6u, float, "rad/m, 1", "P", "always",                                               \
    "Derivative of the edge angle by the sensor's twist, v then w in the sensor frame, from {}; 0 where undefined.")

// One matrix per instance, of the normal forces.
#define TAXELSIM_WRENCH_JACOBIAN(X)                                                                  \
  X(kJacobianContactWrench, contact_wrench, 0u, 36u, float, "N/m, N/rad, N, N m/rad", "S", "always", \
    "Derivative of the contact wrench by the sensor's twist, v then w in the sensor frame, of the normal forces.")
