// The load search over one tile. Included by contact.comp, whose names it uses. Twin: src/reference/load.cpp.

struct Search {
  float depth;   // of the lowest sample, m
  float lowest;  // height of the lowest sample before the move, as the tile counts it: over z_base, m
  float offset;  // by which the objects move, m
  float status;  // kLoadCarried or kLoadOutOfReach
};

uint addressOf(uvec2 at) { return at.x * tile_stride + at.y; }

// Depth of the lowest sample at which the samples of the window carry `load`: Newton's method from full depth down. Only z moves, so the gaps
// between the samples are those of the tile.
Search searchLoad(float load, uvec2 first, uvec2 count) {
  const int kMaxIterations = 32;
  const float kTolerance = 2e-6;  // of the load; some ten roundings of a float
  uint total = count.x * count.y;
  uint lane_lowest = kEmpty;
  for (uint i = gl_LocalInvocationIndex; i < total; i += WORKGROUP) {
    lane_lowest = min(lane_lowest, tile[addressOf(first + cellNumbered(i, count.y))]);
  }
  atomicMin(lowest_bits, lane_lowest);
  workgroupBarrier();
  Search found = Search(0.0, 0.0, 0.0, kLoadOutOfReach);
  uint lowest = lowest_bits;
  if (lowest == kEmpty) return found;
  found.lowest = withoutSlot(lowest);
  found.depth = THICKNESS;
  for (int iteration = 0; iteration < kMaxIterations; ++iteration) {
    for (uint v = gl_LocalInvocationIndex; v < LANES; v += WORKGROUP) {
      float force = 0.0, slope = 0.0;
      uint i = v;
      for (; i < total; i += LANES) {
        uvec2 at = first + cellNumbered(i, count.y);
        uint address = addressOf(at);
        float d = found.depth - (withoutSlot(tile[address]) - found.lowest);
        float f = lawPressure(d, 0.0), f_slope = lawSlope(d);
        if (RELAXATION > 0) {
          bool reached = isReached(at / SAMPLES);
          f = relaxedPressure(skinAt(address, reached), f);
          f_slope = f > 0.0 ? skin_gain * f_slope : 0.0;
        }
        force += f;
        slope += f_slope;
      }
      cut_short = cut_short || i < total;
      partial[v] = vec4(force, slope, 0, 0) * sample_area;
    }
    vec4 sums = sumOfPartials();
    float excess = sums.x - load;
    if (iteration == 0 && excess < -kTolerance * load) break;  // even full depth carries less
    found.status = kLoadCarried;
    if (RELAXATION > 0 && load > 0.0 && sums.y <= 0.0) found.status = kLoadOutOfReach;  // lost in the rounding of a much deeper dent
    if (abs(excess) <= kTolerance * load || sums.y <= 0.0) break;
    found.depth = clamp(found.depth - excess / sums.y, 0.0, THICKNESS);
  }
  if (RELAXATION == 0 && load == 0.0) found.depth = 0.0;  // else at the bottom of a dent
  found.offset = -found.depth - (z_base + found.lowest);
  return found;
}
