// Shear of the law lugre: bristles that bend, creep and slip with the velocity of the object; include/taxelsim/sensor.h, LuGre. Its normal pressure is that of
// winkler.glsl; skin/friction.glsl keeps the bristles' state between steps. Twin: src/reference/lugre.cpp.
//
// The state of a sample is s = sigma0 z, the bristles' deflection z in units of friction, so that it is at most STATIC_FRICTION long whatever their
// stiffness. At one velocity v throughout a step that moves the object by u, s tends to g v / |v|:
//   s <- g v / |v| - off e^-x,  off = g v / |v| - s,  x = sigma0 |u| / g(|v|);  z' = off e^-x |v| / g at its end.

const float kMaxSpeed = 1e9;     // m/s; bounds the speed of objects that jump
const float kMaxPerSecond = 1e30;

// 1 - e^-x for x >= 0; for small x by a series, to 1e-8, without a difference of nearly equal numbers.
float relaxed(float x) {
  float small = min(x, 0.5), sum = 1.0;
  for (int n = 8; n >= 2; --n) sum = 1.0 - small / float(n) * sum;
  return x < 0.5 ? small * sum : 1.0 - exp(-x);
}

// Shear traction as a share of the pressure, after the object has moved by `u` (m, along x and y of P), a `share` of it in contact; updates the bristles `s`.
vec2 bristleShear(inout vec2 s, vec2 u, float share, float per_dt) {
  float largest = max(abs(u.x), abs(u.y));
  if (largest <= 0.0) return onCone(s, STATIC_FRICTION);
  vec2 along = u / largest;
  float size = length(along);  // 1 to sqrt(2)
  along /= size;
  float way = largest * size;
  float speed = min(way * min(per_dt, kMaxPerSecond), kMaxSpeed);
  const float kFar = 20.0;  // e^(-kFar^2) is 0
  float fast = speed < kFar * STRIBECK_VELOCITY ? speed / STRIBECK_VELOCITY : kFar;
  float g = COULOMB_FRICTION + (STATIC_FRICTION - COULOMB_FRICTION) * exp(-fast * fast);
  const float kMaxExponent = 80.0;  // e^-80 is negligible
  float x = min(BRISTLE_STIFFNESS * way * share, kMaxExponent * g) / g;
  vec2 off = g * along - s;
  s += relaxed(x) * off;
  return onCone(s + BRISTLE_DAMPING * (speed / g) * exp(-x) * off + VISCOUS_FRICTION * speed * along, STATIC_FRICTION);
}

// The contact pass's rule of skin/friction.glsl: bristles for the law lugre, else springs.
vec2 tractionAfter(inout vec2 sample_state, vec2 u, float share, float covered, float pressure, float per_dt) {
  if (BRISTLES) return pressure * bristleShear(sample_state, u, share, per_dt);
  return sample_state = springTraction(sample_state, u, share, covered, pressure);
}
