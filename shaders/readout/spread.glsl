// Stage 3: the point spread function, paper eq. (1). Forces in N. contact_normal and contact_shear already hold what each source gives to
// the spread: its force divided by the part of the kernel that stays on the sensor. Reference: src/reference/psf.cpp.

struct Spread {
  float normal;
  vec2 shear;
};

void addSource(inout Spread sum, uint source, float weight) {
  sum.normal += weight * contact_normal[source];
  if (SHEAR) sum.shear += weight * vec2(contact_shear[2 * source], contact_shear[2 * source + 1]);
}

// ---- a grid patch with a kernel of 3 x 3: a window slides along a row ----
//
// Sources outside the window of contact are 0. A step fetches three sources instead of nine; two neighbouring rows at once fetch four
// instead of eighteen.
//
//   column:   before  here  after          Kernel::...[d]: weight of the source in row i - 1 + d of that column, for the taxel at (i, j)
//   row i-1      x      x      x
//   row i        x    (i,j)    x
//   row i+1      x      x      x
//   row i+2      x      x      x           with two rows at once

const bool kSliding = kOnePatch && KERNEL == 3;
const uint kRowsAtOnce = kSliding && TEAM == 1 && LANES > 1 ? 2 : 1;

struct Kernel {
  vec3 before, here, after;
};

Kernel loadKernel() {
  if (NUM_ROWS == 0 || KERNEL != 3) return Kernel(vec3(0), vec3(0), vec3(0));
  vec4 w0 = spread_rows[0], w1 = spread_rows[1], w2 = spread_rows[2];
  return Kernel(vec3(w2.x, w1.y, w0.z), vec3(w1.w, w1.x, w0.y), vec3(w1.z, w0.w, w0.x));
}

struct Column {
  vec4 normal, shear_x, shear_y;
};

struct Columns {
  Column before, here, after;
};

Column noColumn() { return Column(vec4(0), vec4(0), vec4(0)); }

// The sources in the rows around taxel `at`, in its column.
Column columnAt(uint first_taxel, ImageWindow window, uvec2 at) {
  Column column = noColumn();
  bool is_reached = at.y - window.contact_first.y < window.contact_count.y;
  [[unroll]] for (uint d = 0; d < 2 + kRowsAtOnce; ++d) {
    uint row = at.x + d - 1u;  // before the first one: a large number
    if (row - window.contact_first.x >= window.contact_count.x || !is_reached) continue;
    uint taxel = first_taxel + row * NUM_COLS + at.y;
    column.normal[d] = floatOfFours(ForceFours, taxel);
    if (!SHEAR) continue;
    column.shear_x[d] = contact_shear[2 * taxel];
    column.shear_y[d] = contact_shear[2 * taxel + 1];
  }
  return column;
}

// At the first taxel of a row, before which contact reaches none; then slideColumns() before each taxel, the first included.
void startColumns(uint first_taxel, ImageWindow window, uvec2 at, inout Columns columns) {
  columns.here = noColumn();
  columns.after = columnAt(first_taxel, window, at);
}

void slideColumns(uint first_taxel, ImageWindow window, uvec2 at, inout Columns columns) {
  columns.before = columns.here;
  columns.here = columns.after;
  columns.after = columnAt(first_taxel, window, at + uvec2(0, 1));
}

float weighted(Kernel kernel, uint row, vec4 before, vec4 here, vec4 after) {
  if (row == 0) return dot(kernel.before, before.xyz) + dot(kernel.here, here.xyz) + dot(kernel.after, after.xyz);
  return dot(kernel.before, before.yzw) + dot(kernel.here, here.yzw) + dot(kernel.after, after.yzw);
}

// At the taxel in the first (0) or second (1) row of the columns.
Spread spreadSliding(Kernel kernel, inout Columns columns, uint row) {
  Column before = columns.before, here = columns.here, after = columns.after;
  Spread sum = Spread(weighted(kernel, row, before.normal, here.normal, after.normal), vec2(0));
  if (SHEAR) {
    sum.shear.x = weighted(kernel, row, before.shear_x, here.shear_x, after.shear_x);
    sum.shear.y = weighted(kernel, row, before.shear_y, here.shear_y, after.shear_y);
  }
  return sum;
}

// ---- a grid patch with any kernel: over the sources that contact reaches ----

Spread spreadOnGrid(uint first_taxel, ImageWindow window, ivec2 at) {
  Spread sum = Spread(0.0, vec2(0));
  const int kRadius = int(KERNEL) / 2;
  for (int a = -kRadius; a <= kRadius; ++a) {
    for (int b = -kRadius; b <= kRadius; ++b) {
      uvec2 source = uvec2(at - ivec2(a, b));
      uint number = uint((a + kRadius) * int(KERNEL) + b + kRadius);
      float weight = spread_rows[number >> 2][number & 3u];
      if (all(lessThan(source - window.contact_first, window.contact_count)))
        addSource(sum, first_taxel + source.x * NUM_COLS + source.y, weight);
    }
  }
  return sum;
}

// ---- any sensor: a list of sources per taxel ----
//
// (NUM_ENTRIES x num_taxels) pairs of source (as bits) and weight, two pairs to a row of spread_rows; then as many pairs of cosine and sine
// where shear rotates with the skin between source and taxel.

vec2 pairOfRows(uint number) { return (number & 1u) == 0 ? spread_rows[number >> 1].xy : spread_rows[number >> 1].zw; }

Spread spreadByList(uint first_taxel, uint t) {
  Spread sum = Spread(0.0, vec2(0));
  for (uint e = 0; e < NUM_ENTRIES; ++e) {
    uint number = e * NUM_TAXELS + t;
    vec2 entry = pairOfRows(number);
    uint source = first_taxel + floatBitsToUint(entry.x);
    if (!SHEAR || !ROTATES_SHEAR) {
      addSource(sum, source, entry.y);
      continue;
    }
    vec2 rotation = pairOfRows(NUM_ENTRIES * NUM_TAXELS + number);
    vec2 shear = vec2(contact_shear[2 * source], contact_shear[2 * source + 1]);
    sum.normal += entry.y * contact_normal[source];
    sum.shear += entry.y * vec2(rotation.x * shear.x - rotation.y * shear.y, rotation.y * shear.x + rotation.x * shear.y);
  }
  return sum;
}
