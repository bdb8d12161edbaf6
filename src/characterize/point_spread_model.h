// The model of images under points: footprint x amplitude -> point spread function -> readout; paper, eq. (1) and section II.A. The
// amplitude of each image is a free parameter, so that errors of the load cell do not affect the point spread function.
#pragma once

#include <cstddef>
#include <vector>

#include "characterize/clipped_mean.h"
#include "characterize/fits.h"
#include "characterize/least_squares.h"
#include "characterize/point_images.h"

namespace taxelsim {

inline constexpr double kLeastSigma = 0.15;  // taxels: lower bound; leaves practically all force on its taxel
inline constexpr double kSeenSigma = 0.2;    // taxels: puts 4e-6 on a neighbour; smaller values are indistinguishable from none
inline constexpr double kMostSigma = 4;      // taxels: upper bound

struct PointSpreadModel {
  Sensor sensor;  // its psf is not used
  ReadoutCovariance covariance;
  std::vector<PointImage> images;
  double noise = kLeastNoise;  // counts

  double top() const { return sensor.readout.saturation; }
};

struct PsfFit {
  Psf psf;
  GroupedFit fit;
};

// Selects the taxels to fit: live taxels that a kernel of `size` reaches from the footprint; without `all`, unclipped readings only.
void chooseTaxels(PointSpreadModel& model, int size, bool all);

// Fits a Gaussian on a kernel of `size`; the shared parameter is sigma in taxels.
PsfFit fitGaussian(const PointSpreadModel& model, int size, double start);

// Fits a kernel of the size of `start`; the shared parameters are all weights but the middle one, which is 1.
PsfFit fitKernel(const PointSpreadModel& model, const Psf& start);

// Standard deviation (counts) of unclipped readings; of all readings if too few are unclipped.
double noiseOf(const PointSpreadModel& model, const GroupedFit& fit);

// Upper end of the one-sided 95 % interval of sigma; kMostSigma if it is above one taxel.
double upperSigma(const PointSpreadModel& model, const PsfFit& found, int size);

}  // namespace taxelsim
