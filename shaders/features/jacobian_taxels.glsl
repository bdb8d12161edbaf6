// One taxel of the tactile Jacobian: its reading (the clean force, or what the readout makes of it before noise) and the derivative of its spread force. Forces
// in N.
// Twin: src/reference/tactile_jacobian.cpp.
//
// Mutable global, because an array passed as an argument would be copied per taxel: small_kernel, set once by loadKernel().

float small_kernel[9];  // weights of a kernel of 3 x 3

void loadKernel() {
  if (NUM_ROWS > 0 && KERNEL == 3) {
    for (uint n = 0; n < 9; ++n) small_kernel[n] = spread_rows[n >> 2][n & 3u];
  }
}

// A taxel's force as the features count it, N, and its derivative by the spread force.
vec2 readingOf(Part part, uint t) {
  float force = spread_normal[part.instance * NUM_TAXELS + t];
  if (CLEAN) return vec2(force, 1);
  vec4 drive = instances[part.instance].drive;
  uvec4 keys = instances[part.instance].keys;
  uvec2 seed = step_record.batch.zw;
  float gain = drive.y * taxels[t].readout.x;
  if (RANDOM && drive.z > 0.0) gain *= exp(drive.z * gaussian(seed, keys.xy, 0, t, kPurposeTaxelGain));
  float trigger = taxels[t].readout.y, x = gain * force - trigger;
  if (isDead(seed, keys.xy, t)) return vec2(0);
  // Without a trigger, forces of 0 change too: a contact may be about to cross the taxel's side.
  bool follows = (x > 0.0 || trigger <= 0.0) && x < SATURATION_FORCE;
  return vec2(x > 0.0 ? min(x, SATURATION_FORCE) + TRIGGER : 0.0, follows ? gain : 0.0);
}

// Derivative of a taxel's spread force by coordinate `k` of the twist, N/m or N/rad.
float spreadChange(Part part, uint t, uint k) {
  uint first = (part.instance * 6 + k) * NUM_TAXELS;
  float sum = 0.0;
  if (NUM_ROWS == 0) {
    for (uint e = 0; e < NUM_ENTRIES; ++e) {
      uint number = e * NUM_TAXELS + t;
      vec2 entry = (number & 1u) == 0 ? spread_rows[number >> 1].xy : spread_rows[number >> 1].zw;
      sum += entry.y * taxel_jacobian[first + floatBitsToUint(entry.x)];
    }
    return sum;
  }
  ivec2 at = ivec2(t / NUM_COLS, t % NUM_COLS);
  const int kRadius = int(KERNEL) / 2;
  for (int a = -kRadius; a <= kRadius; ++a) {
    for (int b = -kRadius; b <= kRadius; ++b) {
      uvec2 source = uvec2(at - ivec2(a, b));  // wraps to large numbers outside
      if (any(greaterThanEqual(source, uvec2(NUM_ROWS, NUM_COLS)))) continue;
      uint number = uint((a + kRadius) * int(KERNEL) + b + kRadius);
      float weight = KERNEL == 3 ? small_kernel[min(number, 8u)] : spread_rows[number >> 2][number & 3u];
      sum += weight * taxel_jacobian[first + source.x * NUM_COLS + source.y];
    }
  }
  return sum;
}
