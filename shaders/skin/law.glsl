// The contact law of the contact pass: normal pressure of an elastic foundation, pressure over the two points of a cell, and shear by
// springs or bristles. Pressures in Pa, depths in m.
// References: src/reference/contact.cpp, cell_points.cpp, friction.cpp, lugre.cpp.
#ifndef SKIN_LAW_GLSL
#define SKIN_LAW_GLSL
#include "depth/tile.glsl"

// ---- pressure = STIFFNESS d^EXPONENT + DAMPING d', never negative; include/taxelsim/sensor.h, Winkler ----

// Pa at penetration d (m) that grows by d_rate (m/s).
float lawPressure(float d, float d_rate) {
  if (d <= 0.0) return 0.0;
  float elastic = EXPONENT == 1.0 ? STIFFNESS * d : STIFFNESS * pow(d, EXPONENT);
  return DAMPING == 0.0 ? elastic : max(elastic + DAMPING * d_rate, 0.0);
}

// d(pressure)/d(d) at rest, Pa/m; the load search needs pressure to be convex in d, so that Newton's method from above cannot overshoot.
float lawSlope(float d) {
  if (d <= 0.0) return 0.0;
  return EXPONENT == 1.0 ? STIFFNESS : STIFFNESS * EXPONENT * pow(d, EXPONENT - 1.0);
}

// ---- points of a cell ----
//
// Two points that represent the covered part of a cell, with VARIATION. They have the mean and the variance of its depth and its polar
// moment of area. Pressures that are not proportional to the depth are summed over both, and each has its own friction: in a cell on the
// edge of a contact the shallow part slips first.
//
//      deeper ->        The covered part is modelled as a strip on the deeper side of the cell. The points lie on a diagonal of the
//   +----+-------+      strip. Towards the deeper side their distance follows from their depths, so that pressure acts where that of
//   |    |     o |      the strip does; across that side it follows from the width of the strip. If two points differed in depth
//   |    | o     |      only, one would slip too far from the middle of the cell and the other too near.
//   +----+-------+
//
// The mean pressure is exact for exponent 2, and for exponent 3 where depths are distributed evenly, as under a paraboloid; for 1.5 it is
// 0.3 % low on its edge.

const uint kCellPoints = VARIATION ? 2u : 1u;  // points of a sample

struct CellPoints {
  float weight[2];      // shares of the covered part; their sum is 1
  float depth[2];       // m
  vec2 from_middle[2];  // m, in P
};

// Largest share of the covered part for the deeper point; less where the shallower one would be above the skin. On evenly distributed
// depths from 0 to D, where depths up to t D slip, friction is the mean t - t^2/2 of the smaller of two tractions. With 0.6 the largest
// errors of two points, at t = 0.15, 0.4 and 0.74, are 7 to 8 %; with 0.5 friction is 11.8 % too large at t = 0.21, while an edge begins to
// slip. Other exponents need equal parts for their mean pressure.
float mostDeep() { return EXPONENT == 1.0 ? 0.6 : 0.5; }

// `mean`: depth of the covered part, m. `share`: covered share of the cell. `variation`: variationOf(), depth/area/cell_depths.glsl.
CellPoints cellPoints(Tile tile, float mean, float share, uint variation) {
  vec2 deeper = unpackHalf2x16(variation);
  float ratio = length(deeper);
  deeper = ratio > 0.0 ? deeper / ratio : vec2(1, 0);
  float deep = min(mostDeep(), 1.0 / (1.0 + ratio * ratio));
  // From the mean to each point, in standard deviations of the depth and of the position.
  float above = sqrt(deep / (1.0 - deep)), below = 1.0 / above;
  CellPoints points;
  points.weight = float[2](1.0 - deep, deep);
  points.depth = float[2](mean * max(1.0 - ratio * above, 0.0), mean * (1.0 + ratio * below));
  float along = length(deeper * tile.spacing), across = length(deeper.yx * tile.spacing);
  vec2 width = (share * along * deeper + across * vec2(-deeper.y, deeper.x)) * inversesqrt(12.0);  // standard deviations
  vec2 middle = 0.5 * (1.0 - share) * along * deeper;
  points.from_middle = vec2[2](middle - above * width, middle + below * width);
  return points;
}

