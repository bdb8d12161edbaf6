#include "taxelsim/readings.h"

#include <algorithm>
#include <cmath>
#include <span>
#include <string>

#include "characterize/unspread.h"
#include "reference/readout.h"
#include "taxelsim/error.h"

namespace taxelsim {
namespace {

// N per taxel from counts per taxel.
void undoReadout(const Sensor& sensor, const Images& images, Readings& readings) {
  const Readout& readout = sensor.readout;
  for (int t = 0; t < numTaxels(sensor); ++t) {
    if (reference::gainOf(readout, static_cast<std::size_t>(t)) == 0) readings.dead_taxels.push_back(t);
  }
  for (std::size_t k = 0; k < images.counts.size(); ++k) {
    const std::size_t taxel = k % images.num_taxels;
    const double counts = std::min<double>(images.counts[k], readout.saturation);
    const double gain = reference::gainOf(readout, taxel);
    readings.num_saturated += counts == readout.saturation ? 1 : 0;
    // nominalForce() assumes the sensor's trigger and a gain of 1.
    const double at_curve = nominalForce(readout, counts) - readout.trigger;
    readings.force.push_back(counts > 0 && gain > 0 ? (at_curve + reference::triggerOf(readout, taxel)) / gain : 0);
  }
}

// Inverts the recursion of creep. After a step dt with d = exp(-dt / time) for each term, a force x reads
// x (1 + sum fraction (1 - d)) + sum fraction d state, and the term's state becomes x (1 - d) + state d.
void undoCreep(const Sensor& sensor, const Images& images, std::vector<double>& force) {
  const std::vector<CreepTerm>& terms = sensor.readout.creep;
  std::vector<double> states(images.num_taxels * terms.size(), 0.0);  // N
  for (std::size_t row = 0; row < images.time.size(); ++row) {
    const double dt = row == 0 ? 0 : images.time[row] - images.time[row - 1];
    std::vector<double> decay;
    for (const CreepTerm& term : terms) decay.push_back(std::exp(-dt / term.time));
    for (std::size_t t = 0; t < images.num_taxels; ++t) {
      double& value = force[row * images.num_taxels + t];
      const std::span<double> state(&states[t * terms.size()], terms.size());
      double crept = 0, growth = 1;
      for (std::size_t m = 0; m < terms.size(); ++m) {
        crept += terms[m].fraction * decay[m] * state[m];
        growth += terms[m].fraction * (1 - decay[m]);
      }
      value = std::max(0.0, (value - crept) / growth);
      for (std::size_t m = 0; m < terms.size(); ++m) state[m] = value + (state[m] - value) * decay[m];
    }
  }
}

void undoSpread(const Sensor& sensor, const Images& images, std::vector<double>& force) {
  Unspread unspread(sensor);
  for (std::size_t first = 0; first < force.size(); first += images.num_taxels) {
    const std::span<double> image(&force[first], images.num_taxels);
    const std::vector<double> source = unspread.forceOf(image);
    std::copy(source.begin(), source.end(), image.begin());
  }
}

}  // namespace

Readings readingsInNewtons(const Sensor& sensor, const Images& images, const ReadingsOptions& options) {
  if (images.num_taxels != static_cast<std::size_t>(numTaxels(sensor))) {
    throw Error(ErrorKind::kInput,
                "images of " + std::to_string(images.num_taxels) + " taxels, the sensor has " + std::to_string(numTaxels(sensor)));
  }
  if (options.remove_creep && images.time.empty()) throw Error(ErrorKind::kInput, "removing creep needs the times of the images");
  Readings readings;
  undoReadout(sensor, images, readings);
  if (options.remove_creep && !sensor.readout.creep.empty()) undoCreep(sensor, images, readings.force);
  if (options.remove_spread) undoSpread(sensor, images, readings.force);
  return readings;
}

}  // namespace taxelsim
