// Area sampling of half-spaces, by two facets; of cones, and of cylinders whose ends look up and down, by the facets of a prism or pyramid of kSides sides with the same area of every
// section, so that the outlines of flat ends are exact integrals (depth/area/facets.glsl). It deviates by at most 2.1e-4 of the radius.

const uint kSides = 128u;
const float kSideAngle = 6.2831853072 / float(kSides);
const float kSameArea = 1.00020083;    // radius of a polygon over that of a circle of the same area: sqrt(angle / sin(angle))
const float kUpright = 0.7;            // cosine of the axis to z of P, from which a cylinder has facets

bool hasFacets(Solid solid) {
  return isKind(solid.kind, kKindCone) || isKind(solid.kind, kKindCylinder) && abs(solid.X_PO.row2.z) > kUpright;
}

// A point of O in cells of the tile and depth.
vec3 inCells(Tile tile, Solid solid, vec3 p) {
  vec3 p_P = apply(solid.X_PO, p);
  return vec3((p_P.xy - tile.corner) / tile.spacing - tile.first + 0.5, -p_P.z);
}

// All invocations share the facets.
void addRound(Tile tile, Solid solid, inout Found found) {
  bool is_cone = isKind(solid.kind, kKindCone);
  float radius = solid.parameters.x * kSameArea, low_radius = is_cone ? 0.0 : radius;
  float low_z = is_cone ? 0.0 : -solid.parameters.y, high_z = solid.parameters.y;
  vec3 low = inCells(tile, solid, vec3(0, 0, low_z)), high = inCells(tile, solid, vec3(0, 0, high_z));
  uint i = gl_LocalInvocationIndex;
  for (; i < 4u * kSides; i += WORKGROUP) {
    uint which = i / kSides;  // two triangles of the flank, one of each end
    float angle = float(i) * kSideAngle, next = float(i + 1) * kSideAngle;
    vec2 from = vec2(cos(angle), sin(angle)), to = vec2(cos(next), sin(next));
    vec3 p = inCells(tile, solid, vec3(low_radius * from, low_z)), q = inCells(tile, solid, vec3(low_radius * to, low_z));
    vec3 r = inCells(tile, solid, vec3(radius * from, high_z)), s = inCells(tile, solid, vec3(radius * to, high_z));
    Facet facet;
    bool looks_down = facetOf(which == 2u ? high : which == 3u ? low : p, which == 0u || which == 3u ? q : which == 1u ? s : r, which < 1u ? s : which == 1u ? r : which == 2u ? s : p, facet);
    if (NUM_ROWS == 0) found.below_floor = found.below_floor || looks_down && deepestOf(facet) > -tile.z_floor;
    if (looks_down) addFacet(tile, facet, found);
  }
  checkLoop(i < 4u * kSides);
}

// The plane over the whole tile. Tile::deepest becomes its largest depth.
void addHalfSpace(inout Tile tile, Solid solid, inout Found found) {
  const float kSteepest = 1e-6;  // |normal.z|
  vec3 normal = vec3(solid.X_PO.row0.z, solid.X_PO.row1.z, solid.X_PO.row2.z), at = vec3(solid.X_PO.row0.w, solid.X_PO.row1.w, solid.X_PO.row2.w);
  vec3 corners[4];
  tile.deepest = kLeastDepth;
  for (uint k = 0; k < 4; ++k) {
    vec2 cell = vec2(tile.size * SAMPLES) * vec2(k >> 1, k == 1 || k == 2);
    vec2 off = samplePosition(tile, tile.first + cell - 0.5) - at.xy;
    // A half-space that does not look down has no lowest surface: it is deeper than the skin everywhere.
    float depth = normal.z < -kSteepest ? -at.z + dot(off, normal.xy) / normal.z : 2.0 * THICKNESS;
    corners[k] = vec3(cell, depth);
    tile.deepest = max(tile.deepest, depth);
  }
  for (uint k = 0; k < 2; ++k) {
    Facet facet;
    if (facetOf(corners[0], corners[1 + k], corners[2 + k], facet)) addLargeFacet(tile, facet, found);
    if (NUM_ROWS == 0) found.below_floor = found.below_floor || deepestOf(facet) > -tile.z_floor;
  }
}
