// From measurements of a real sensor to the sensor that the simulator runs, with an interval for every number that was found; paper,
// section III. Part of the library taxelsim_characterize.
#pragma once

#include <cstddef>
#include <span>
#include <string>
#include <vector>

#include "taxelsim/measurement.h"
#include "taxelsim/sensor.h"

namespace taxelsim {

// One number of a sensor file, or of a measurement.
struct Estimate {
  std::string parameter;    // key of the sensor file, "skin.normal_contact_stiffness"; or MEASUREMENT.contact_offset
  std::string unit;         // SI; "" for none
  bool determined = false;  // false: the measurements do not tell; the sensor keeps what it had, and `remark` says why
  double value = 0;
  double low = 0;  // 95 % interval
  double high = 0;
  std::string remark;
};

// How well one measurement is met.
struct FitQuality {
  std::string measurement;
  std::string unit;  // of `rms`
  double rms = 0;    // of the residuals that are no outliers
  std::size_t num_rows = 0;
  std::size_t num_outliers = 0;
};

// What was measured beside what the fit says, to be drawn.
struct FitFigure {
  struct Curve {
    std::string name;
    bool measured = false;  // dots, else a line
    std::vector<double> x;
    std::vector<double> y;
  };

  std::string title;
  std::string x_label;
  std::string y_label;
  std::vector<Curve> curves;
};

struct Characterization {
  Sensor sensor;
  std::vector<Estimate> estimates;
  std::vector<FitQuality> fits;
  std::vector<FitFigure> figures;
  std::vector<int> dead_taxels;      // that did not answer to a force; indices in storage order
  std::vector<std::string> remarks;  // one line each
};

// Fits all that the measurements tell: readout from force curves, stiffness from force against depth, the point spread function from images
// under points and stamps, creep from step responses and from stamps. All must name the same sensor, which gives what they do not tell.
// Throws Error(kInput), one line that begins with a measurement's file, when one cannot be used. Same measurements, same result.
Characterization characterize(std::span<const Measurement> measurements);

}  // namespace taxelsim
