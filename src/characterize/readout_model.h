// Model of the output of single taxels as a function of force; paper, section III.B and figure 5. For a force F on a taxel,
//   x = w [(1 - s) F + s play(F)],  y = P(gain x - trigger),  counts = clip(y / (1 + y / L)).
// w: share of the force that the point spread function leaves on the taxel. s, play: hysteresis. P: polynomial with slope S counts/N at 0.
// L: limit of a voltage divider.
//
// Parameters of each taxel: slope a = S gain w (counts/N), first force with an output f (N), and the drift of f over the measurement d (N).
// With z = a (F - f) and the end of the range K, a polynomial is y = z (1 + b2 z/K + b3 (z/K)^2 + ...).
// A piecewise linear curve starts at (0, 0) and passes (Z, Z) at one knot, the pinned one: S is the slope of the chord up to it. Its
// parameters are the rises of the pieces relative to the largest rise.
// At a temperature of W above the reference, z = a (e^(g W) F - f) - b W, with g in 1/K and b in counts/K.
// Shared by all taxels: b2, b3, ... or the rises; K/L; s; the width of the play; g and b.
#pragma once

#include <cstddef>
#include <optional>
#include <vector>

#include "characterize/least_squares.h"

namespace taxelsim {

// Rows that a taxel needs between trigger and saturation, and that a piece of the curve needs.
inline constexpr std::size_t kLeastReadings = 4;

struct Reading {
  double force;  // N
  double counts;
  double warmth = 0;  // K above the reference temperature
};

struct PressedTaxel {
  int taxel = 0;
  double share = 1;               // w
  double share_half_width = 0;    // of its 95 % interval, with a sign: the shares of all taxels are correlated
  std::vector<Reading> rows;      // in order of time
  std::vector<std::size_t> used;  // informative rows
};

struct ReadoutModel {
  std::size_t num_bends = 0;  // b2, b3, ...
  bool divider = false;       // K/L follows the bends
  bool hysteresis = false;    // s and the play's width (N) come last
  bool drifts = false;        // each taxel has a drift d
  bool warms = false;         // two parameters of the temperature follow the hysteresis
  double top = 0;             // counts
  double noise = 1;           // counts

  std::vector<double> knots{};     // ends of straight pieces, in z (counts), > 0 and rising; empty: a polynomial
  std::size_t pinned_knot = 0;     // the knot of Z
  std::size_t steepest_piece = 0;  // has a relative rise of 1; the rises of the others are shared values, before K/L

  bool shows_below_zero = false;  // pieces only: first forces may be < 0, for a load cell with a zero offset

  // Counts before noise and clipping.
  double output(double z, const double* shared) const {
    if (!knots.empty()) return outputOfPieces(z, shared);
    double factor = 1, power = 1;
    for (std::size_t k = 0; k < num_bends && z > 0; ++k) factor += shared[k] * (power *= z / top);
    const double y = z * factor;
    return divider && y > 0 ? y / (1 + y * shared[num_bends] / top) : y;
  }
  // True if the output rises strictly from z = 0 to `last` or to the end of the range.
  bool rises(double last, const double* shared) const;
  std::size_t lag() const { return (knots.empty() ? num_bends : knots.size() - 1) + (divider ? 1 : 0); }  // index of s
  std::size_t warm() const { return lag() + (hysteresis ? 2 : 0); }  // index of the gain per kelvin; the trigger's follows

  // Relative to the largest rise.
  double rise(std::size_t piece, const double* shared) const {
    return piece == steepest_piece ? 1 : shared[piece < steepest_piece ? piece : piece - 1];
  }

 private:
  double outputOfPieces(double z, const double* shared) const;
};

struct ReadingNoise {
  double deviation = 0;  // counts
  std::size_t degrees_of_freedom = 0;
};

double largestForce(const std::vector<Reading>& rows);

// Robust straight-line fit to the unclipped rows: slope and first force, as start values. None if there are fewer than kLeastReadings.
std::optional<FitResult> straightLine(const std::vector<Reading>& rows, double top);

// Rows that are not deep below the trigger or far above the end of the range, where the output does not depend on the parameters.
std::vector<std::size_t> informativeRows(const std::vector<Reading>& rows, const FitResult& line, double top, double noise);

GroupedFit fitReadoutModel(const std::vector<PressedTaxel>& taxels, const std::vector<FitResult>& lines, const ReadoutModel& model,
                           double width);

// Adds hysteresis and drift to the model if they improve the fit significantly; both need loading and unloading. Also updates the noise and
// refits.
GroupedFit withHysteresisAndDrift(const std::vector<PressedTaxel>& taxels, const std::vector<FitResult>& lines, ReadoutModel& model,
                                  GroupedFit fit);

// True if the force falls by more than 20 % of the largest force.
bool hasUnloading(const std::vector<Reading>& rows);

// True if the fitted curve rises over the range.
bool rises(const ReadoutModel& model, const GroupedFit& fit, const std::vector<PressedTaxel>& taxels);

// Pooled over unclipped rows.
ReadingNoise noiseOf(const std::vector<PressedTaxel>& taxels, const ReadoutModel& model, const GroupedFit& fit);

}  // namespace taxelsim
