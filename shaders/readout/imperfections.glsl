// Imperfections of stage 5, drawn anew by each reset: functions of seed, episode and taxel. What is common to all taxels is drawn on the host
// (src/simulation/simulator.cpp). include/taxelsim/sensor.h, Readout. Twin: src/reference/imperfections.cpp.

// Counts beside the nominal output, but for the drift: noise of this frame, bias.
float offsetOf(uvec2 seed, uvec2 episode, uint frame, uint t, float noise_level) {
  float offset = 0.0;
  if (RANDOM && noise_level > 0.0) offset = noise_level * gaussian(seed, episode, frame, t, kPurposeReadoutNoise);
  if (BIAS > 0.0) offset += BIAS * gaussian(seed, episode, 0, t, kPurposeBias);
  return offset;
}

bool isDead(uvec2 seed, uvec2 episode, uint t) {
  return DEAD_TAXELS > 0.0 && uniformNumber(seed, episode, 0, t, kPurposeDeadTaxel) < DEAD_TAXELS;
}
