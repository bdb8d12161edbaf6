// What characterize() is made of: one function a kind of measurement. Each puts what it finds into `result`: sensor, estimates, quality and
// figures. They run in the order in which they stand here, each with the sensor that those before have found.
#pragma once

#include <Eigen/Core>
#include <optional>
#include <span>
#include <vector>

#include "taxelsim/characterize.h"

namespace taxelsim {

// One measurement of a kind; the kind's data are in it.
using Measured = std::span<const Measurement* const>;

// How far the point spread function may be off: at the ends of its 95 % interval. Without value where it was not measured.
struct PsfRange {
  Psf low;
  Psf high;
};

// (num_taxels): covariance of a taxel's gain and trigger (N), 0 where they are taken for known. Empty where all are.
using ReadoutDoubt = std::vector<Eigen::Matrix2d>;

// curve, trigger, saturation, hysteresis, noise, taxel_gain, taxel_trigger, dead taxels. What a force leaves to its taxel is known as well
// as the point spread function is.
ReadoutDoubt fitReadout(Measured force_curves, const std::optional<PsfRange>& psf_range, Characterization& result);
void fitPointSpread(Measured point_images, const ReadoutDoubt& doubt, Characterization& result);  // psf
void fitStiffness(Measured force_depths, Characterization& result);                               // skin.normal_contact_stiffness
void fitCreep(Measured step_responses, Characterization& result);                                 // readout.creep
void fitStampImages(Measured stamp_images, Characterization& result);  // psf, readout's scale and creep, with the stamp's pose unknown

// The smallest kernel (taxels per side), not below `least`, that leaves out no more than 0.5 % of a sampled Gaussian of `sigma` (taxels).
int gaussianKernelSize(double sigma, int least);

}  // namespace taxelsim
