// Elastic foundation: pressure = stiffness d^exponent + damping d', never negative; include/taxelsim/sensor.h, Winkler. Twin:
// src/reference/contact.cpp. LAW_0: stiffness, LAW_1: exponent, LAW_2: damping.

// Pa at penetration d (m) that grows by d_rate (m/s).
float lawPressure(float d, float d_rate) {
  if (d <= 0.0) return 0.0;
  float elastic = LAW_1 == 1.0 ? LAW_0 * d : LAW_0 * pow(d, LAW_1);
  return LAW_2 == 0.0 ? elastic : max(elastic + LAW_2 * d_rate, 0.0);
}

// d(pressure)/d(d) at rest, Pa/m; the load search needs pressure to be convex in d, so that Newton's method from above cannot overshoot.
float lawSlope(float d) {
  if (d <= 0.0) return 0.0;
  return LAW_1 == 1.0 ? LAW_0 : LAW_0 * LAW_1 * pow(d, LAW_1 - 1.0);
}

const bool kGlobalSolve = false;
