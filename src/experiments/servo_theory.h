// What theory says of a loop that holds an edge angle by a gain K alone: the error e of the angle goes on by -K T f(e) per control period
// T, where f is what the sensor reads of it; f(e) = e of the exact angle. Late by one period it is the error of the frame before that
// counts.
#pragma once

#include <functional>
#include <vector>

#include "taxelsim/experiment.h"

namespace taxelsim {

struct AngleLoop {
  double gain = 0;         // K, 1/s
  double dt = 0.01;        // s, from frame to frame
  int period = 1;          // frames from one look of the controller to the next; it holds its command in between
  int delay = 0;           // frames from a command to the joint
  double start_error = 0;  // rad
};

// The error (num_frames) by which theory continues the first one.
std::vector<double> expectedErrors(const AngleLoop& loop, int num_frames, const std::function<double(double)>& read);

// Of the exact angle, s, to within `band` of the first error for good: T ln band / ln z with z = 1 - K T, or one period late
// z = (1 + sqrt(1 - 4 K T)) / 2, the slower of its two modes. NaN where the loop swings or diverges, and for other delays.
double closedFormSettlingTime(const AngleLoop& loop, double band);

// The factor by which the error grows in a control period, for K T = gain and no delay or one period: |1 - gain|, or the larger root of
// z^2 = z - gain.
double closedFormGrowth(double gain, bool late);

// The same from a trace of errors, one per control period: the ratio of the root mean squares of its last and its first third.
double measuredGrowth(const std::vector<double>& errors);

// Seconds until errors `dt` apart stay within `band` of the first one, between them as exponentials run; NaN where they do not.
double settlingTime(const std::vector<double>& errors, double dt, double band);

}  // namespace taxelsim
