#include "taxelsim/compare.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <numeric>
#include <string>
#include <vector>

#include "base/constants.h"
#include "base/median.h"
#include "base/text.h"
#include "base/vector3.h"
#include "reference/features.h"
#include "taxelsim/error.h"

namespace taxelsim {
namespace {

constexpr double kTouch = 0.05;  // of the largest sum of counts: contact

ImageContact contactOf(const Sensor& sensor, std::span<const float> counts) {
  std::vector<double> force;
  std::vector<bool> is_touched;
  for (const float value : counts) {
    force.push_back(nominalForce(sensor.readout, value));
    is_touched.push_back(value > 0);
  }
  const reference::Features features = reference::featuresOf(sensor, force, is_touched);
  if (!(features.total_force > 0)) return {.total_force = 0, .center_of_pressure = {kNaN, kNaN, kNaN}, .edge_angle = kNaN};
  return {.total_force = features.total_force,
          .center_of_pressure = features.center_of_pressure,
          .edge_angle = reference::hasEdge(features) ? features.edge_angle : kNaN};
}

void checkSize(const Sensor& sensor, std::span<const float> image, const char* which) {
  if (image.size() == static_cast<std::size_t>(numTaxels(sensor))) return;
  throw Error(ErrorKind::kInput, std::string(which) + " image: " + std::to_string(image.size()) + " taxels, its sensor has " +
                                     std::to_string(numTaxels(sensor)));
}

}  // namespace

bool haveSameTaxels(const Sensor& a, const Sensor& b) {
  return std::equal(a.patches.begin(), a.patches.end(), b.patches.begin(), b.patches.end(),
                    [](const GridPatch& p, const GridPatch& q) { return p.num_rows == q.num_rows && p.num_cols == q.num_cols; });
}

ImageComparison compareImages(const Sensor& real_sensor, std::span<const float> real, const Sensor& simulated_sensor,
                              std::span<const float> simulated) {
  if (!haveSameTaxels(real_sensor, simulated_sensor)) throw Error(ErrorKind::kInput, "only images of the same array can be compared");
  checkSize(real_sensor, real, "real");
  checkSize(simulated_sensor, simulated, "simulated");

  std::vector<double> differences;  // over the active taxels, counts
  double largest = 0, sum = 0, squares = 0, real_sum = 0, real_squares = 0, simulated_squares = 0, product = 0;
  for (std::size_t t = 0; t < real.size(); ++t) {
    const double r = real[t], s = simulated[t], difference = std::abs(s - r);
    if (r > 0 || s > 0) differences.push_back(difference);
    largest = std::max(largest, r);
    sum += difference;
    squares += difference * difference;
    real_sum += r;
    real_squares += r * r;
    simulated_squares += s * s;
    product += r * s;
  }
  const double full_scale = (1 << real_sensor.readout.adc_bits) - 1;
  const auto ratio = [](double a, double b) { return b > 0 ? a / b : kNaN; };
  ImageComparison result;
  result.num_active = differences.size();
  const auto num_active = static_cast<double>(differences.size());
  result.mean_difference = ratio(sum, num_active * full_scale);
  result.median_difference = differences.empty() ? kNaN : medianOf(std::move(differences)) / full_scale;
  result.rms_difference = ratio(std::sqrt(squares / static_cast<double>(real.size())), largest);
  result.relative_l1 = ratio(sum, real_sum);
  result.cosine = ratio(product, std::sqrt(real_squares * simulated_squares));

  result.real = contactOf(real_sensor, real);
  result.simulated = contactOf(simulated_sensor, simulated);
  result.center_distance = length(subtract(result.simulated.center_of_pressure, result.real.center_of_pressure));
  result.angle_difference = std::abs(std::remainder(result.simulated.edge_angle - result.real.edge_angle, std::numbers::pi));
  return result;
}

ValueRange rangeOf(std::span<const double> values) {
  std::vector<double> defined;
  std::copy_if(values.begin(), values.end(), std::back_inserter(defined), [](double value) { return std::isfinite(value); });
  if (defined.empty()) return {.count = 0, .median = kNaN, .low = kNaN, .high = kNaN};
  const auto [low, high] = std::minmax_element(defined.begin(), defined.end());
  return {.count = defined.size(), .median = medianOf(defined), .low = *low, .high = *high};
}

std::size_t rowAfterTouch(const Images& images, double seconds) {
  if (images.time.empty()) throw Error(ErrorKind::kInput, "the images have no times: cannot select one by its time after contact");
  std::vector<double> sums;
  for (std::size_t row = 0; row < images.time.size(); ++row) {
    const auto first = images.counts.begin() + static_cast<std::ptrdiff_t>(row * images.num_taxels);
    sums.push_back(std::accumulate(first, first + static_cast<std::ptrdiff_t>(images.num_taxels), 0.0));
  }
  const double least = kTouch * *std::max_element(sums.begin(), sums.end());
  const auto touch = std::find_if(sums.begin(), sums.end(), [&](double sum) { return sum > least; });
  if (touch == sums.end()) throw Error(ErrorKind::kInput, "no contact in any image");
  const double touched = images.time[static_cast<std::size_t>(touch - sums.begin())], wanted = touched + seconds;
  if (!(seconds >= 0) || wanted > images.time.back()) {
    throw Error(ErrorKind::kInput, numberText(seconds) + " s after contact is out of range: contact is at " + numberText(touched) +
                                       " s, the last image at " + numberText(images.time.back()) + " s");
  }
  const auto nearer = [&](double a, double b) { return std::abs(a - wanted) < std::abs(b - wanted); };
  return static_cast<std::size_t>(std::min_element(images.time.begin(), images.time.end(), nearer) - images.time.begin());
}

}  // namespace taxelsim
