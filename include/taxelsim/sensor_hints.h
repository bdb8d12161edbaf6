/// @file
/// Hints about settings of a sensor that are allowed but rarely meant. Sensor files are looked through when they are read. What is not
/// allowed is refused by checkSensor().
#pragma once

#include "taxelsim/sensor.h"

namespace taxelsim {

/// Trigger (N) above which an unloaded taxel is silent at three standard deviations of Readout::noise, on the nominal curve; 0 without
/// noise. Sensor files that give noise and no trigger have it.
double noiseTrigger(const Readout& readout);

/// Logs a warning if the pitch was probably given in millimetres.
void warnOfUnits(const GridPatch& patch);
/// The same for the thickness.
void warnOfUnits(const Skin& skin);

}  // namespace taxelsim
