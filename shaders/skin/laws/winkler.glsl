// Elastic foundation: pressure = stiffness d^exponent + damping d', never negative; include/taxelsim/sensor.h, Winkler. Twin:
// src/reference/contact.cpp.

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
