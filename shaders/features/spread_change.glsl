// Derivative of a taxel's force after the point spread function by the sensor's twist, from those of the contact forces. Reference:
// src/reference/tactile_jacobian.cpp.
//
// Mutable global, because an array passed as an argument would be copied per taxel: small_kernel, set once by loadKernel().

float small_kernel[9];  // weights of a kernel of 3 x 3

void loadKernel() {
  if (NUM_ROWS > 0 && KERNEL == 3) {
    for (uint n = 0; n < 9; ++n) small_kernel[n] = spread_rows[n >> 2][n & 3u];
  }
}

// Weight of the kernel at an offset of rows and columns from the source to the receiver.
float kernelAt(int a, int b) {
  const int kRadius = int(KERNEL) / 2;
  uint number = uint((a + kRadius) * int(KERNEL) + b + kRadius);
  return KERNEL == 3 ? small_kernel[min(number, 8u)] : spread_rows[number >> 2][number & 3u];
}

// Entry `e` of the list of a taxel, where the sensor is not one grid patch: source (as bits) and weight.
vec2 spreadEntry(uint e, uint t) {
  uint number = e * NUM_TAXELS + t;
  return (number & 1u) == 0 ? spread_rows[number >> 1].xy : spread_rows[number >> 1].zw;
}

// Derivative of a taxel's spread force by coordinate `k` of the twist, N/m or N/rad.
float spreadChange(uint instance, uint t, uint k) {
  uint first = (instance * 6 + k) * NUM_TAXELS;
  float sum = 0.0;
  if (NUM_ROWS == 0) {
    for (uint e = 0; e < NUM_ENTRIES; ++e) {
      vec2 entry = spreadEntry(e, t);
      sum += entry.y * floatOfFours(TaxelJacobian, first + floatBitsToUint(entry.x));
    }
    return sum;
  }
  ivec2 at = ivec2(t / NUM_COLS, t % NUM_COLS);
  const int kRadius = int(KERNEL) / 2;
  for (int a = -kRadius; a <= kRadius; ++a) {
    for (int b = -kRadius; b <= kRadius; ++b) {
      uvec2 source = uvec2(at - ivec2(a, b));  // wraps to large numbers outside
      if (any(greaterThanEqual(source, uvec2(NUM_ROWS, NUM_COLS)))) continue;
      sum += kernelAt(a, b) * floatOfFours(TaxelJacobian, first + source.x * NUM_COLS + source.y);
    }
  }
  return sum;
}
