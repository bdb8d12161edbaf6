// Creep of the readout under a constant load: output(t) = A [1 + sum fraction (1 - e^(-(t - t0) / time))] after the onset t0.
//
// The onset t0 is where the output crosses A / 2. To first order, a load that rises over several frames acts like a step in the middle of
// the rise. Rows of the rise are left out: those from the start of the rise to t0 + 2 (t0 - start). A recording ends where the load is
// removed.
#pragma once

#include <string>
#include <vector>

#include "taxelsim/characterize.h"
#include "taxelsim/sensor.h"

namespace taxelsim {

// One recording, which begins before the touch. Values have any unit and are proportional to the force after creep.
struct CreepSeries {
  std::string file;            // for errors
  std::vector<double> time;    // (rows), s, rising
  std::vector<double> values;  // (rows)
};

struct Onset {
  double time = 0;            // s: t0
  double start = 0;           // s: last row before the load
  double deviation = 0;       // s: standard deviation of t0
  std::size_t first_row = 0;  // after the rise
  std::size_t end_row = 0;    // one past the last row under load
};

// Finds where the output crosses half of `level`; 0 means the median output under load. Throws Error(kInput), one line that begins with the
// file, if the recording begins under load or the output does not rise once and stay.
Onset onsetOf(const CreepSeries& series, double level = 0);

struct CreepFit {
  std::vector<CreepTerm> terms;       // identified terms, ascending in time
  std::vector<double> fraction_half;  // (terms), half width of the 95 % interval
  std::vector<double> time_low;       // (terms), s: 95 % interval
  std::vector<double> time_high;      // (terms), s
  std::vector<Onset> onsets;          // (series)
  std::vector<double> amplitude;      // (series): A
  double correlation = 0;             // of successive residuals
  double residual = 0;                // rms without outliers, relative to the amplitude
  std::size_t num_rows = 0;
  std::size_t num_outliers = 0;
  std::string remark;  // why there is no further term
};

// Fits one to three terms that all series share. A further term is accepted if the F test rejects the smaller model at a level of 0.001,
// the confidence interval of its fraction excludes 0, and its time lies between the frame interval and the duration under load. Intervals
// are widened for autocorrelated residuals: n rows count as n (1 - r) / (1 + r), r being the lag-1 autocorrelation (G. V. Bayley and J. M.
// Hammersley, The "effective" number of independent observations in an autocorrelated time series, 1946). The intervals of fractions
// include the uncertainty of the onset: uniform between two rows, plus a tenth of the rise if the rise takes several rows.
CreepFit fitCreepTerms(const std::vector<CreepSeries>& series);

// 1 + sum fraction (1 - e^(-t / time)) at t (s) after the onset.
double creepFactor(const std::vector<CreepTerm>& terms, double t);

// Adds a fit to the sensor, estimates, fit qualities and figures of `result`. `name`: of the measurement; `remark`: for every estimate.
void reportCreep(const CreepFit& fit, const std::vector<CreepSeries>& series, const std::string& name, const std::string& remark,
                 Characterization& result);

}  // namespace taxelsim
