#include "taxelsim/cross_validate.h"

#include <algorithm>
#include <ctime>

#include "characterize/validation_parts.h"
#include "taxelsim/error.h"

namespace taxelsim {

Characterization timedFit(const std::vector<Measurement>& measurements, double& longest) {
  const std::clock_t start = std::clock();
  Characterization result = characterize(measurements);
  longest = std::max(longest, static_cast<double>(std::clock() - start) / CLOCKS_PER_SEC);
  return result;
}

std::vector<CrossValidation> crossValidate(std::span<const Measurement> measurements) {
  std::vector<Measurement> stamps, curves, others;
  for (const Measurement& measurement : measurements) {
    const bool is_stamp = std::holds_alternative<StampImages>(measurement.data),
               is_curve = std::holds_alternative<ForceCurve>(measurement.data);
    (is_stamp ? stamps : is_curve ? curves : others).push_back(measurement);
  }
  if (stamps.empty() && curves.empty()) {
    throw Error(ErrorKind::kInput, "cross-validation needs measurements of kind stamp_images or force_curve");
  }
  const auto joined = [&](std::vector<Measurement> some) {
    some.insert(some.end(), others.begin(), others.end());
    return some;
  };
  std::vector<CrossValidation> results;
  if (!stamps.empty()) results.push_back(validateStamps(stamps, joined(curves)));
  if (!curves.empty()) results.push_back(validateForceCurves(curves, joined(stamps)));
  return results;
}

std::vector<CrossValidation> crossValidate(const CharacterizationExperiment& experiment) {
  if (!experiment.separate) return crossValidate(experiment.measurements);
  std::vector<CrossValidation> joined;
  for (const Measurement& measurement : experiment.measurements) {
    for (const CrossValidation& one : crossValidate({&measurement, 1})) {
      const auto same =
          std::find_if(joined.begin(), joined.end(), [&](const CrossValidation& other) { return other.left_out == one.left_out; });
      if (same == joined.end()) {
        joined.push_back(one);
        continue;
      }
      if (!one.remark.empty()) same->remark += (same->remark.empty() ? "" : "; ") + one.remark;
      same->longest_fit = std::max(same->longest_fit, one.longest_fit);
      for (std::size_t p = 0; p < one.predictors.size(); ++p) {
        std::vector<PredictionScore>& scores = same->predictors[p].scores;
        scores.insert(scores.end(), one.predictors[p].scores.begin(), one.predictors[p].scores.end());
      }
    }
  }
  return joined;
}

}  // namespace taxelsim
