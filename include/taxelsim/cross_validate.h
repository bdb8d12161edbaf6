/// @file
/// Cross-validation of characterize(): errors of a fitted sensor on measurements that are not part of the fit, and errors of baselines
/// without a sensor model on the same measurements.
#pragma once

#include <span>
#include <string>
#include <vector>

#include "taxelsim/experiment.h"
#include "taxelsim/measurement.h"

namespace taxelsim {

/// Distance of a prediction from what was measured. NaN where undefined.
struct PredictionScore {
  std::string measurement{};     ///< Name of the measurement.
  double load = 0;               ///< N, weight of a stamp; largest force of a force curve.
  double median_difference = 0;  ///< M1: median of `|predicted - real| / full scale` over the taxels or rows where either is above 0.
  double relative_l1 = 0;        ///< M4: sum of `|predicted - real|` / sum of the real counts.
  double sum_ratio = 0;          ///< Sum of the predicted counts / sum of the real counts.
  double center_distance = 0;    ///< m, between the centres of the counts along x and y of S; NaN for force curves.
  double active_ratio = 0;       ///< Taxels or rows above 0: predicted / real.
};

/// A way to predict, and its scores.
struct Predictor {
  std::string name;  ///< Name in reports.
  /// Whether it has no model of the sensor. False for the fitted sensor, a variant of it, and other recordings of the same contact, which
  /// are limits for every simulation.
  bool is_baseline = false;
  std::vector<PredictionScore> scores{};  ///< One entry per prediction, in the same order for all predictors.
};

/// Result for one kind of measurement.
struct CrossValidation {
  std::string left_out;               ///< What each fit has not seen, such as "loads".
  std::vector<Predictor> predictors;  ///< The fitted sensor first, then the baselines.
  std::string remark{};               ///< One line: what could not be left out, and why. Empty if everything was.
  double longest_fit = 0;             ///< s of processor time of the process, during one characterize().
};

/// Fits the sensor without a part of the measurements, predicts that part, and repeats this for each part.
///
/// Stamps: all stamps of one load are left out together. The reference in double precision simulates the prediction. A stamp stands where
/// other loads were pressed at its place, else at its measured position; without both it is not predicted (CrossValidation::remark). The
/// scored image has no part in the prediction. One place: one fixture, or without fixtures fitted positions that agree within a tenth of
/// the pitch. If the gains of the training presses depend on the load (Characterization::bench_gains), the sensor
/// times the expected gain is scored as well, and so is the sensor with one gain and one trigger for all taxels. Baselines: an image of
/// zeros; the footprint under a Gaussian with one gain; the same with a trigger and a ridge-regularised gain per taxel; a straight line in
/// the load per taxel. Limits: another recorded press of the same load; and what a prediction that is exactly the mean of all presses of
/// this load would score, estimated from its n recorded presses: the error of the mean of the n - 1 others, times sqrt(1 - 1/n) because
/// that mean has an error too.
///
/// Force curves: each measurement is cut into cycles of the force, and odd cycles predict even ones and vice versa; with fewer than four
/// cycles, its halves. Baselines: zeros; a straight line in the force per taxel; the median reading of the other half at the same force.
///
/// Other kinds of measurement are in every fit. Throws Error(kInput) as characterize(), and without measurements of these two kinds.
std::vector<CrossValidation> crossValidate(std::span<const Measurement> measurements);

/// The same for the recordings of an experiment, which must not be missing. Separate recordings are validated one by one, and their scores
/// are joined.
std::vector<CrossValidation> crossValidate(const CharacterizationExperiment& experiment);

/// Medians over the scores with load in [from, to), NaN without any: M1, M4, |sum ratio - 1|, centre distance and |active ratio - 1|.
PredictionScore medianScore(const Predictor& predictor, double from, double to);

}  // namespace taxelsim
