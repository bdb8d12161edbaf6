// Creep of what the readout makes of a load that is put on once, A [1 + sum fraction (1 - e^(-(t - t0) / time))], from recordings that
// begin before the touch.
//
// The onset t0 is where the output crosses half of A. A load that is put on over some frames acts, to first order, as one put on at once in
// the middle; its rows, from the last one under a twentieth of what follows to as long again after t0 as it took before, twice, are left
// out. A recording ends where the load is taken off.
#pragma once

#include <string>
#include <vector>

#include "taxelsim/characterize.h"
#include "taxelsim/sensor.h"

namespace taxelsim {

// One recording. Values are of any unit, proportional to the force that the readout's creep ends in.
struct CreepSeries {
  std::string file;            // for errors
  std::vector<double> time;    // (rows), s, rising
  std::vector<double> values;  // (rows)
};

struct Onset {
  double time = 0;            // s: t0
  double start = 0;           // s: of the last row before the load
  double deviation = 0;       // s: standard deviation of t0
  std::size_t first_row = 0;  // past the rise
  std::size_t end_row = 0;    // one past the last under load
};

// Where the output crosses half of `level`, by default of what it is under load on average. Throws Error(kInput), one line that begins with
// the file: the output does not rise once and stay, or the recording begins under load.
Onset onsetOf(const CreepSeries& series, double level = 0);

struct CreepFit {
  std::vector<CreepTerm> terms;       // those that are told, ascending in time
  std::vector<double> fraction_half;  // (terms), half of the 95 % interval
  std::vector<double> time_low;       // (terms), s: of the 95 % interval
  std::vector<double> time_high;      // (terms), s
  std::vector<Onset> onsets;          // (series)
  std::vector<double> amplitude;      // (series): A
  double correlation = 0;             // of residuals from row to row
  double residual = 0;                // rms of what is no outlier, over the amplitude
  std::size_t num_rows = 0;
  std::size_t num_outliers = 0;
  std::string remark;  // why there are no more terms
};

// One to three terms, shared by all series: a further one where the F test calls it better in one case of a thousand, its fraction's
// interval leaves 0 out, and its time lies between a frame and the length under load. Residuals that follow one another widen the
// intervals: rows count (1 - r) / (1 + r) fold, r being the correlation from one row to the next (G. V. Bayley and J. M. Hammersley, The
// "effective" number of independent observations in an autocorrelated time series, 1946). Into the fractions' intervals goes also the
// onset, uniform between two rows, with a tenth of the rise as a further standard deviation where that takes longer.
CreepFit fitCreepTerms(const std::vector<CreepSeries>& series);

// 1 + sum fraction (1 - e^(-t / time)) at t (s) after the onset.
double creepFactor(const std::vector<CreepTerm>& terms, double t);

// Puts a fit into sensor, estimates, quality and figures. `name` is of the measurement, `remark` goes to every estimate.
void addCreep(const CreepFit& fit, const std::vector<CreepSeries>& series, const std::string& name, const std::string& remark,
              Characterization& result);

}  // namespace taxelsim
