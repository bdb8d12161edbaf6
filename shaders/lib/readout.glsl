// Stage 5: force after the spread -> counts, and back by the nominal curve; include/taxelsim/sensor.h, Readout. Twin:
// src/reference/readout.cpp.

float curveCoefficient(int power) { return power <= 4 ? sensor.curve0[power - 1] : sensor.curve1[power - 5]; }

// Counts before output scale, for x = gain F - trigger; a straight line below 0.
float curveAt(float x) {
  if (x <= 0.0) return sensor.curve0.x * x;
  float y = 0.0;
  for (int power = int(sensor.counts.w); power >= 1; --power) y = (y + curveCoefficient(power)) * x;
  return y;
}

uint countsOf(float force, float gain, float trigger, float noise) {
  float counts = sensor.readout.x * curveAt(gain * force - trigger) + noise;
  return uint(clamp(floor(counts + 0.5), 0.0, sensor.readout.z));
}

// Newton's method on the rising curve, from its own tangent at 0; a straight line is done at once.
float nominalForce(uint counts) {
  if (counts == 0) return 0.0;
  float y = float(counts) / sensor.readout.x;
  float x = y / sensor.curve0.x;
  if (sensor.counts.w > 1) {
    const int kIterations = 24;
    for (int i = 0; i < kIterations; ++i) {
      float slope = 0.0;
      for (int power = int(sensor.counts.w); power >= 1; --power) slope = slope * x + float(power) * curveCoefficient(power);
      if (slope <= 0.0) break;
      x = max(x - (curveAt(x) - y) / slope, 0.0);
    }
  }
  return x + sensor.readout.y;
}
