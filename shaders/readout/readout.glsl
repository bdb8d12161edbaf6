// Stage 5: force after spread and lag (N) to counts, and back by the nominal curve; include/taxelsim/sensor.h, Readout. Reference:
// src/reference/readout.cpp.

// Coefficient of x^power; that of a straight line is a specialization constant.
float curveCoefficient(int power) {
  if (CURVE_DEGREE == 1) return CURVE_SLOPE;
  return power <= 4 ? sensor.curve0[power - 1] : sensor.curve1[power - 5];
}

// The piece of a piecewise linear curve for x = gain F - trigger (axis 0) or for the counts y (axis 1); the first and last piece extend
// beyond the curve.
vec4 curvePiece(float value, int axis) {
  vec4 piece = sensor.curve_pieces[0];
  for (int k = 1; k < CURVE_PIECES; ++k) {
    vec4 next = sensor.curve_pieces[k];
    if (value >= next[axis]) piece = next;
  }
  return piece;
}

// Counts before limit and output scale, for x = gain F - trigger; linear below 0. A saturated polynomial stays at its first maximum.
float curveAt(float x) {
  if (CURVE_PIECES > 0) {
    vec4 piece = curvePiece(x, 0);
    return piece.y + piece.z * (x - piece.x);
  }
  if (x <= 0.0) return CURVE_SLOPE * x;
  if (CURVE_DEGREE > 1) x = min(x, sensor.curve1.y);
  float y = 0.0;
  for (int power = CURVE_DEGREE; power >= 1; --power) y = (y + curveCoefficient(power)) * x;
  return y;
}

// Saturation of a voltage divider, and its inverse.
float limitCounts(float y) { return CURVE_LIMIT > 0.0 && y > 0.0 ? y * CURVE_LIMIT / (CURVE_LIMIT + y) : y; }

float unlimitCounts(float y) { return CURVE_LIMIT > 0.0 ? y * CURVE_LIMIT / (CURVE_LIMIT - y) : y; }

uint countsOf(float force, float gain, float trigger, float noise) {
  float counts = OUTPUT_SCALE * limitCounts(curveAt(gain * force - trigger)) + noise;
  float whole = clamp(floor(counts + 0.5), 0.0, SATURATION);
  return SATURATION < kMostWhole ? uint(wholeNumber(whole)) : uint(whole);
}

// Force that the nominal curve gives for `counts`, N. Newton's method on the rising curve, from its tangent at 0; exact for straight lines.
float nominalForce(uint counts) {
  if (counts == 0) return 0.0;
  float y = unlimitCounts(float(counts) / OUTPUT_SCALE);
  if (CURVE_PIECES > 0) {
    vec4 piece = curvePiece(y, 1);
    return piece.x + piece.w * (y - piece.y) + TRIGGER;
  }
  float x = y / CURVE_SLOPE;
  if (CURVE_DEGREE > 1) {
    const int kIterations = 24;
    for (int i = 0; i < kIterations; ++i) {
      float slope = 0.0;
      for (int power = CURVE_DEGREE; power >= 1; --power) slope = slope * x + float(power) * curveCoefficient(power);
      if (slope <= 0.0) break;
      x = max(x - (curveAt(x) - y) / slope, 0.0);
    }
  }
  return x + TRIGGER;
}
