#include "reference/mean_depth.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <numbers>

#include "sensor/gauss_rule.h"

namespace taxelsim::reference {
namespace {

constexpr int kIntervals = 32;           // per side of the raster
constexpr int kBisections = 30;          // of an interval
constexpr int kMaxHalvings = 12;         // of the adaptive rule: a jump within a piece is located to 2^-12 of it
constexpr double kRuleTolerance = 1e-7;  // relative difference of a rule and its halves

// Of lowestHeight(). Directions turn by the golden angle, since a rim that leaves the skin is lowest in a narrow valley.
constexpr int kDirections = 8;
constexpr double kGoldenAngle = 2.399963229728653, kShrink = 0.7, kSearchEnd = 1e-14;

// Calls visit(kind, begin, end) for the pieces of [low, high] on which kindAt() is constant.
template <typename KindAt, typename Visit>
void forEachPiece(double low, double high, KindAt kindAt, Visit visit) {
  auto kind = kindAt(low);
  double begin = low, last = low;
  for (int n = 1; n <= kIntervals; ++n) {
    const double next = n == kIntervals ? high : low + (high - low) * n / kIntervals;
    for (const auto next_kind = kindAt(next); kind != next_kind;) {
      double inside = last, outside = next;
      auto outside_kind = next_kind;
      for (int k = 0; k < kBisections; ++k) {
        const double middle = (inside + outside) / 2;
        const auto middle_kind = kindAt(middle);
        if (middle_kind == kind) {
          inside = middle;
        } else {
          outside = middle;
          outside_kind = middle_kind;
        }
      }
      visit(kind, begin, inside);
      begin = last = outside;
      kind = outside_kind;
    }
    last = next;
  }
  visit(kind, begin, high);
}

// Adaptive integral over [low, high], smooth or with square roots at the ends.
class Quadrature {
 public:
  Quadrature(double low, double high, const std::function<double(double)>& value) : low_(low), high_(high), value_(value) {}

  double integral() const {
    const double whole = panel(0, 1);
    return refined(0, 1, whole, kRuleTolerance * std::abs(whole), kMaxHalvings);
  }

 private:
  double panel(double from, double to) const {
    static const QuadratureRule rule = gaussRule(1, 1);
    double sum = 0;
    for (std::size_t n = 0; n < rule.points.size(); ++n) {
      const double angle = std::numbers::pi / 2 * (from + (to - from) * rule.points[n]), sine = std::sin(angle);
      sum += rule.weights[n] * std::numbers::pi * sine * std::cos(angle) * value_(low_ + (high_ - low_) * sine * sine);
    }
    return (high_ - low_) * (to - from) * sum;
  }
  double refined(double from, double to, double whole, double tolerance, int halvings) const {
    const double middle = (from + to) / 2, left = panel(from, middle), right = panel(middle, to);
    if (halvings == 0 || std::abs(left + right - whole) <= tolerance) return left + right;
    return refined(from, middle, left, tolerance, halvings - 1) + refined(middle, to, right, tolerance, halvings - 1);
  }

  double low_, high_;
  const std::function<double(double)>& value_;
};

// The pieces of f, and a sequence of them as digits of a number.
using Piece = std::uint64_t;
constexpr Piece kNone = 1, kShallow = 2, kFull = 3, kDigit = 4;

// A function of x, y (m) and f (m).
struct Integrand {
  std::function<double(double, double, double)> value;
  bool of_depth_only = true, is_constant = false;
};

class Integrator {
 public:
  Integrator(const HeightAt& heightAt, const Rectangle& domain, const DepthRange& range)
      : heightAt_(heightAt), domain_(domain), range_(range) {}

  // Where f > 0.
  double integral(const Integrand& integrand) {
    const double height = domain_.max[1] - domain_.min[1];
    const std::function<double(double)> lineAt = [this, &integrand](double x) { return lineIntegral(x, integrand); };
    double sum = 0;
    forEachPiece(
        domain_.min[0], domain_.max[0], [this](double x) { return sequenceAt(x); },
        [&](Piece sequence, double begin, double end) {
          if (sequence == kFull && integrand.of_depth_only) {
            sum += (end - begin) * height * integrand.value(0, 0, range_.thickness);
          } else if (sequence != kNone) {
            sum += Quadrature(begin, end, lineAt).integral();
          }
        });
    return sum;
  }

