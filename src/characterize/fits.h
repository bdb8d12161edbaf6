// The steps of characterize(), one function per kind of measurement. Each adds to the sensor, estimates, fit qualities and figures of
// `result`, and uses the sensor as the steps before left it. characterize() calls them in this order.
#pragma once

#include <array>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "taxelsim/characterize.h"

namespace taxelsim {

// Measurements of one kind.
using Measured = std::span<const Measurement* const>;

// Names for reports: "a", "a and b", "a, b and 3 more".
std::string namesOf(Measured measurements);

// The point spread function at the ends of its 95 % interval.
struct PsfRange {
  Psf low;
  Psf high;
};

// (num_taxels x 2 x 2): covariance of each taxel's gain and trigger (N); 0 if they are known. Empty if all are known.
using ReadoutCovariance = std::vector<std::array<double, 4>>;

// Fits curve, trigger, saturation, hysteresis, noise, taxel_gain, taxel_trigger and dead taxels. `psf_range` is the uncertainty of the
// point spread function, if it was measured.
ReadoutCovariance fitReadout(Measured force_curves, const std::optional<PsfRange>& psf_range, Characterization& result);
// Fits taxel_gain, and the scatter between presses where the pressure is known. Force curves that have determined the gains exclude it.
ReadoutCovariance fitUniformPress(Measured uniform_presses, Characterization& result);
// Fits psf.
void fitPointSpread(Measured point_images, const ReadoutCovariance& covariance, Characterization& result);
// Fits skin.normal_contact_stiffness.
void fitStiffness(Measured force_depths, Characterization& result);
// Fits readout.creep.
void fitCreep(Measured step_responses, Characterization& result);
// Fits psf, and the curve, gains and creep of the readout. The poses of the stamps are unknown.
void fitStampImages(Measured stamp_images, Characterization& result);

// Smallest kernel (taxels per side, at least `least`) that holds 99.5 % of a sampled Gaussian of `sigma` (taxels).
int gaussianKernelSize(double sigma, int least);

}  // namespace taxelsim
