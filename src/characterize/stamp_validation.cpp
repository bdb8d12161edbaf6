#include <algorithm>
#include <cmath>
#include <string>
#include <utility>

#include "characterize/prediction_score.h"
#include "characterize/stamp_baselines.h"
#include "characterize/stamp_recording.h"
#include "characterize/validation_parts.h"
#include "reference/frame.h"
#include "reference/lag.h"
#include "taxelsim/error.h"
#include "taxelsim/object.h"

namespace taxelsim {
namespace {

constexpr double kSteady = 5;  // s after contact: the time that the image of a recording stands for
constexpr double kHeight = 5e-3;
constexpr int kSamplesPerTaxel = 8;  // the fit uses covered areas: more samples than a scene needs

double loadOf(const Measurement& measurement) {
  return std::get<StampImages>(measurement.data).load;
}

// Mean over the training stamps that share the wanted one's fixture; over all of them if it has none. `key`: such as ".yaw".
double meanOfPose(const Characterization& result, const std::vector<Measurement>& training, const std::string& fixture, const char* key) {
  double sum = 0, count = 0;
  for (const Measurement& measurement : training) {
    if (!std::holds_alternative<StampImages>(measurement.data)) continue;
    const std::string& own = std::get<StampImages>(measurement.data).fixture;
    if (own != fixture && !fixture.empty()) continue;
    const std::string name = (own.empty() ? measurement.name : own) + key;
    for (const Estimate& estimate : result.estimates) {
      if (estimate.parameter == name) sum += estimate.value, ++count;
    }
  }
  return count > 0 ? sum / count : 0;
}

// The fitted sensor with one gain and one trigger for all taxels that respond.
Characterization withEqualGains(Characterization fitted) {
  for (double& gain : fitted.sensor.readout.taxel_gain) gain = gain > 0 ? 1 : 0;
  fitted.sensor.readout.taxel_trigger.clear();
  return fitted;
}

std::vector<double> predictedBySensor(const Characterization& result, const std::vector<Measurement>& training,
                                      const Measurement& measurement, double press_gain) {
  const auto& stamp = std::get<StampImages>(measurement.data);
  Sensor sensor = measurement.temperature ? sensorAt(result, *measurement.temperature) : result.sensor;
  sensor.readout.taxel_gain.resize(static_cast<std::size_t>(numTaxels(sensor)), 1);
  for (double& gain : sensor.readout.taxel_gain) gain *= press_gain;
  sensor.samples_per_taxel = kSamplesPerTaxel;
  const auto mean = [&](const char* key) { return meanOfPose(result, training, stamp.fixture, key); };
  const Quaternion tilt = axisAngle({0, 1, 0}, -std::atan(mean(".slope_x"))) * axisAngle({1, 0, 0}, std::atan(mean(".slope_y")));
  const Pose pose{.position = {mean(".x"), mean(".y"), kHeight / 2}, .rotation = tilt * axisAngle({0, 0, 1}, mean(".yaw"))};
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

// Images of the other presses of the same load.
std::vector<std::vector<double>> repeatsOf(const std::vector<RecordedPress>& presses, std::size_t k) {
  std::vector<std::vector<double>> images;
  for (std::size_t other = 0; other < presses.size(); ++other) {
    if (other != k && presses[other].load == presses[k].load) images.push_back(presses[other].image);
  }
  return images;
}

// Predictors in the order of CrossValidation.
enum : std::size_t { kSensor, kZero, kBlur, kBlurWithGains, kLine, kRepeat, kSensorOnBench, kMeanPress, kEqualGains };

}  // namespace

CrossValidation validateStamps(const std::vector<Measurement>& stamps, const std::vector<Measurement>& others) {
  CrossValidation result{.left_out = "loads", .predictors = {}};
  for (const char* const name : {"fitted sensor", "zeros", "blurred footprint, one gain", "blurred footprint, trigger and gains",
                                 "line in the load per taxel", "repeated real press", "fitted sensor with the bench's deviation",
                                 "exact mean of the presses, from repeats", "fitted sensor, every gain 1"}) {
    const std::size_t predictor = result.predictors.size();
    result.predictors.push_back({.name = name, .is_baseline = predictor != kSensor && predictor < kRepeat, .scores = {}});
  }
  std::vector<RecordedPress> presses;
  for (const Measurement& stamp : stamps) {
    const auto& data = std::get<StampImages>(stamp.data);
    presses.push_back({.indenter = &data.indenter, .load = data.load, .image = stampOf(stamp).image});
  }
  std::vector<double> loads;
  for (const RecordedPress& press : presses) loads.push_back(press.load);
  std::sort(loads.begin(), loads.end());
  loads.erase(std::unique(loads.begin(), loads.end()), loads.end());
  if (loads.size() < 2) {
    throw Error(ErrorKind::kInput, stamps.front().file.generic_string() + ": all stamps have one load: cross-validation needs two");
  }
  for (const double load : loads) {
    std::vector<Measurement> training = others;
    std::vector<RecordedPress> seen;
    for (std::size_t k = 0; k < stamps.size(); ++k) {
      if (loadOf(stamps[k]) == load) continue;
      training.push_back(stamps[k]);
      seen.push_back(presses[k]);
    }
    const Characterization fitted = timedFit(training, result.longest_fit);
    const Characterization equal = withEqualGains(fitted);
    const double press_gain = fitted.bench_gains ? std::exp(fitted.bench_gains->at(load)) : 1;
    for (std::size_t k = 0; k < stamps.size(); ++k) {
      if (loadOf(stamps[k]) != load) continue;
      const Sensor& sensor = stamps[k].sensor;
      const std::vector<double>& real = presses[k].image;
      const auto addScore = [&](std::size_t predictor, PredictionScore score) {
        score.measurement = stamps[k].name;
        score.load = load;
        result.predictors[predictor].scores.push_back(std::move(score));
      };
      const auto add = [&](std::size_t predictor, const std::vector<double>& predicted) {
        addScore(predictor, scoreOfImage(sensor, predicted, real));
      };
      add(kSensor, predictedBySensor(fitted, training, stamps[k], 1));
      add(kZero, std::vector<double>(real.size()));
      add(kBlur, blurredFootprint(sensor, seen, presses[k]));
      add(kBlurWithGains, blurredFootprintWithGains(sensor, seen, presses[k]));
      add(kLine, linePerTaxel(seen, presses[k]));
      const std::vector<std::vector<double>> repeats = repeatsOf(presses, k);
      add(kSensorOnBench, predictedBySensor(fitted, training, stamps[k], press_gain));
      add(kRepeat, repeats.empty() ? std::vector<double>(real.size(), std::nan("")) : repeats.front());
      add(kEqualGains, predictedBySensor(equal, training, stamps[k], 1));
      addScore(kMeanPress, scoreOfMeanPress(sensor, repeats, real));
    }
  }
  return result;
}

}  // namespace taxelsim
