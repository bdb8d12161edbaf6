#include "characterize/temperature.h"

#include <algorithm>
#include <cmath>

#include "base/text.h"
#include "taxelsim/error.h"

namespace taxelsim {

std::optional<TemperatureTerm> temperatureTermOf(std::span<const Measurement> measurements) {
  const Measurement *with = nullptr, *without = nullptr;
  double low = 1e300, high = -1e300, sum = 0, count = 0;
  for (const Measurement& measurement : measurements) {
    if (!std::holds_alternative<ForceCurve>(measurement.data) && !std::holds_alternative<StampImages>(measurement.data)) continue;
    (measurement.temperature ? with : without) = &measurement;
    if (!measurement.temperature) continue;
    low = std::min(low, *measurement.temperature), high = std::max(high, *measurement.temperature);
    sum += *measurement.temperature, ++count;
  }
  if (with != nullptr && without != nullptr) {
    throw Error(ErrorKind::kInput, without->file.generic_string() + ": temperature_degC is missing, " + with->file.generic_string() +
                                       " has it: give it for all force curves and stamps or for none");
  }
  if (with == nullptr || high - low < kLeastSpan) return {};
  return TemperatureTerm{.reference = sum / count};
}

void addTemperature(Characterization& result, const WithHalfWidth& gain, const WithHalfWidth& trigger) {
  const std::string remark = "around " + numberText(std::round(10 * result.temperature->reference) / 10) + " degrees Celsius";
  const auto add = [&](const char* parameter, const char* unit, const WithHalfWidth& found, double& term) {
    const bool determined = std::isfinite(found.half);
    if (determined) term = found.value;
    result.estimates.push_back({.parameter = parameter,
                                .unit = unit,
                                .determined = determined,
                                .value = found.value,
                                .low = found.value - found.half,
                                .high = found.value + found.half,
                                .remark = determined ? remark : "not identifiable: measure the same taxels at several temperatures"});
  };
  add("temperature.gain", "1/K", gain, result.temperature->gain_per_kelvin);
  add("temperature.trigger", "N/K", trigger, result.temperature->trigger_per_kelvin);
}

Sensor sensorAt(const Characterization& fitted, double temperature) {
  Sensor sensor = fitted.sensor;
  if (!fitted.temperature) return sensor;
  const double warmth = temperature - fitted.temperature->reference;
  const double growth = std::exp(fitted.temperature->gain_per_kelvin * warmth), shift = fitted.temperature->trigger_per_kelvin * warmth;
  Readout& readout = sensor.readout;
  if (readout.taxel_gain.empty()) readout.taxel_gain.assign(static_cast<std::size_t>(numTaxels(sensor)), 1);
  for (double& gain : readout.taxel_gain) gain *= growth;
  readout.trigger += shift;
  for (double& trigger : readout.taxel_trigger) trigger += shift;
  return sensor;
}

}  // namespace taxelsim
