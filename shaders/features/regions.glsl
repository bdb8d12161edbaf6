// Connected regions of taxels that report, by union-find over taxel_regions[] (shared/features.h): a region is named by its lowest taxel,
// whatever order taxels are united in. Reference: src/reference/contact_features.cpp.

// Root of taxel `t`: the taxel that names its region so far. Path halving. Names only fall, so that no invocation replaces the name that
// another one has found by an older one.
uint findRoot(uint first_word, uint t) {
  uint next = taxel_regions[first_word + t];
  while (next != t) {
    uint after = taxel_regions[first_word + next];
    if (TEAM == 1) {
      taxel_regions[first_word + t] = after;
    } else {
      atomicMin(taxel_regions[first_word + t], after);
    }
    t = next;
    next = after;
  }
  checkLoop(next != t);
  return t;
}

// Unites the regions of two taxels under the lower of their names. If another invocation has changed the higher root meanwhile, its new
// parent is united as well.
void unite(uint first_word, uint a, uint b) {
  bool done = false;
  while (!done) {
    a = findRoot(first_word, a);
    b = findRoot(first_word, b);
    uint high = max(a, b);
    b = min(a, b);
    if (high == b) {
      done = true;
    } else if (TEAM == 1) {
      taxel_regions[first_word + high] = b;
      done = true;
    } else {
      a = atomicMin(taxel_regions[first_word + high], b);
      done = a == high;
    }
  }
  checkLoop(!done);
}

// Patch of a taxel, and its row and column there.
// Patch and cell of a taxel.
struct GridCell {
  uvec4 grid;  // grid of the patch
  uvec2 at;
};

GridCell gridCell(uint t) {
  uvec4 grid = planeRecord(NUM_PATCHES == 1 ? 0 : uint(taxels[t].readout.z)).grid;
  uint cols = NUM_PATCHES == 1 && NUM_ROWS > 0 ? NUM_COLS : grid.y;
  return GridCell(grid, uvec2((t - grid.z) / cols, (t - grid.z) % cols));
}

bool reportsAt(uint first_word, uint t) { return reports(taxel_regions[first_word + t]); }

// Unites the region of a taxel with those of its neighbours of lower number.
void uniteNeighbours(uint first_word, uint t) {
  for (uint e = 0; e < NUM_NEIGHBOURS; ++e) {
    uint other = neighbours[e * NUM_TAXELS + t];
    if (reportsAt(first_word, other)) unite(first_word, t, other);
  }
  if (!kGrids) return;
  // The taxel above is adjacent to the left one and to its own two neighbours in the row, so the reporting ones form at most two regions:
  // `before` and `after` are one taxel of each.
  GridCell cell = gridCell(t);
  uint before = t, after = t, above = t - cell.grid.y;
  bool has_left = cell.at.y > 0, has_row = cell.at.x > 0;
  if (has_row && has_left && reportsAt(first_word, above - 1)) before = above - 1;
  if (has_left && reportsAt(first_word, t - 1)) before = t - 1;
  if (has_row && cell.at.y + 1 < cell.grid.y && reportsAt(first_word, above + 1)) after = above + 1;
  if (has_row && reportsAt(first_word, above)) {
    before = above;
    after = t;
  }
  if (before != t) unite(first_word, t, before);
  if (after != t) unite(first_word, t, after);
}
