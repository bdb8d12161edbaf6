#include <algorithm>
#include <array>
#include <cmath>
#include <string>
#include <utility>

#include "characterize/limits.h"
#include "characterize/prediction_score.h"
#include "characterize/stamp_baselines.h"
#include "characterize/stamp_places.h"
#include "characterize/stamp_recording.h"
#include "characterize/validation_parts.h"
#include "reference/frame.h"
#include "reference/lag.h"
#include "taxelsim/object.h"

namespace taxelsim {
namespace {

constexpr double kHeight = 5e-3;
constexpr int kSamplesPerTaxel = 8;  // the fit uses covered areas: more samples than a scene needs

double loadOf(const Measurement& measurement) {
  return std::get<StampImages>(measurement.data).load;
}

// Mean over the training stamps at one place; without any, `otherwise`. `key`: such as ".yaw".
double meanOfPose(const Characterization& result, const std::vector<const Measurement*>& same_place, const char* key, double otherwise) {
  double sum = 0, count = 0;
  for (const Measurement* stamp : same_place) {
    const std::string& fixture = std::get<StampImages>(stamp->data).fixture;
    const std::string name = (fixture.empty() ? stamp->name : fixture) + key;
    for (const Estimate& estimate : result.estimates) {
      if (estimate.parameter == name) sum += estimate.value, ++count;
    }
  }
  return count > 0 ? sum / count : otherwise;
}

// The fitted sensor with one gain and one trigger for all taxels that respond.
Characterization withEqualGains(Characterization fitted) {
  for (double& gain : fitted.sensor.readout.taxel_gain) gain = gain > 0 ? 1 : 0;
  fitted.sensor.readout.taxel_trigger.clear();
  return fitted;
}

std::vector<double> predictedBySensor(const Characterization& result, const std::vector<const Measurement*>& same_place,
                                      const Measurement& measurement, double press_gain) {
  const auto& stamp = std::get<StampImages>(measurement.data);
  Sensor sensor = measurement.temperature ? sensorAt(result, *measurement.temperature) : result.sensor;
  sensor.readout.taxel_gain.resize(static_cast<std::size_t>(numTaxels(sensor)), 1);
  for (double& gain : sensor.readout.taxel_gain) gain *= press_gain;
  sensor.samples_per_taxel = kSamplesPerTaxel;
  const auto mean = [&](const char* key, double otherwise = 0) { return meanOfPose(result, same_place, key, otherwise); };
  const std::array<double, 2> measured = stamp.position.value_or(std::array<double, 2>{0, 0});
  const Quaternion tilt = axisAngle({0, 1, 0}, -std::atan(mean(".slope_x"))) * axisAngle({1, 0, 0}, std::atan(mean(".slope_y")));
  const Pose pose{.position = {mean(".x", measured[0]), mean(".y", measured[1]), kHeight / 2},
                  .rotation = tilt * axisAngle({0, 0, 1}, mean(".yaw"))};
  const Object object = stamp.indenter.shape == Indenter::Shape::kFlatPin
                            ? Object("pin", Cylinder{stamp.indenter.radius, kHeight})
                            : Object("stamp", Box{{stamp.indenter.size[0], stamp.indenter.size[1], kHeight}});
  reference::Lag lag(sensor.readout, static_cast<std::size_t>(numTaxels(sensor)));
  reference::FrameInput input;
  input.objects = {{&object, pose}};
  input.load = stamp.load;
  input.dt = kSteady;
  input.lag = &lag;
  const reference::Frame frame = reference::simulateFrame(sensor, input);
  return {frame.counts.begin(), frame.counts.end()};
}

// Readings that the electronics can give, as those of the sensor are: whole counts within the range.
std::vector<double> asCounts(std::vector<double> image, const Readout& readout) {
  for (double& value : image) value = std::clamp(std::round(value), 0.0, static_cast<double>(readout.saturation));
  return image;
}

std::vector<RecordedPress> recordedPresses(const std::vector<Measurement>& stamps, const std::vector<Measurement>& others,
                                           double& longest_fit) {
  const std::vector<std::size_t> places = placesOf(stamps, others, longest_fit);
  std::vector<RecordedPress> presses;
  for (std::size_t k = 0; k < stamps.size(); ++k) {
    const auto& data = std::get<StampImages>(stamps[k].data);
    presses.push_back(
        {.indenter = &data.indenter, .load = data.load, .image = stampOf(stamps[k]).image, .place = places[k], .position = data.position});
  }
  return presses;
}

// Images of the other presses of the same load at the same place.
std::vector<std::vector<double>> repeatsOf(const std::vector<RecordedPress>& presses, std::size_t k) {
  std::vector<std::vector<double>> images;
  for (std::size_t other = 0; other < presses.size(); ++other) {
    if (other != k && presses[other].load == presses[k].load && presses[other].place == presses[k].place) {
      images.push_back(presses[other].image);
    }
  }
  return images;
}

// Other loads at the place of press k.
std::vector<const Measurement*> samePlace(const std::vector<Measurement>& stamps, const std::vector<RecordedPress>& presses,
                                          std::size_t k) {
  std::vector<const Measurement*> found;
  for (std::size_t other = 0; other < presses.size(); ++other) {
    if (presses[other].place == presses[k].place && presses[other].load != presses[k].load) found.push_back(&stamps[other]);
  }
  return found;
}

std::vector<double> loadsOf(const std::vector<Measurement>& stamps) {
  std::vector<double> loads;
  for (const Measurement& stamp : stamps) loads.push_back(loadOf(stamp));
  std::sort(loads.begin(), loads.end());
  loads.erase(std::unique(loads.begin(), loads.end()), loads.end());
  return loads;
}

// Why some stamps, or all, are not predicted; empty if all are.
std::string remarkOf(const std::vector<Measurement>& stamps, const std::vector<bool>& is_known) {
  const std::string none = "this set cannot be cross-validated by stamps: ";
  if (loadsOf(stamps).size() < 2) return none + "all have one load, two are needed";
  std::string names;
  for (std::size_t k = 0; k < stamps.size(); ++k) {
    if (!is_known[k]) names += (names.empty() ? "" : ", ") + stamps[k].name;
  }
  if (std::find(is_known.begin(), is_known.end(), true) == is_known.end()) {
    return none + "no two loads were pressed at one place (fixture), and no stamp has a measured position";
  }
  return names.empty() ? "" : "not predicted, because neither another load nor a measured position gives their place: " + names;
}

// Predictors in the order of CrossValidation.
enum : std::size_t { kSensor, kZero, kBlur, kBlurWithGains, kLine, kRepeat, kSensorOnBench, kMeanPress, kEqualGains };

CrossValidation withoutScores() {
  CrossValidation result{.left_out = "loads", .predictors = {}};
  for (const char* const name : {"fitted sensor", "zeros", "blurred footprint, one gain", "blurred footprint, trigger and gains",
                                 "line in the load per taxel", "repeated real press", "fitted sensor with the bench's deviation",
                                 "exact mean of the presses, from repeats", "fitted sensor, every gain 1"}) {
    const std::size_t predictor = result.predictors.size();
    result.predictors.push_back({.name = name, .is_baseline = predictor != kSensor && predictor < kRepeat, .scores = {}});
  }
  return result;
}

}  // namespace

CrossValidation validateStamps(const std::vector<Measurement>& stamps, const std::vector<Measurement>& others) {
  CrossValidation result = withoutScores();
  const std::vector<double> loads = loadsOf(stamps);
  std::vector<RecordedPress> presses;
  std::vector<bool> is_known(stamps.size(), false);  // whether the place is known without the stamp's own image
  if (loads.size() > 1) {
    presses = recordedPresses(stamps, others, result.longest_fit);
    for (std::size_t k = 0; k < stamps.size(); ++k) is_known[k] = presses[k].position || !samePlace(stamps, presses, k).empty();
  }
  result.remark = remarkOf(stamps, is_known);
  for (const double load : loads) {
    std::vector<Measurement> training = others;
    std::vector<RecordedPress> seen;
    std::vector<std::size_t> left_out;
    for (std::size_t k = 0; k < stamps.size(); ++k) {
      if (loadOf(stamps[k]) == load) {
        if (is_known[k]) left_out.push_back(k);
        continue;
      }
      training.push_back(stamps[k]);
      seen.push_back(presses[k]);
    }
    if (left_out.empty()) continue;
    const Characterization fitted = timedFit(training, result.longest_fit);
    const Characterization equal = withEqualGains(fitted);
    const double press_gain = fitted.bench_gains ? std::exp(fitted.bench_gains->at(load)) : 1;
    for (const std::size_t k : left_out) {
      const Sensor& sensor = stamps[k].sensor;
      const std::vector<double>& real = presses[k].image;
      const std::vector<const Measurement*> same_place = samePlace(stamps, presses, k);
      const std::vector<std::vector<double>> repeats = repeatsOf(presses, k);
      const auto addScore = [&](std::size_t predictor, PredictionScore score) {
        score.measurement = stamps[k].name;
        score.load = load;
        result.predictors[predictor].scores.push_back(std::move(score));
      };
      const auto add = [&](std::size_t predictor, const std::vector<double>& predicted) {
        addScore(predictor, scoreOfImage(sensor, predicted, real));
      };
      const std::vector<double> none(real.size(), std::nan(""));
      add(kSensor, predictedBySensor(fitted, same_place, stamps[k], 1));
      add(kZero, std::vector<double>(real.size()));
      add(kBlur, asCounts(blurredFootprint(sensor, seen, presses[k]), sensor.readout));
      add(kBlurWithGains, asCounts(blurredFootprintWithGains(sensor, seen, presses[k]), sensor.readout));
      add(kLine, same_place.empty() ? none : asCounts(linePerTaxel(seen, presses[k]), sensor.readout));
      add(kSensorOnBench, predictedBySensor(fitted, same_place, stamps[k], press_gain));
      add(kRepeat, repeats.empty() ? none : repeats.front());
      add(kEqualGains, predictedBySensor(equal, same_place, stamps[k], 1));
      addScore(kMeanPress, scoreOfMeanPress(sensor, repeats, real));
    }
  }
  return result;
}

}  // namespace taxelsim
