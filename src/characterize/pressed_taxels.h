// Force curves, sorted by taxel: which rows and taxels the readout can be fitted to.
#pragma once

#include <optional>
#include <vector>

#include "characterize/fits.h"
#include "characterize/readout_model.h"

namespace taxelsim {

// Output at which the sensor saturates, if the measurements show it.
struct Plateau {
  double counts = 0;  // 0: not seen
  double top = 0;     // counts: readings from here on belong to the plateau
};

struct PressedTaxels {
  std::vector<PressedTaxel> taxels;
  std::vector<FitResult> lines;  // (taxels): straight-line fits, as start values
  Plateau plateau;
  double top = 0;                 // counts: upper end of the range
  double noise = 0;               // counts: median deviation from the lines
  std::vector<int> dead;          // taxels without a response
  std::vector<int> too_few_rows;  // taxels with fewer than kLeastReadings rows between trigger and saturation
};

// `reference`: degrees Celsius, of measurements with a temperature. `psf_range` gives the uncertainty of the share of a force that stays on
// its taxel. Throws Error(kInput) if no taxel can be fitted.
PressedTaxels pressedTaxels(Measured force_curves, const Sensor& sensor, const std::optional<PsfRange>& psf_range, double reference);

}  // namespace taxelsim
