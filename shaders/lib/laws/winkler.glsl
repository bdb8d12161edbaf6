// Elastic foundation: pressure = stiffness d^exponent + damping d', never negative; include/taxelsim/sensor.h, Winkler. Twin:
// src/reference/contact.cpp. `skin` is SensorRecord.skin.

// Pa at penetration d (m, >= 0) that grows by d_rate (m/s).
float lawPressure(vec4 skin, float d, float d_rate) {
  if (d <= 0.0) return 0.0;
  float elastic = skin.z == 1.0 ? skin.y * d : skin.y * pow(d, skin.z);
  return max(elastic + skin.w * d_rate, 0.0);
}

// d(pressure)/d(d) at rest, Pa/m; the load search needs pressure to be convex in d, so that Newton's method from above cannot overshoot.
float lawSlope(vec4 skin, float d) {
  if (d <= 0.0) return 0.0;
  return skin.z == 1.0 ? skin.y : skin.y * skin.z * pow(d, skin.z - 1.0);
}
