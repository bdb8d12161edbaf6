#include <limits>

#include "taxelsim/experiment.h"
#include "taxelsim/model.h"
#include "taxelsim/simulator.h"

namespace taxelsim {
namespace {

constexpr double kPressDt = 1;        // s; results of a first step at rest do not depend on it
constexpr double kPinLength = 20e-3;  // m, more than any skin is thick

// Presses of one sensor: first all depths at all places, then all loads on all taxels.
struct Presses {
  std::vector<Pose> X_SO;
  std::vector<float> loads;  // N; kPoseDriven for a depth
};

// A pin `depth` (m) below the skin, at (x, y) from the middle of a taxel.
Pose pinOn(const Sensor& sensor, int taxel, double x, double y, double depth) {
  const GridPatch& patch = sensor.patches.front();
  const Vector3 middle = inverse(patch.X_SP) * taxelPositions(sensor)[static_cast<std::size_t>(taxel)];
  return patch.X_SP * Pose{{middle[0] + x, middle[1] + y, kPinLength / 2 - depth}, {1, 0, 0, 0}};
}

Presses pressesOf(const CalibrationExperiment& experiment, const Sensor& sensor) {
  const std::array<double, 2>& pitch = sensor.patches.front().pitch;
  Presses presses;
  for (const double depth : experiment.depths) {
    for (int a = 0; a < experiment.places; ++a) {
      for (int b = 0; b < experiment.places; ++b) {
        const double half = (experiment.places - 1) / 2.0;
        presses.X_SO.push_back(pinOn(sensor, experiment.taxels.front(), (a - half) / experiment.places * pitch[0],
                                     (b - half) / experiment.places * pitch[1], depth));
        presses.loads.push_back(kPoseDriven);
      }
    }
  }
  for (const double load : experiment.loads) {
    for (const int taxel : experiment.taxels) {
      presses.X_SO.push_back(pinOn(sensor, taxel, 0, 0, 0));
      presses.loads.push_back(static_cast<float>(load));
    }
  }
  return presses;
}

CalibrationCurves curvesOf(const Device& device, const CalibrationExperiment& experiment, const Sensor& sensor) {
  const Presses presses = pressesOf(experiment, sensor);
  const Model model(device, {.sensor = sensor, .objects = {Object(Cylinder{experiment.pin_radius, kPinLength})}});
  Simulator simulator(model, {.num_instances = static_cast<int>(presses.X_SO.size()),
                              .outputs = {.tactile_normal_force = true, .tactile_shear_force = false, .penetration_depth = false}});
  simulator.setObjects(std::vector<int>(presses.X_SO.size(), 0), presses.X_SO);
  simulator.setLoads(presses.loads);
  simulator.step(kPressDt);
  const FrameView frame = simulator.read();

  CalibrationCurves curves{.name = sensor.name, .forces = {}, .counts = {}, .shares = {}};
  std::size_t press = 0;
  for (; press < experiment.depths.size() * experiment.numPlaces(); ++press) {
    curves.forces.push_back(0 - frame.ground_truth.contact_wrench[6 * press + 2]);  // not -0 where nothing is pressed
  }
  const auto num_taxels = static_cast<std::size_t>(numTaxels(sensor));
  for (const double load : experiment.loads) {
    for (const int taxel : experiment.taxels) {
      constexpr double kNone = std::numeric_limits<double>::quiet_NaN();
      const std::size_t at = press * num_taxels + static_cast<std::size_t>(taxel);
      const bool carried = frame.ground_truth.load_reached[press++];
      curves.counts.push_back(carried ? frame.tactile_image[at] : kNone);
      curves.shares.push_back(carried ? frame.ground_truth.tactile_normal_force[at] / load : kNone);
    }
  }
  return curves;
}

}  // namespace

std::vector<CalibrationCurves> runCalibrationExperiment(const Device& device, const CalibrationExperiment& experiment) {
  std::vector<CalibrationCurves> curves;
  for (const Sensor& sensor : experiment.sensors) curves.push_back(curvesOf(device, experiment, sensor));
  return curves;
}

}  // namespace taxelsim
