// Stage 3: the point spread function, paper eq. (1). contact_normal and contact_shear already hold what each source gives to the spread: its force over
// the part of the kernel that stays on the sensor. Twin: src/reference/psf.cpp.

struct Spread {
  float normal;
  vec2 shear;
};

void addSource(inout Spread sum, uint source, float weight) {
  sum.normal += weight * contact_normal[source];
  if (SHEAR) sum.shear += weight * vec2(contact_shear[2 * source], contact_shear[2 * source + 1]);
}

// Weights of a 3 x 3 kernel, fetched once; rows a = -1, 0, 1.
vec3 kernel_rows[3];

void loadKernel() {
  if (NUM_ROWS == 0 || KERNEL != 3) return;
  vec4 w0 = spread_rows[0], w1 = spread_rows[1], w2 = spread_rows[2];
  kernel_rows[0] = w0.xyz;
  kernel_rows[1] = vec3(w0.w, w1.xy);
  kernel_rows[2] = vec3(w1.zw, w2.x);
}

// On one grid patch: the kernel itself, over the sources that contact reaches.
Spread spreadOnGrid(uint first_taxel, ivec2 at) {
  Spread sum = Spread(0.0, vec2(0));
  const int kRadius = int(KERNEL) / 2;
  for (int a = -kRadius; a <= kRadius; ++a) {
    for (int b = -kRadius; b <= kRadius; ++b) {
      uvec2 source = uvec2(at - ivec2(a, b));  // wraps to large numbers outside
      float weight;
      if (KERNEL == 3) {
        weight = kernel_rows[a + 1][b + 1];
      } else {
        uint number = uint((a + kRadius) * int(KERNEL) + b + kRadius);
        weight = spread_rows[number >> 2][number & 3u];
      }
      if (all(lessThan(source - contact_first, contact_count))) addSource(sum, first_taxel + source.x * NUM_COLS + source.y, weight);
    }
  }
  return sum;
}

// On any sensor: a list of sources per taxel, (NUM_ENTRIES x num_taxels) pairs of taxel (as bits) and weight, two to a row.
Spread spreadByList(uint first_taxel, uint t) {
  Spread sum = Spread(0.0, vec2(0));
  for (uint e = 0; e < NUM_ENTRIES; ++e) {
    uint number = e * NUM_TAXELS + t;
    vec2 entry = (number & 1u) == 0 ? spread_rows[number >> 1].xy : spread_rows[number >> 1].zw;
    addSource(sum, first_taxel + floatBitsToUint(entry.x), entry.y);
  }
  return sum;
}
