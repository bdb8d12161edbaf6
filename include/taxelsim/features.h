/// @file
/// Views of the features of a batch. Their fields are the rows of taxelsim/feature_table.h, which has units, frames and descriptions.
#pragma once

#include <span>

#include "taxelsim/contact_type.h"
#include "taxelsim/feature_table.h"

namespace taxelsim {

/// Declares the field of a feature, (N x width): N rows, instance-major.
#define TAXELSIM_VIEW(constant, name, offset, width, type, ...) std::span<const type> name;

/// Moments of an image of forces; N = num_instances.
///
/// The edge angle is 1/2 atan2(2 xy, xx - yy) of the second moments, paper eq. (3); its confidence is (l1 - l2) / (l1 + l2) of their
/// eigenvalues. Moments of a sensor of several patches are in the xy plane of S.
struct FeatureView {
  TAXELSIM_IMAGE_FEATURES(TAXELSIM_VIEW)  ///< (N x width).
};

/// Features of contacts on parts of a sensor; N = num_instances x num_rows, for the fields of FeatureView, too.
///
/// Rows of an instance: the sensor; each patch (none for a list of taxels); then the regions with the largest total force. A region is a
/// set of connected taxels that read more than 0, or for clean forces more than their trigger. On a grid patch a taxel is connected with
/// its eight neighbours; on a list with those within 1.5 times the mean size of the two along the skin. Regions do not cross patches. Of
/// two regions with equal force, the one with the lowest taxel comes first.
///
/// Rows without a region are 0; their `patch` is 0 for a sensor of one patch, else -1. Moments and angles are in the plane of `patch`. A
/// region of a list lies in the plane of its taxel with the largest force, onto which the other taxels are projected.
///
/// Windowed edge: for an edge that the array cuts off. Principal axis of the forces under a Gaussian window with a standard deviation of
/// 1.15 times the larger pitch. Four iterations move the window to the centre of the forces under it. 0 if less than a thousandth of the
/// force is under it.
///
/// Ridge edge: for taxels whose gains differ. Ridge of a Gaussian that is fitted to the forces on a logarithmic scale, so that a taxel
/// counts by its relative error. A border of the array does not bias the angle. Forces are divided by Readout::calibrated_gain, which
/// halves the error of scattered gains.
///
/// Tilt: a face rotated by a > 0 about x presses less at +y; one rotated by b > 0 about y presses more at +x. From the slope of the
/// pressure over the core, divided by the stiffness of foundationOf(skin) at the core's mean pressure. The core are the taxels inside patch
/// and contact whose force the point spread does not change; saturated taxels are left out. Its confidence is 1 - RMS residual of a plane
/// through the core's forces over their mean. Undefined for curved objects. 0 with confidence 0 for a core of fewer than four taxels or of
/// taxels on a line, in the plane of S, and on lists.
struct ContactFeatureView : FeatureView {
  int num_rows = 0;                         ///< 1 + num_patches + max_regions; 0 unless requested.
  int num_patches = 0;                      ///< Rows of patches.
  TAXELSIM_CONTACT_FEATURES(TAXELSIM_VIEW)  ///< (N x width).
  TAXELSIM_REGION_FEATURES(TAXELSIM_VIEW)   ///< (num_instances): all regions, of which the largest have rows; 0 if max_regions is 0.
};

/// Derivatives of features by a small twist of the sensor while the objects stay; N = num_instances x num_rows.
///
/// Six columns: velocity v of the origin of S along x, y, z of S (per m), then angular velocity w about x, y, z of S (per rad). The sign is
/// opposite where the sensor rests and the objects move: d center_of_pressure x / d v_x is -1 for a sensor that moves along +x. An
/// instance has a row for the sensor, then one for each patch (none for a list of taxels), as in ContactFeatureView. Undefined derivatives
/// are 0, never NaN: all derivatives without contact, those of an edge angle with confidence 0.
///
/// Computed from the samples of this frame by the force balance of each taxel (Reynolds' transport theorem; shaders/skin/cell_fluxes.glsl):
/// a sideways motion transports force through the taxel's sides, a vertical motion changes it by the law's stiffness. They are therefore
/// derivatives of the features of this array, not of a continuous skin. Assumptions: MassSpringDamper is at rest; a skin that relaxes keeps
/// its present stiffness at every sample; friction has no part; ElasticLayer responds by its own equations over the samples in contact, and
/// if it relaxes, with its instantaneous stiffness. For a load-driven instance, the derivatives are at the pose that the load search found,
/// and that pose stays.
struct TactileJacobianView {
  int num_rows = 0;                          ///< 1 + num_patches; 0 unless requested.
  int num_patches = 0;                       ///< Rows of patches.
  TAXELSIM_JACOBIAN_FEATURES(TAXELSIM_VIEW)  ///< (N x width / 6 x 6).
};

/// The same from clean forces, and the Jacobian of the contact wrench.
struct CleanTactileJacobianView : TactileJacobianView {
  TAXELSIM_WRENCH_JACOBIAN(TAXELSIM_VIEW)  ///< (num_instances x 6 x 6), of the normal forces.
};

/// Features of the readout.
struct ReadoutFeatureView : FeatureView {
  TAXELSIM_READOUT_FEATURES(TAXELSIM_VIEW)  ///< (N x width).
};

/// Features that no sensor could measure; those that need an ElasticLayer are empty under other laws.
///
/// off_array_load: of contact points, the normal force of those that lie on no taxel; it is in no other output, contact_wrench included,
/// because a force without a patch has no direction. Of objects, the force on the margin of an ElasticLayer, part of contact_wrench.
struct TruthFeatureView : FeatureView {
  TAXELSIM_TRUTH_FEATURES(TAXELSIM_VIEW)  ///< (N x width).
};

#undef TAXELSIM_VIEW

}  // namespace taxelsim
