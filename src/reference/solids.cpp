#include "reference/solids.h"

#include <algorithm>
#include <array>
#include <limits>
#include <utility>
#include <vector>

#include "base/constants.h"
#include "base/vector3.h"

namespace taxelsim::reference {
namespace {

// Parameter interval of a line inside a convex solid: [first, second]; empty if first > second.
using Interval = std::pair<double, double>;
constexpr Interval kEmpty{kInfinity, -kInfinity};
constexpr Interval kWholeLine{-kInfinity, kInfinity};

Interval intersect(const Interval& a, const Interval& b) {
  return {std::max(a.first, b.first), std::min(a.second, b.second)};
}
double startOf(const Interval& interval) {
  return interval.first <= interval.second ? interval.first : kInfinity;
}

// Up to two roots in ascending order, on the stack: rays are cast by the million.
struct Roots {
  std::array<double, 2> at{};
  std::size_t count = 0;

  void add(double root) { at[count++] = root; }
  const double* begin() const { return at.data(); }
  const double* end() const { return at.data() + count; }
};

// Real roots of a t^2 + 2 b t + c, without cancellation (W. Kahan's form).
Roots quadraticRoots(double a, double b, double c) {
  Roots roots;
  const double discriminant = b * b - a * c;
  if (discriminant < 0) return roots;
  const double q = -(b + std::copysign(std::sqrt(discriminant), b));
  if (a != 0) roots.add(q / a);
  if (q != 0) roots.add(c / q);
  if (roots.count == 2 && roots.at[1] < roots.at[0]) std::swap(roots.at[0], roots.at[1]);
  return roots;
}

// Where |position + t velocity| <= radius, in the dimensions that the dot products were taken over: 2 for a tube, 3 for a ball.
Interval insideRound(double velocity_squared, double position_velocity, double position_squared, double radius) {
  const double c = position_squared - radius * radius;
  if (velocity_squared == 0) {
    return c <= 0 ? kWholeLine : kEmpty;
  }
  const Roots roots = quadraticRoots(velocity_squared, position_velocity, c);
  return roots.count == 0 ? kEmpty : Interval{*roots.begin(), *(roots.end() - 1)};
}

Interval insideSlab(double position, double velocity, double min, double max) {
  if (velocity == 0) {
    return position >= min && position <= max ? kWholeLine : kEmpty;
  }
  const double t0 = (min - position) / velocity, t1 = (max - position) / velocity;
  return {std::min(t0, t1), std::max(t0, t1)};
}

Interval insideTube(double radius, const Vector3& origin, const Vector3& direction) {
  return insideRound(direction[0] * direction[0] + direction[1] * direction[1], origin[0] * direction[0] + origin[1] * direction[1],
                     origin[0] * origin[0] + origin[1] * origin[1], radius);
}

Interval insideBall(double radius, const Vector3& origin, const Vector3& direction) {
  return insideRound(dot(direction, direction), dot(origin, direction), dot(origin, origin), radius);
}

double evaluate(const std::vector<double>& coefficients, double t) {
  double value = 0;
  for (auto c = coefficients.rbegin(); c != coefficients.rend(); ++c) {
    value = value * t + *c;
  }
  return value;
}

// The root in [low, high], at whose ends the polynomial has different signs, by Newton's method within the bracket. Coordinates are of
// size 1.
double rootBetween(double low, double high, const std::vector<double>& coefficients, const std::vector<double>& derivative) {
  constexpr int kMaxSteps = 100;  // bisections and linear convergence at a triple root
  const bool rising = evaluate(coefficients, low) < 0;
  double t = (low + high) / 2;
  for (int step = 0; step < kMaxSteps; ++step) {
    const double value = evaluate(coefficients, t);
    ((value < 0) == rising ? low : high) = t;
    const double newton = t - value / evaluate(derivative, t);
    const double next = newton > low && newton < high ? newton : (low + high) / 2;
    if (std::abs(next - t) <= 0x1p-53) return next;
    t = next;
  }
  return t;
}

// Real roots in [low, high] of the polynomial sum coefficients[m] t^m, in ascending order, by recursion on the derivative: between two
// neighbouring roots of the derivative the polynomial is monotone. Double roots may be missed.
std::vector<double> rootsIn(const std::vector<double>& coefficients, double low, double high) {
  std::vector<double> derivative;
  for (std::size_t m = 1; m < coefficients.size(); ++m) derivative.push_back(static_cast<double>(m) * coefficients[m]);
  std::vector<double> bounds{low};
  if (derivative.size() > 1) {
    for (const double t : rootsIn(derivative, low, high)) bounds.push_back(t);
  }
  bounds.push_back(high);
  std::vector<double> roots;
  for (std::size_t i = 0; i + 1 < bounds.size(); ++i) {
    const double at_low = evaluate(coefficients, bounds[i]), at_high = evaluate(coefficients, bounds[i + 1]);
    if (at_low == 0) {
      roots.push_back(bounds[i]);
    } else if ((at_low < 0) != (at_high < 0)) {
      roots.push_back(rootBetween(bounds[i], bounds[i + 1], coefficients, derivative));
    }
  }
  return roots;
}

}  // namespace

double firstHit(const Sphere& sphere, const Vector3& origin, const Vector3& direction) {
  return startOf(insideBall(sphere.radius, origin, direction));
}

double firstHit(const Cylinder& cylinder, const Vector3& origin, const Vector3& direction) {
  return startOf(intersect(insideTube(cylinder.radius, origin, direction),
                           insideSlab(origin[2], direction[2], -cylinder.length / 2, cylinder.length / 2)));
}

double firstHit(const Capsule& capsule, const Vector3& origin, const Vector3& direction) {
  const double half = capsule.length / 2;
  const double ends = std::min(startOf(insideBall(capsule.radius, {origin[0], origin[1], origin[2] - half}, direction)),
                               startOf(insideBall(capsule.radius, {origin[0], origin[1], origin[2] + half}, direction)));
  return std::min(ends, firstHit(Cylinder{capsule.radius, capsule.length}, origin, direction));
}

double firstHit(const Box& box, const Vector3& origin, const Vector3& direction) {
  Interval inside = kWholeLine;
  for (int axis = 0; axis < 3; ++axis) {
    inside = intersect(inside, insideSlab(origin[axis], direction[axis], -box.size[axis] / 2, box.size[axis] / 2));
  }
  return startOf(inside);
}

double firstHit(const HalfSpace&, const Vector3& origin, const Vector3& direction) {
  return startOf(insideSlab(origin[2], direction[2], 0, kInfinity));
}

double surfaceOver(const HalfSpace& half_space, const Vector3& origin, const Vector3& direction) {
  constexpr double kLeastDescent = 1e-6;  // cosine of the surface's normal to the ray, above the rounding of a float32 pose
  if (direction[2] > kLeastDescent * length(direction)) return firstHit(half_space, origin, direction);
  return origin[2] >= 0 ? -kInfinity : kInfinity;
}

double firstHit(const Cone& cone, const Vector3& origin, const Vector3& direction) {
  // Flank x^2 + y^2 = (slope z)^2 with 0 <= z <= height, and base. Both include the rim, within rounding.
  const double slope = cone.radius / cone.height;
  const double rounding = 1e-13 * cone.height;
  const double a = direction[0] * direction[0] + direction[1] * direction[1] - slope * slope * direction[2] * direction[2];
  const double b = origin[0] * direction[0] + origin[1] * direction[1] - slope * slope * origin[2] * direction[2];
  const double c = origin[0] * origin[0] + origin[1] * origin[1] - slope * slope * origin[2] * origin[2];
  double first = kInfinity;
  for (const double t : quadraticRoots(a, b, c)) {
    const double z = origin[2] + t * direction[2];
    if (z >= -rounding && z <= cone.height + rounding) {
      first = std::min(first, t);
    }
  }
  if (direction[2] != 0) {
    const double t = (cone.height - origin[2]) / direction[2];
    const double x = origin[0] + t * direction[0], y = origin[1] + t * direction[1];
    if (x * x + y * y <= cone.radius * cone.radius) {
      first = std::min(first, t);
    }
  }
  return first;
}

double firstHit(const Torus& torus, const Vector3& origin, const Vector3& direction) {
  // (|p|^2 + R^2 - r^2)^2 = 4 R^2 (x^2 + y^2). For conditioning, lengths are scaled by R + r and t is measured from the point of the line
  // that is closest to the centre.
  const double reach = torus.major_radius + torus.minor_radius;
  const double speed = length(direction);
  const double nearest = -dot(origin, direction) / (speed * speed);
  const Vector3 p = scale(1 / reach, add(origin, scale(nearest, direction)));
  const Vector3 v = scale(1 / speed, direction);
  const double R = torus.major_radius / reach, r = torus.minor_radius / reach;
  const double distance_squared = dot(p, p);
  if (distance_squared > 1) {
    return kInfinity;
  }
  const double k = distance_squared + R * R - r * r;
  const double flat_vv = v[0] * v[0] + v[1] * v[1], flat_pv = p[0] * v[0] + p[1] * v[1], flat_pp = p[0] * p[0] + p[1] * p[1];
  // |p + t v|^2 = t^2 + |p|^2, because p and v are perpendicular.
  const std::vector<double> quartic{k * k - 4 * R * R * flat_pp, -8 * R * R * flat_pv, 2 * k - 4 * R * R * flat_vv, 0, 1};
  const double half_chord = std::sqrt(1 - distance_squared);
  const double outside = half_chord + 1e-3;  // the ends of the chord may be roots; start where the quartic is positive
  const std::vector<double> roots = rootsIn(quartic, -outside, outside);
  return roots.empty() ? kInfinity : nearest + roots.front() * reach / speed;
}

}  // namespace taxelsim::reference
