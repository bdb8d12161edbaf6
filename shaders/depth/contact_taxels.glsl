// The taxel that a contact point belongs to, by the rule of include/taxelsim/contact_point.h. Lengths in m; points p_SQ_S in S. `band`:
// height over the skin up to which contacts count. Reference: src/reference/contact_points.cpp.

const float kRimTolerance = 1e-6;  // m, include/taxelsim/contact_point.h
const uint kNoCell = 0xFFFFFFFFu;
const bool kTaxelList = NUM_PATCHES > 1 && NUM_PATCHES == NUM_TAXELS;  // taxels with poses of their own

struct Patch {
  Affine X_PS;
  uvec2 size;  // rows, cols
  uint first_taxel;
  vec2 pitch;  // m
};

Patch patchAt(uint p) {
  Patch loaded;
  loaded.X_PS = Affine(vec4(1, 0, 0, 0), vec4(0, 1, 0, 0), vec4(0, 0, 1, 0));
  if (!FLAT) loaded.X_PS = Affine(patchRecord(p).row0, patchRecord(p).row1, patchRecord(p).row2);
  loaded.size = uvec2(NUM_ROWS, NUM_COLS);
  loaded.first_taxel = 0;
  loaded.pitch = vec2(PITCH_X, PITCH_Y);
  if (NUM_ROWS == 0) {
    loaded.size = patchRecord(p).grid.xy;
    loaded.first_taxel = patchRecord(p).grid.z;
    loaded.pitch = patchRecord(p).spacing.xy * float(SAMPLES);
  }
  return loaded;
}

// Cell of x, m from the middle of a row of `count` cells; kNoCell outside the row.
//
//      cell 0        cell 1               cell count - 1
//   [- - - - - -)[- - - - - -)    ...   [- - - - - - - -]
//
// Drivers round the quotient differently; the borders are products, which all drivers round the same, and decide.
uint cellOf(float x, uint count, float pitch) {
  float middle = 0.5 * float(count);
  if (!(abs(x) <= middle * pitch + kRimTolerance)) return kNoCell;
  float cell = floor(x / pitch + middle);
  if (x < (cell - middle) * pitch) {
    cell -= 1.0;
  } else if (x >= (cell + 1.0 - middle) * pitch) {
    cell += 1.0;
  }
  return uint(clamp(cell, 0.0, float(count) - 1.0));
}

// The taxel that carries a contact.
struct ContactTaxel {
  uint taxel;   // index in the sensor; kNoCell: none
  uvec2 cell;   // row and column in its patch
  vec3 normal;  // z of the patch in S
};

ContactTaxel taxelOn(Patch on, vec3 p_SQ_S, float band) {
  vec3 p_PQ_P = p_SQ_S;
  if (!FLAT) p_PQ_P = apply(on.X_PS, p_SQ_S);
  uvec2 cell = uvec2(cellOf(p_PQ_P.x, on.size.x, on.pitch.x), cellOf(p_PQ_P.y, on.size.y, on.pitch.y));
  bool inside = cell.x != kNoCell && cell.y != kNoCell && p_PQ_P.z >= -THICKNESS && p_PQ_P.z <= band;
  return ContactTaxel(inside ? on.first_taxel + cell.x * on.size.y + cell.y : kNoCell, cell, on.X_PS.row2.xyz);
}

// On a list of taxels: the taxel whose rectangle has the contact nearest to its middle.
ContactTaxel taxelInList(vec3 p_SQ_S, float band) {
  ContactTaxel at = ContactTaxel(kNoCell, uvec2(0), vec3(0));
  float least = 0.5;  // squared distance in pitches; this is the ellipse through the corners
  uint t = 0;
  for (; t < NUM_PATCHES; ++t) {
    Patch on = patchAt(t);
    vec3 p_PQ_P = apply(on.X_PS, p_SQ_S);
    vec2 off = p_PQ_P.xy / on.pitch;
    float away = dot(off, off);
    if (p_PQ_P.z < -THICKNESS || p_PQ_P.z > band || !(away < least)) continue;
    least = away;
    at = ContactTaxel(t, uvec2(0), on.X_PS.row2.xyz);
  }
  checkLoop(t < NUM_PATCHES);
  return at;
}

// On grid patches: the first patch whose volume holds the contact.
ContactTaxel taxelOnPatches(Patch first_patch, vec3 p_SQ_S, float band) {
  ContactTaxel at = taxelOn(first_patch, p_SQ_S, band);
  uint p = 1;
  for (; p < NUM_PATCHES && at.taxel == kNoCell; ++p) at = taxelOn(patchAt(p), p_SQ_S, band);
  checkLoop((p < NUM_PATCHES && at.taxel == kNoCell));
  return at;
}
