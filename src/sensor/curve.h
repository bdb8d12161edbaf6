// The force-to-output curve as a polynomial without a constant term: where it rises, and its inverse.
#pragma once

#include <span>

namespace taxelsim {

// sum over m of curve[m] x^(m+1).
double evaluateCurve(std::span<const double> curve, double x);

// True when the curve rises strictly from 0 up to `max`, or to where it first reaches `value`, whichever comes first. max > 0, finite.
bool curveRises(std::span<const double> curve, double max, double value);

// Smallest x > 0 where the curve is `value` > 0; where it never gets there, the x where it is highest.
double invertCurve(std::span<const double> curve, double value);

// y of y / (1 + y / limit) = value; of limit 0 the value itself. 0 <= value < limit.
double withoutLimit(double value, double limit);

}  // namespace taxelsim
