// Shear of the law lugre: bristles that bend, creep and slip with the velocity of the object; include/taxelsim/sensor.h, LuGre. Its normal
// pressure is that of winkler.glsl; skin/friction.glsl keeps the bristles' state between steps. Twin: src/reference/lugre.cpp.
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

// The contact pass's rule of skin/friction.glsl: bristles for the law lugre, else springs.
vec2 tractionAfter(inout vec2 sample_state, vec2 u, float share, float covered, float pressure, float per_dt) {
  if (BRISTLES) return pressure * bristleShear(sample_state, u, share, per_dt);
  return sample_state = springTraction(sample_state, u, share, covered, pressure);
}
