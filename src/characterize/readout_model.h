// The model of force on single taxels against output; paper, section III.B and figure 5. Of a taxel that is pressed by F, of which the
// point spread function leaves the share w to it,
//   x = w [(1 - s) F + s play(F)],  y = P(gain x - trigger),  counts = clip(y / (1 + y / L)),
// s and play being the readout's hysteresis, P a polynomial that begins with S counts/N, L the limit of a voltage divider. What is fitted
// to a taxel is its slope a = S gain w (counts/N) and the first force f that shows (N): with z = a (F - f) and K the end of the range,
// y = z (1 + b2 z/K + b3 (z/K)^2 + ...). Where its zero drifts, f moves by d (N) from the first row to the last. Or y goes straight from
// (0, 0) from knot to knot and at one of them, of z = Z, is Z: S is then the slope of the chord up to there, and shared are the rises of
// the pieces relative to that of the one that rises most. The b or rises, K/L, s and the play's width are common to all taxels.
#pragma once

#include <cstddef>
#include <optional>
#include <vector>

#include "characterize/least_squares.h"

namespace taxelsim {

// Of a taxel, between trigger and saturation: two parameters, and something to judge them by. Of a straight piece of the curve as many.
inline constexpr std::size_t kLeastReadings = 4;

struct Reading {
  double force;  // N
  double counts;
};

struct PressedTaxel {
  int taxel = 0;
  double share = 1;               // w
  double share_half_width = 0;    // of its 95 % interval, with a sign: all taxels' shares rise or fall together
  std::vector<Reading> rows;      // in the order in which they were taken
  std::vector<std::size_t> used;  // rows that tell anything
};

struct ReadoutModel {
  std::size_t num_bends = 0;  // b2, b3, ...
  bool divider = false;       // K/L follows the bends
  bool hysteresis = false;    // s and the play's width (N) come last
  bool drifts = false;        // each taxel has a drift d
  double top = 0;             // counts
  double noise = 1;           // counts

  std::vector<double> knots{};     // where straight pieces end, counts of z, > 0 and rising; none: a polynomial
  std::size_t pinned_knot = 0;     // that of Z
  std::size_t steepest_piece = 0;  // whose rise is 1; those of the others are the shared values, before K/L

  bool shows_below_zero = false;  // pieces only: first forces may be < 0, as of a load cell whose zero is off

  // Counts before noise and clipping.
  double output(double z, const double* shared) const {
    if (!knots.empty()) return outputOfPieces(z, shared);
    double factor = 1, power = 1;
    for (std::size_t k = 0; k < num_bends && z > 0; ++k) factor += shared[k] * (power *= z / top);
    const double y = z * factor;
    return divider && y > 0 ? y / (1 + y * shared[num_bends] / top) : y;
  }
  // Whether the output rises from 0 on to `last`, or to the end of the range, as a readout's must.
  bool rises(double last, const double* shared) const;
  std::size_t lag() const { return (knots.empty() ? num_bends : knots.size() - 1) + (divider ? 1 : 0); }  // where s stands

  // Relative to that of the piece that rises most.
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

// Slope and first force by a straight line through the rows inside the range, robustly: to begin with. None where there are too few.
std::optional<FitResult> straightLine(const std::vector<Reading>& rows, double top);

// Deep under the trigger and far over the end every slope reads the same.
std::vector<std::size_t> rowsThatTell(const std::vector<Reading>& rows, const FitResult& line, double top, double noise);

GroupedFit fitReadoutModel(const std::vector<PressedTaxel>& taxels, const std::vector<FitResult>& lines, const ReadoutModel& model,
                           double width);

// The fit with hysteresis and with drift, `model` saying which, where they are better than chance; both need a force that goes up and
// down. What is noise beside the ends of the range is found on the way.
GroupedFit withHysteresisAndDrift(const std::vector<PressedTaxel>& taxels, const std::vector<FitResult>& lines, ReadoutModel& model,
                                  GroupedFit fit);

// Whether the force comes back far enough to tell the ways apart.
bool hasWayBack(const std::vector<Reading>& rows);

// Whether the polynomial rises over the range, as a readout must.
bool rises(const ReadoutModel& model, const GroupedFit& fit, const std::vector<PressedTaxel>& taxels);

// Pooled over the rows that nothing clips.
ReadingNoise noiseOf(const std::vector<PressedTaxel>& taxels, const ReadoutModel& model, const GroupedFit& fit);

}  // namespace taxelsim