// Pressure, mean over the cell (Pa), of one of the points, whose depth grows by `rate` (m/s).
float pressureAt(CellPoints points, uint k, float share, float rate) {
  return share * points.weight[k] * lawPressure(points.depth[k], rate);
}

// Pressure, mean over the cell (Pa); the mean depth of the cell grows by `rate`.
float cellPressure(CellPoints points, float share, float rate) {
  float part_rate = rate / share;
  return pressureAt(points, 0, share, part_rate) + pressureAt(points, 1, share, part_rate);
}

// ---- shear ----
//
// Shear of the law lugre: bristles that bend, creep and slip with the velocity of the object; include/taxelsim/sensor.h, LuGre.
// skin/friction.glsl keeps the state of the bristles between steps. Reference: src/reference/lugre.cpp.
//
// The state of a sample is s = sigma0 z, the bristles' deflection z in units of friction, so that it is at most STATIC_FRICTION long
// whatever their stiffness. At one velocity v throughout a step that moves the object by u, s tends to g v / |v|:
//   s <- g v / |v| - off e^-x,  off = g v / |v| - s,  x = sigma0 |u| / g(|v|);  z' = off e^-x |v| / g at its end.

const float kMaxMotion = 1e18;  // m, along one axis, and
const float kMaxSpeed = 1e9;    // m/s: bounds for objects that jump
const float kMaxPerSecond = 1e30;

// 1 - e^-x for x >= 0; for small x by its series, to 1e-8, without a difference of nearly equal numbers. `fallen`: e^-x.
float relaxed(float x, float fallen) {
  float small = min(x, 0.5), square = small * small;
  float low = (1.0 - small * (1.0 / 2.0)) + square * (1.0 / 6.0 - small * (1.0 / 24.0));
  float high = (1.0 / 120.0 - small * (1.0 / 720.0)) + square * (1.0 / 5040.0 - small * (1.0 / 40320.0));
  return x < 0.5 ? small * (low + square * square * high) : 1.0 - fallen;
}

// Shear traction as a share of the pressure, after the object has moved by `u` (m, along x and y of P), a `share` of it in contact; updates
// the bristles `s`.
vec2 bristleShear(inout vec2 s, vec2 u, float share, float per_dt) {
  u = clamp(u, vec2(-kMaxMotion), vec2(kMaxMotion));
  float square = dot(u, u), per_length = square > 0.0 ? inversesqrt(square) : 0.0;
  vec2 along = u * per_length;  // 0 at rest, where nothing below depends on it
  float way = square * per_length;
  float speed = min(way * min(per_dt, kMaxPerSecond), kMaxSpeed);
  const float kFar = 20.0;  // e^(-kFar^2) is 0
  float fast = min(speed * (1.0 / STRIBECK_VELOCITY), kFar);
  float g = COULOMB_FRICTION + (STATIC_FRICTION - COULOMB_FRICTION) * exp(-fast * fast), per_g = 1.0 / g;
  const float kMaxExponent = 80.0;  // e^-80 is negligible
  float x = min(BRISTLE_STIFFNESS * way * share * per_g, kMaxExponent), fallen = exp(-x);
  vec2 off = g * along - s;
  s += relaxed(x, fallen) * off;
  return onCone(s + BRISTLE_DAMPING * (speed * per_g) * fallen * off + VISCOUS_FRICTION * speed * along, STATIC_FRICTION);
}

// Shear traction of skin/friction.glsl: bristles for the law lugre, else springs, whose state is their traction, Pa.
vec2 tractionAfter(inout vec2 sample_state, vec2 u, float share, float covered, float pressure, float per_dt) {
  if (BRISTLES) return pressure * bristleShear(sample_state, u, share, per_dt);
  return sample_state = onCone(sample_state + TANGENTIAL_STIFFNESS * covered * share * u, FRICTION_COEFFICIENT * pressure);
}
#endif
