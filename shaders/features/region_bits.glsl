// Regions and core taxels of one grid of at most 32 x 32 taxels by one invocation, a bit per taxel in a word per row: the results of
// regions.glsl, region_selection.glsl and core_taxels.glsl without their loads and stores (driver/README.md).
// Mutable globals: the words of the rows.

const uint kMostBits = 32u;
const bool kByBits = TEAM == 1u && NUM_ROWS > 0u && NUM_ROWS <= kMostBits&& NUM_COLS <= kMostBits;
const uint kBitRows = kByBits ? NUM_ROWS : 1u;

uint reporting[kBitRows];  // taxels that report and are in no region yet
uint core[kBitRows];       // core taxels; until they are found, taxels that are not saturated
uint grown[kBitRows];      // taxels of the region that is being found

// Writes the forces of all taxels and the words of the silent ones; returns the largest force of reporting taxels. `is_stray`: a silent
// taxel has a force.
float writeForcesByBits(Instance instance, out bool is_stray) {
  is_stray = false;
  float peak = 0.0;
  uint row = 0, t = 0;
  if (instance.end > 0) do {
      uint reports = 0, below = 0, col = 0;
      [[dont_unroll]] do {
        Measured measured = measuredAt(instance, t);
        forces[instance.first_word + t] = measured.force;
        taxel_regions[instance.first_word + t] = measured.reports ? t : kNoRegion;
        if (measured.reports) peak = max(peak, measured.force);
        is_stray = is_stray || !measured.reports && measured.force != 0.0;
        reports |= (measured.reports ? 1u : 0u) << col;
        below |= (measured.saturated ? 0u : 1u) << col;
        ++t;
      }
      while (++col < NUM_COLS)
        ;
      reporting[row] = reports;
      core[row] = below;
    } while (++row < kBitRows);
  checkLoop(row < kBitRows && instance.end > 0);
  return peak;
}

// The taxels of a row around which all taxels within `distance` report; taxels beyond its ends count as such that do, and its ends never
// are core taxels.
uint coreOfRow(uint bits, uint distance) {
  const uint kRow = 0xFFFFFFFFu >> (kMostBits - NUM_COLS), kEnds = 1u | 1u << (NUM_COLS - 1u);
  uint found = bits & ~kEnds;
  for (uint k = 1; k <= min(distance, NUM_COLS - 1u); ++k) found &= (bits >> k | ~(kRow >> k)) & (bits << k | (1u << k) - 1u);
  return found;
}

void findCoreByBits() {
  uint distance = planeRecord(0).grid.w;
  for (uint row = 0; row < kBitRows; ++row) {
    uint found = row > 0 && row + 1 < kBitRows ? core[row] : 0u;
    uint last = min(row + distance, kBitRows - 1u);
    for (uint other = row - min(row, distance); other <= last; ++other) found &= coreOfRow(reporting[other], distance);
    core[row] = found;
  }
}

// Fills the runs of `free` that `seeds` has taxels of.
uint filled(uint seeds, uint free) {
  uint up = free, down = free, found = seeds & free;
  [[unroll]] for (uint k = 1; k < kMostBits; k *= 2) {
    found |= up & found << k | down & found >> k;
    up &= up << k;
    down &= down >> k;
  }
  return found;
}

// Grows the region into a row from the rows next to it. Returns whether it grew.
bool growRow(uint row) {
  uint next = (row > 0 ? grown[row - 1] : 0u) | (row + 1 < kBitRows ? grown[row + 1] : 0u);
  uint before = grown[row];
  grown[row] = filled(before | next | next << 1 | next >> 1, reporting[row]);
  return grown[row] != before;
}

// The lowest taxel without a region: its row, and its bit; 0 where there is none.
uvec2 lowestTaxel() {
  uvec2 lowest = uvec2(0);
  for (uint row = kBitRows; row > 0; --row) {
    uint bits = reporting[row - 1];
    if (bits != 0) lowest = uvec2(row - 1, bits & (~bits + 1u));
  }
  return lowest;
}

// The region of a taxel.
void growRegion(uvec2 taxel) {
  for (uint row = 0; row < kBitRows; ++row) grown[row] = row == taxel.x ? taxel.y : 0u;
  bool grows = true;
  while (grows) {
    grows = false;
    for (uint row = 0; row < kBitRows; ++row) grows = growRow(row) || grows;
    for (uint row = kBitRows; row > 0; --row) grows = growRow(row - 1) || grows;
  }
  checkLoop(grows);
}

// Writes the words of the region's taxels, and takes them from those without a region. Returns the sum of their forces, see FORCE_STEPS.
uint takeRegion(Instance instance, uint name, float steps) {
  uint sum = 0;
  for (uint row = 0; row < kBitRows; ++row) {
    uint bits = grown[row];
    reporting[row] &= ~bits;
    while (bits != 0) {
      uint col = uint(findLSB(bits)), t = row * NUM_COLS + col;
      sum += uint(forces[instance.first_word + t] * steps + 0.5);
      taxel_regions[instance.first_word + t] = name | ((core[row] >> col & 1u) != 0 ? kCoreTaxel : 0u);
      bits &= bits - 1u;
    }
    checkLoop(bits != 0);
  }
  return sum;
}

// Finds all regions by rising name, and writes the names of the REGIONS largest. Returns the number of all.
uint findRegionsByBits(Instance instance, float peak, bool is_stray) {
  const uint kRegions = REGIONS > 0u ? REGIONS : 1u;
  float steps = peak > 0.0 ? float(FORCE_STEPS) / peak : 0.0;
  uint sums[kRegions], names[kRegions], count = 0;  // sums plus 1, falling; 0: none
  for (uint r = 0; r < REGIONS; ++r) {
    sums[r] = 0;
    names[r] = kNoRegion;
  }
  // One loop over the regions, not one in each row: the regions of several instances are found together, wherever they begin.
  uvec2 taxel = instance.end > 0 ? lowestTaxel() : uvec2(0);
  while (taxel.y != 0) {
    uint name = taxel.x * NUM_COLS + uint(findLSB(taxel.y));
    growRegion(taxel);
    uint sum = takeRegion(instance, name, steps) + 1u;
    ++count;
    for (uint r = 0; r < REGIONS; ++r) {
      if (sum <= sums[r]) continue;
      uint lesser = sums[r], lesser_name = names[r];
      sums[r] = sum;
      names[r] = name;
      sum = lesser;
      name = lesser_name;
    }
    taxel = lowestTaxel();
  }
  checkLoop(taxel.y != 0);
  if (count == 1 && !is_stray) names[0] |= kOnlyRegion;
  for (uint r = 0; r < REGIONS && instance.end > 0; ++r) regions[instance.number * REGIONS + r] = names[r];
  return count;
}

// Without regions: the words of the core taxels.
void writeCoreByBits(Instance instance) {
  for (uint row = 0; row < kBitRows && instance.end > 0; ++row) {
    for (uint bits = core[row]; bits != 0; bits &= bits - 1u) {
      uint t = row * NUM_COLS + uint(findLSB(bits));
      taxel_regions[instance.first_word + t] = t | kCoreTaxel;
    }
  }
}
