// Theory of a proportional control loop of the edge angle with gain K. The error e changes by -K T f(e) per control period T, where f is
// the characteristic of the sensor; f(e) = e for the exact angle. With a delay of one period, the error of the previous period counts.
#pragma once

#include <functional>
#include <vector>

#include "taxelsim/experiment.h"

namespace taxelsim {

struct AngleLoop {
  double gain = 0;         // K, 1/s
  double dt = 0.01;        // s, from frame to frame
  int period = 1;          // frames per control period; the command is held in between
  int delay = 0;           // frames from a command to the joint
  double start_error = 0;  // rad
};

// Predicted errors (num_frames), from the start error on; read(error) is f.
std::vector<double> expectedErrors(const AngleLoop& loop, int num_frames, const std::function<double(double)>& read);

// Settling time (s) for the exact angle, to within `band` of the start error: T ln band / ln z with z = 1 - K T, or with a delay of one
// period z = (1 + sqrt(1 - 4 K T)) / 2, the slower mode. NaN if the loop oscillates or diverges, and for other delays.
double closedFormSettlingTime(const AngleLoop& loop, double band);

// Growth factor of the error per control period for K T = gain: |1 - gain|, or with a delay of one period (`late`) the magnitude of the
// larger root of z^2 = z - gain.
double closedFormGrowth(double gain, bool late);

// Growth factor per period from a trace of errors, one per control period: from the rms of its first and its last third.
double measuredGrowth(const std::vector<double>& errors);

// Seconds until errors `dt` apart stay within `band` of the first one, with exponential interpolation; NaN if they never do.
double settlingTime(const std::vector<double>& errors, double dt, double band);

}  // namespace taxelsim
