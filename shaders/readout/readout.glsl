// Stage 5: force after the spread -> counts, and back by the nominal curve; include/taxelsim/sensor.h, Readout. Twin:
// src/reference/readout.cpp.

// Coefficient of x^power; a straight line's is a constant of the pipeline.
float curveCoefficient(int power) {
  if (CURVE_DEGREE == 1) return CURVE_SLOPE;
  return power <= 4 ? sensor.curve0[power - 1] : sensor.curve1[power - 5];
}

// The piece of a curve of points that holds x = gain F - trigger (axis 0) or the counts y (axis 1); what lies outside is of the first or last.
vec4 curvePiece(float value, int axis) {
  vec4 piece = sensor.curve_pieces[0];
  for (int k = 1; k < CURVE_PIECES; ++k) {
    vec4 next = sensor.curve_pieces[k];
    if (value >= next[axis]) piece = next;
  }
  return piece;
}

// Counts before limit and output scale, for x = gain F - trigger; a straight line below 0.
float curveAt(float x) {
  if (CURVE_PIECES > 0) {
    vec4 piece = curvePiece(x, 0);
    return piece.y + piece.z * (x - piece.x);
  }
  if (x <= 0.0) return CURVE_SLOPE * x;
  float y = 0.0;
  for (int power = CURVE_DEGREE; power >= 1; --power) y = (y + curveCoefficient(power)) * x;
  return y;
}

// What a voltage divider makes of it; and back.
float limited(float y) {
  return CURVE_LIMIT > 0.0 && y > 0.0 ? y * CURVE_LIMIT / (CURVE_LIMIT + y) : y;
}

float unlimited(float y) {
  return CURVE_LIMIT > 0.0 ? y * CURVE_LIMIT / (CURVE_LIMIT - y) : y;
}

uint countsOf(float force, float gain, float trigger, float noise) {
  float counts = OUTPUT_SCALE * limited(curveAt(gain * force - trigger)) + noise;
  float whole = clamp(floor(counts + 0.5), 0.0, SATURATION);
  return SATURATION < kMostWhole ? uint(wholeNumber(whole)) : uint(whole);
}

// Newton's method on the rising curve, from its own tangent at 0; straight lines are done at once.
float nominalForce(uint counts) {
  if (counts == 0) return 0.0;
  float y = unlimited(float(counts) / OUTPUT_SCALE);
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
