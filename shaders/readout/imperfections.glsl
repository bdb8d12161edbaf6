// Imperfections of stage 5, counts: noise, bias and dead taxels, as functions of seed, episode and taxel (common/philox.glsl). The host
// draws the values that all taxels share. include/taxelsim/sensor.h, Readout. Reference: src/reference/imperfections.cpp.

// Offset from the nominal output without the random walk: noise of this frame, bias. `noise_level`: standard deviation, counts.
float offsetOf(uvec2 seed, uvec2 episode, uint frame, uint t, float noise_level) {
  float offset = 0.0;
  if (RANDOM && noise_level > 0.0) offset = noise_level * gaussian(seed, episode, frame, t, kPurposeReadoutNoise);
  if (BIAS > 0.0) offset += BIAS * gaussian(seed, episode, 0, t, kPurposeBias);
  return offset;
}

bool isDead(uvec2 seed, uvec2 episode, uint t) {
  return DEAD_TAXEL_PROBABILITY > 0.0 && uniformNumber(seed, episode, 0, t, kPurposeDeadTaxel) < DEAD_TAXEL_PROBABILITY;
}
