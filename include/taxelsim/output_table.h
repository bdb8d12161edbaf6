// Optional outputs of a Simulator: the one table of their names, defaults and texts, for C++ and Python. Features have their own table,
// taxelsim/feature_table.h.
#pragma once

// Each row: X(name, is_default, is_derivative, where, text).
//   name           field of OutputOptions, word of `record` in a scene
//   is_default     default of the field in OutputOptions
//   is_derivative  whether it needs the derivatives of forces by a twist of the sensor
//   where          where a caller finds it, in Python's words
//   text           content and cost
#define TAXELSIM_OUTPUTS(X)                                                                                                               \
  X(tactile_normal_force, true, false, "frame.ground_truth.tactile_normal_force", "Normal force of each taxel.")                          \
  X(tactile_shear_force, true, false, "frame.ground_truth.tactile_shear_force", "Shear force of each taxel.")                             \
  X(penetration_depth, true, false, "frame.ground_truth.penetration_depth", "Mean depth of the object in each taxel.")                    \
  X(taxel_counts, false, false, "frame.taxel_counts", "Counts of three-axis taxels; one more device pass. Needs readout.three_axis.")     \
  X(contact_features, false, false, "frame.contact", "Features of contacts; two more device passes.")                                     \
  X(clean_contact_features, false, false, "frame.ground_truth.contact", "Features of contacts from true forces; two more device passes.") \
  X(tactile_jacobian, false, true, "frame.jacobian",                                                                                      \
    "Derivatives of features by a twist of the sensor. Cost of this one and the next together: two device passes each; four under "       \
    "DeformationMask; one and six more solves under ElasticLayer. Refused for contact points.")                                           \
  X(clean_tactile_jacobian, false, true, "frame.ground_truth.jacobian", "The same from true forces, with the Jacobian of the wrench.")    \
  X(taxel_jacobian, false, true, "frame.ground_truth.taxel_jacobian",                                                                     \
    "Derivatives of taxel forces by a twist of the sensor; one device pass, and one that the others share.")                              \
  X(vjp, false, true, "Simulator.vjp()", "Gradients by vjp(); only the pass that the others share. No Jacobian is read back.")

// Arrays of taxels that such outputs fill. Each row: X(name, block, type, leading, components, unit, text).
//   name        field of OutputOptions, of the view and of the arrays in Python; column of a data set; key of JSON
//   block       buffer that holds them, shaders/passes/blocks.h
//   type        of an element: float or int
//   leading     length of an axis before that of the taxels; 1: none
//   components  per taxel
//   unit        SI
//   text        description
// Measured ones are in FrameView, true ones in GroundTruthView.
#define TAXELSIM_MEASURED_TAXELS(X)                 \
  X(taxel_counts, TaxelCounts, int, 1, 3, "counts", \
    "Output of three-axis taxels along x, y and the normal of each; shear as it acts on the skin, a press positive.")
#define TAXELSIM_TRUE_TAXELS(X)                                                                                  \
  X(tactile_normal_force, SpreadNormal, float, 1, 1, "N",                                                        \
    "Normal force of each taxel after the point spread function, before the readout.")                           \
  X(tactile_shear_force, SpreadShear, float, 1, 2, "N",                                                          \
    "Shear force of each taxel along its x and y after the point spread function, before the readout.")          \
  X(penetration_depth, ContactDepth, float, 1, 1, "m", "Depth of the object in the skin, mean over each taxel.") \
  X(taxel_jacobian, SpreadJacobian, float, 6, 1, "N/m, N/rad",                                                   \
    "Derivative of the normal force of each taxel by the sensor's twist, v then w in the sensor frame, while the objects stay.")
