/// @file
/// The scale of pictures of tactile images: which counts have the brightest colour.
#pragma once

#include <cstdint>
#include <span>
#include <string>

#include "taxelsim/dataset.h"

namespace taxelsim {

/// Counts of the brightest colour for these counts: the 99.9th percentile of those beyond noise. At least 1, and at least ten standard
/// deviations of the noise, so that a picture without contact stays dark. A whole number if all counts are.
///
/// `noise`: counts, standard deviation.
double countsRange(std::span<const double> counts, double noise);

/// The same for a column of a data set: data/tactile_image, or data/taxel_counts, of which the normal axis counts; also of one sensor,
/// data/NAME/... The noise is that of the scene.
///
/// Reads frames [first, end), or at most 4096 of them in 16 blocks that are evenly spaced: the same data set has the same scale. Throws
/// what DatasetReader::readAsDouble() throws.
double countsRange(const DatasetReader& reader, const std::string& column, std::uint64_t first, std::uint64_t end);

/// Counts, standard deviation of the noise of such a column, by the scene of the data set; of several sensors the largest. 0 if the
/// manifest holds no scene.
double countsNoise(const Manifest& manifest, const std::string& column);

/// Standard deviations of the noise of an axis; pictures show no shear below them. Noise alone exceeds them in 1 of 200,000 taxels.
inline constexpr double kShearDeviations = 5;

}  // namespace taxelsim