 private:
  double depthAt(double x, double y) { return range_.depthAt(heightAt_(x, y)); }
  Piece pieceAt(double x, double y) {
    const double depth = depthAt(x, y);
    return depth <= 0 ? kNone : depth < range_.thickness ? kShallow : kFull;
  }
  Piece sequenceAt(double x) {
    Piece sequence = 0;
    for (int n = 0; n <= kIntervals; ++n) {
      const Piece piece = pieceAt(x, domain_.min[1] + (domain_.max[1] - domain_.min[1]) * n / kIntervals);
      if (sequence % kDigit != piece) sequence = kDigit * sequence + piece;
    }
    return sequence;
  }
  double lineIntegral(double x, const Integrand& integrand) {
    const std::function<double(double)> onLine = [this, x, &integrand](double y) { return integrand.value(x, y, depthAt(x, y)); };
    double sum = 0;
    forEachPiece(
        domain_.min[1], domain_.max[1], [this, x](double y) { return pieceAt(x, y); },
        [&](Piece piece, double begin, double end) {
          if (piece == kNone) return;
          const bool is_constant = integrand.of_depth_only && (piece == kFull || integrand.is_constant);
          sum += is_constant ? (end - begin) * integrand.value(0, 0, range_.thickness) : Quadrature(begin, end, onLine).integral();
        });
    return sum;
  }

  const HeightAt& heightAt_;
  const Rectangle& domain_;
  const DepthRange& range_;
};

}  // namespace

CellDepth meanDepth(const HeightAt& heightAt, const Rectangle& domain, const Rectangle& cell, const DepthRange& range, bool varies) {
  if (domain.isEmpty()) return {};
  Integrator integrator(heightAt, domain, range);
  const double area = cell.area(), x = (cell.min[0] + cell.max[0]) / 2, y = (cell.min[1] + cell.max[1]) / 2;
  CellDepth depth;
  depth.mean = integrator.integral({[](double, double, double f) { return f; }}) / area;
  depth.share = integrator.integral({[](double, double, double) { return 1; }, true, true}) / area;
  if (!varies) return depth;
  depth.square = integrator.integral({[](double, double, double f) { return f * f; }}) / area;
  depth.moment = {integrator.integral({[x](double at, double, double f) { return f * (at - x); }, false}) / area,
                  integrator.integral({[y](double, double at, double f) { return f * (at - y); }, false}) / area};
  return depth;
}

double lowestHeight(const HeightAt& heightAt, const Rectangle& rectangle, const std::array<double, 2>& guess) {
  double lowest = std::numeric_limits<double>::infinity();
  if (rectangle.isEmpty()) return lowest;
  std::array<double, 2> best{};
  const auto isLower = [&](double x, double y) {
    const std::array<double, 2> p{std::clamp(x, rectangle.min[0], rectangle.max[0]), std::clamp(y, rectangle.min[1], rectangle.max[1])};
    const double height = heightAt(p[0], p[1]);
    if (height >= lowest) return false;
    lowest = height;
    best = p;
    return true;
  };
  const std::array<double, 2> step{(rectangle.max[0] - rectangle.min[0]) / (2 * kIntervals),
                                   (rectangle.max[1] - rectangle.min[1]) / (2 * kIntervals)};
  for (int i = 0; i <= 2 * kIntervals; ++i) {
    for (int j = 0; j <= 2 * kIntervals; ++j) isLower(rectangle.min[0] + i * step[0], rectangle.min[1] + j * step[1]);
  }
  isLower(guess[0], guess[1]);
  const double first_radius = std::max(step[0], step[1]);
  double angle = 0;
  for (double radius = first_radius; radius > kSearchEnd * first_radius;) {
    bool improved = false;
    angle += kGoldenAngle;
    for (int n = 0; n < kDirections; ++n) {
      const double direction = angle + 2 * std::numbers::pi * n / kDirections;
      const std::array<double, 2> centre = best;
      if (isLower(centre[0] + radius * std::cos(direction), centre[1] + radius * std::sin(direction))) improved = true;
    }
    if (!improved) radius *= kShrink;
  }
  return lowest;
}

}  // namespace taxelsim::reference
