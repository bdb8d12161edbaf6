// The force-to-output curve, a polynomial without a constant term or straight pieces: monotonicity, slope at 0, inverse.
#pragma once

#include <span>

#include "taxelsim/sensor.h"

namespace taxelsim {

// The x > 0 of the first maximum of a polynomial that has reached `value` there, and reads as its maximum beyond; infinite otherwise.
double curveTop(std::span<const double> curve, double value);

// True when the curve rises strictly from 0 up to `max`, or to where it first reaches `value`, whichever comes first. max > 0, finite.
bool curveRises(std::span<const double> curve, double max, double value);

// Smallest x > 0 where the curve is `value` > 0. If the curve stays below `value`: the x of its maximum.
double invertCurve(std::span<const double> curve, double value);

// x where straight pieces through (0, 0) and the points reach `value` > 0. At least one point.
double invertPoints(std::span<const CurvePoint> points, double value);

// Slope at 0, counts/N, before output_scale.
double slopeAtZero(const Readout& readout);

// Whether counts are proportional to the force above the trigger, apart from a limit.
bool isLinear(const Readout& readout);

// Solves y / (1 + y / limit) = value for y; `value` itself if limit is 0. 0 <= value < limit.
double withoutLimit(double value, double limit);

}  // namespace taxelsim
