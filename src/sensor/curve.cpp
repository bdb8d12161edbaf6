#include "sensor/curve.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

namespace taxelsim {
namespace {

constexpr int kMaxIterations = 200;  // bisection over the range of double needs fewer

// Coefficients from the constant term up.
using Polynomial = std::vector<double>;

double evaluate(const Polynomial& p, double x) {
  double value = 0;
  for (std::size_t m = p.size(); m-- > 0;) value = value * x + p[m];
  return value;
}

Polynomial derivative(const Polynomial& p) {
  Polynomial result;
  for (std::size_t m = 1; m < p.size(); ++m) result.push_back(static_cast<double>(m) * p[m]);
  return result;
}

// The x in [low, high] where p crosses `value`, given p(low) and p(high) on its two sides and p monotone between: Newton's method,
// with bisection for steps that leave the bracket.
double solve(const Polynomial& p, double value, double low, double high) {
  const Polynomial slope = derivative(p);
  const bool rising = evaluate(p, high) > evaluate(p, low);
  double x = 0.5 * (low + high);
  for (int i = 0; i < kMaxIterations; ++i) {
    const double excess = evaluate(p, x) - value;
    if (excess == 0) return x;
    ((excess > 0) == rising ? high : low) = x;
    double next = x - excess / evaluate(slope, x);
    if (!(next > low && next < high)) next = 0.5 * (low + high);
    if (next == x || next == low || next == high) return next;
    x = next;
  }
  return x;
}

// Sign changes of p in (low, high), ascending. They lie between neighbouring extrema, which are the sign changes of its derivative.
std::vector<double> signChanges(const Polynomial& p, double low, double high) {
  if (p.size() < 2) return {};
  std::vector<double> ends = signChanges(derivative(p), low, high);
  ends.push_back(high);
  std::vector<double> changes;
  double begin = low;
  for (const double end : ends) {
    const double at_begin = evaluate(p, begin);
    const double at_end = evaluate(p, end);
    if ((at_begin < 0 && at_end > 0) || (at_begin > 0 && at_end < 0)) {
      changes.push_back(solve(p, 0, begin, end));
    } else if (at_end == 0 && end < high) {
      changes.push_back(end);
    }
    begin = end;
  }
  return changes;
}

Polynomial polynomialOf(std::span<const double> curve) {
  Polynomial p{0};
  p.insert(p.end(), curve.begin(), curve.end());
  while (p.size() > 1 && p.back() == 0) p.pop_back();
  return p;
}

// Cauchy's bound: no root of p lies beyond it. Limited to 1e30 N, whose fifth power fits a double.
double rootBound(const Polynomial& p) {
  double largest = 0;
  for (std::size_t m = 0; m + 1 < p.size(); ++m) largest = std::max(largest, std::abs(p[m] / p.back()));
  return std::min(1 + largest, 1e30);
}

}  // namespace

double curveTop(std::span<const double> curve, double value) {
  const Polynomial p = polynomialOf(curve), slope = derivative(p);
  if (slope.size() > 1) {
    const std::vector<double> levels = signChanges(slope, 0, rootBound(slope));
    for (std::size_t k = 0; k < levels.size(); ++k) {
      const double next = k + 1 < levels.size() ? levels[k + 1] : 2 * levels[k];
      if (evaluate(slope, (levels[k] + next) / 2) >= 0) continue;  // only level there
      if (evaluate(p, levels[k]) >= value) return levels[k];
      break;
    }
  }
  return std::numeric_limits<double>::infinity();
}

bool curveRises(std::span<const double> curve, double max, double value) {
  const Polynomial p = polynomialOf(curve);
  std::vector<double> ends = signChanges(derivative(p), 0, max);
  ends.push_back(max);
  double before = 0;
  for (const double end : ends) {
    const double here = evaluate(p, end);
    if (!(here > before)) return false;
    if (here >= value) return true;
    before = here;
  }
  return true;
}

double invertCurve(std::span<const double> curve, double value) {
  const Polynomial p = polynomialOf(curve);
  if (p.size() < 2) return 0;
  if (p.size() == 2) return value / p[1];
  const Polynomial slope = derivative(p);
  double begin = 0;
  double highest = 0;
  for (const double end : signChanges(slope, 0, rootBound(slope))) {
    if (evaluate(p, end) >= value) return solve(p, value, begin, end);
    if (evaluate(p, end) > evaluate(p, highest)) highest = end;
    begin = end;
  }
  if (p.back() < 0) return highest;
  double end = std::max(2 * begin, 1.0);
  while (evaluate(p, end) < value) end *= 2;
  return solve(p, value, begin, end);
}

double invertPoints(std::span<const CurvePoint> points, double value) {
  std::size_t end = 0;
  while (end + 1 < points.size() && points[end].counts < value) ++end;
  const CurvePoint from = end > 0 ? points[end - 1] : CurvePoint{};
  const CurvePoint& to = points[end];
  return from.force + (value - from.counts) * (to.force - from.force) / (to.counts - from.counts);
}

double slopeAtZero(const Readout& readout) {
  return readout.curve_points.empty() ? readout.curve.front() : readout.curve_points.front().counts / readout.curve_points.front().force;
}

bool isLinear(const Readout& readout) {
  return readout.curve.size() == 1 && readout.curve_points.size() < 2;
}

double withoutLimit(double value, double limit) {
  return limit > 0 ? value / (1 - value / limit) : value;
}

}  // namespace taxelsim
