// Philox4x32-10 (J. K. Salmon et al., SC 2011), bit-equal to src/base/philox.h; and the draws of a taxel.
uvec4 philox(uvec4 counter, uvec2 key) {
  for (int round = 0; round < 10; ++round) {
    uint high0, low0, high1, low1;
    umulExtended(0xD2511F53u, counter.x, high0, low0);
    umulExtended(0xCD9E8D57u, counter.z, high1, low1);
    counter = uvec4(high1 ^ counter.y ^ key.x, low1, high0 ^ counter.w ^ key.y, low0);
    key += uvec2(0x9E3779B9u, 0xBB67AE85u);
  }
  return counter;
}

// Draws of one taxel: functions of seed, episode, frame (or step), taxel and purpose alone.
uvec4 taxelWords(uvec2 seed, uvec2 episode, uint frame, uint taxel, uint purpose) {
  return philox(uvec4(episode, frame, taxel | purpose << 24), seed);
}

// Uniform on [0, 1), 24 bits.
float uniformNumber(uvec2 seed, uvec2 episode, uint frame, uint taxel, uint purpose) {
  return float(taxelWords(seed, episode, frame, taxel, purpose).x >> 8) * (1.0 / 16777216.0);
}

// Standard normal (Box and Muller).
float gaussian(uvec2 seed, uvec2 episode, uint frame, uint taxel, uint purpose) {
  uvec4 words = taxelWords(seed, episode, frame, taxel, purpose);
  float u = (float(words.x >> 8) + 0.5) * (1.0 / 16777216.0);
  float angle = float(words.y >> 8) * (6.28318530718 / 16777216.0);
  return sqrt(-2.0 * log(u)) * cos(angle);
}
