// Sums over the taxels of an image, from which stage 6 computes features; and their total over a team in a fixed order. Forces in N,
// lengths in m.
// Shared memory: 4 PARTIALS bytes, PARTIALS = kNumSums LANES per team of more than one invocation.

const uint kPeak = 8u;  // index of the largest force among the kSumsPerImage sums of an image (passes/image.h)

shared float partial[PARTIALS];

struct ImageSums {
  float measured[kSumsPerImage], clean[kSumsPerImage];
  float num_saturated;
};

ImageSums noSums() {
  ImageSums sums;
  for (uint s = 0; s < kSumsPerImage; ++s) sums.measured[s] = sums.clean[s] = 0.0;
  sums.num_saturated = 0.0;
  return sums;
}

// Adds a taxel's force `weight`, N. `chart`: position (m) and area (m^2). `touched`: the area counts.
void addForce(inout float image_sums[kSumsPerImage], float weight, vec4 chart, bool touched) {
  image_sums[0] += weight;
  image_sums[1] += weight * chart.x;
  image_sums[2] += weight * chart.y;
  image_sums[3] += weight * chart.z;
  image_sums[4] += weight * chart.x * chart.x;
  image_sums[5] += weight * chart.x * chart.y;
  image_sums[6] += weight * chart.y * chart.y;
  image_sums[7] += touched ? chart.w : 0.0;
  image_sums[kPeak] = max(image_sums[kPeak], weight);
}

void addSums(inout ImageSums total, ImageSums part) {
  for (uint s = 0; s < kPeak; ++s) {
    total.measured[s] += part.measured[s];
    total.clean[s] += part.clean[s];
  }
  total.measured[kPeak] = max(total.measured[kPeak], part.measured[kPeak]);
  total.clean[kPeak] = max(total.clean[kPeak], part.clean[kPeak]);
  total.num_saturated += part.num_saturated;
}

// Partial sum `v` of a team, whose partials begin at `first`.
void storePartial(uint first, uint v, ImageSums part) {
  for (uint s = 0; s < kSumsPerImage; ++s) {
    partial[first + s * LANES + v] = part.measured[s];
    partial[first + (kSumsPerImage + s) * LANES + v] = part.clean[s];
  }
  partial[first + 2 * kSumsPerImage * LANES + v] = part.num_saturated;
}

void addPartial(uint first, uint v, inout ImageSums total) {
  ImageSums part;
  for (uint s = 0; s < kSumsPerImage; ++s) {
    part.measured[s] = partial[first + s * LANES + v];
    part.clean[s] = partial[first + (kSumsPerImage + s) * LANES + v];
  }
  part.num_saturated = partial[first + 2 * kSumsPerImage * LANES + v];
  addSums(total, part);
}
