// A bench whose sensor is simulated on the device: it is pressed as docs/reference/measurements.md describes, and its readings become the
// files that `taxelsim characterize` reads. Not independent of the simulator, unlike bench_session.h: it shows what a fit makes of
// simulated contacts.
#pragma once

#include "support/test.h"
#include "taxelsim/measurement.h"
#include "taxelsim/model.h"
#include "taxelsim/sensor.h"

namespace taxelsim::testing {

// Samples are points: their number under a flat face is off by at most about its perimeter in samples. The pin is 14 samples wide.
inline constexpr int kBenchSamples = 16;      // per side of a taxel
inline constexpr double kPinRadius = 1.5e-3;  // m; in the middle of a taxel of 3.4 mm it presses on no other

// The bench's objects: the first three press for the fit, the others where the fit is tried.
enum class BenchObject { kPin, kStamp, kEdge, kSquare, kBall, kRidge };

// An object over the skin.
struct BenchPlace {
  BenchObject object{};
  std::array<double, 2> at{};  // m, of its lowest point
  double yaw = 0;              // rad
};

// A reading of the sensor under an object.
struct BenchReading {
  double force = 0;           // N, of the object on the skin
  double depth = 0;           // m, of its lowest point below the skin
  std::vector<float> counts;  // (num_taxels)
};

// 6 x 6 taxels of 3.4 mm with a readout of its own for each, under 2 mm of skin.
Sensor benchTruth(const ContactLaw& law);
// What is known of it before it is measured: its layout.
Sensor benchPrior();

class SimulatedBench {
 public:
  explicit SimulatedBench(const Sensor& sensor);

  const Sensor& sensor() const { return model_.sensor(); }

  // Presses all places with one load (N) after the other, each until the reading rests; (num_loads x num_places). A proximity sensor feels
  // no force: it is pressed as deep as springs of its sensitivity.
  std::vector<BenchReading> press(const std::vector<BenchPlace>& places, const std::vector<double>& loads) const;

  // Forces (N) on all places at one depth (m) after the other, (num_depths x num_places); of a proximity sensor what its taxels read.
  std::vector<double> forcesAt(const std::vector<BenchPlace>& places, const std::vector<double>& depths) const;

  // Presses pin, stamp and edge at several places, loads up and down, writes sensor file and measurements to a directory and loads them.
  std::vector<Measurement> measure(const Sensor& prior, const std::filesystem::path& directory) const;

 private:
  struct Step;
  std::vector<BenchReading> simulate(const std::vector<BenchPlace>& places, const std::vector<Step>& steps) const;

  Model model_;
};

// Image of a load that is spread evenly over the outline of its object, through the readout of `sensor` without its point spread function.
std::vector<float> uniformStamp(const Sensor& sensor, const BenchPlace& place, double load);

}  // namespace taxelsim::testing
