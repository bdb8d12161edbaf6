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

// On one grid patch with a kernel of 3 x 3: along a row, so that a step fetches three sources and not nine; along two neighbouring rows four and not
// eighteen. Outside of what contact reaches there is no source, and a window begins with a column that has none before it.
//
//   column:   before  here  after          weights_...[d]: of the source in row i - 1 + d of that column, for the taxel at (i, j)
//   row i-1      x      x      x
//   row i        x    (i,j)    x
//   row i+1      x      x      x
//   row i+2      x      x      x           with two rows at once
vec3 weights_before, weights_here, weights_after;

struct Column {
  vec4 normal, shear_x, shear_y;
};
Column column_before, column_here, column_after;

void loadKernel() {
  if (NUM_ROWS == 0 || KERNEL != 3) return;
  vec4 w0 = spread_rows[0], w1 = spread_rows[1], w2 = spread_rows[2];
  weights_before = vec3(w2.x, w1.y, w0.z);
  weights_here = vec3(w1.w, w1.x, w0.y);
  weights_after = vec3(w1.z, w0.w, w0.x);
}

Column columnAt(uint first_taxel, ivec2 at) {
  Column column = Column(vec4(0), vec4(0), vec4(0));
  for (int d = 0; d < 2 + int(kRowsAtOnce); ++d) {
    uvec2 source = uvec2(at + ivec2(d - 1, 0));  // wraps to large numbers outside
    if (any(greaterThanEqual(source - contact_first, contact_count))) continue;
    uint taxel = first_taxel + source.x * NUM_COLS + source.y;
    column.normal[d] = contact_normal[taxel];
    if (SHEAR) {
      column.shear_x[d] = contact_shear[2 * taxel];
      column.shear_y[d] = contact_shear[2 * taxel + 1];
    }
  }
  return column;
}

// Once at the start of a row (or two), at its first taxel; then nextColumn() before each taxel, that one included.
void startColumns(uint first_taxel, ivec2 at) {
  column_here = Column(vec4(0), vec4(0), vec4(0));
  column_after = columnAt(first_taxel, at);
}

void nextColumn(uint first_taxel, ivec2 at) {
  column_before = column_here;
  column_here = column_after;
  column_after = columnAt(first_taxel, at + ivec2(0, 1));
}

float weighted(uint row, vec4 before, vec4 here, vec4 after) {
  if (row == 0) return dot(weights_before, before.xyz) + dot(weights_here, here.xyz) + dot(weights_after, after.xyz);
  return dot(weights_before, before.yzw) + dot(weights_here, here.yzw) + dot(weights_after, after.yzw);
}

// At the taxel of the column in the first or second row.
Spread spreadSliding(uint row) {
  Spread sum = Spread(weighted(row, column_before.normal, column_here.normal, column_after.normal), vec2(0));
  if (SHEAR) {
    sum.shear.x = weighted(row, column_before.shear_x, column_here.shear_x, column_after.shear_x);
    sum.shear.y = weighted(row, column_before.shear_y, column_here.shear_y, column_after.shear_y);
  }
  return sum;
}

// On one grid patch: the kernel itself, over the sources that contact reaches.
Spread spreadOnGrid(uint first_taxel, ivec2 at) {
  Spread sum = Spread(0.0, vec2(0));
  const int kRadius = int(KERNEL) / 2;
  for (int a = -kRadius; a <= kRadius; ++a) {
    for (int b = -kRadius; b <= kRadius; ++b) {
      uvec2 source = uvec2(at - ivec2(a, b));
      uint number = uint((a + kRadius) * int(KERNEL) + b + kRadius);
      float weight = spread_rows[number >> 2][number & 3u];
      if (all(lessThan(source - contact_first, contact_count))) addSource(sum, first_taxel + source.x * NUM_COLS + source.y, weight);
    }
  }
  return sum;
}

vec2 pairOfRows(uint number) { return (number & 1u) == 0 ? spread_rows[number >> 1].xy : spread_rows[number >> 1].zw; }

// On any sensor: a list of sources per taxel, (NUM_ENTRIES x num_taxels) pairs of taxel (as bits) and weight, two to a row; after them as many of cosine
// and sine where a source's shear turns with the skin on its way.
Spread spreadByList(uint first_taxel, uint t) {
  Spread sum = Spread(0.0, vec2(0));
  for (uint e = 0; e < NUM_ENTRIES; ++e) {
    uint number = e * NUM_TAXELS + t;
    vec2 entry = pairOfRows(number);
    uint source = first_taxel + floatBitsToUint(entry.x);
    if (!SHEAR || !TURNS_SHEAR) {
      addSource(sum, source, entry.y);
      continue;
    }
    vec2 turn = pairOfRows(NUM_ENTRIES * NUM_TAXELS + number);
    vec2 shear = vec2(contact_shear[2 * source], contact_shear[2 * source + 1]);
    sum.normal += entry.y * contact_normal[source];
    sum.shear += entry.y * vec2(turn.x * shear.x - turn.y * shear.y, turn.y * shear.x + turn.x * shear.y);
  }
  return sum;
}
