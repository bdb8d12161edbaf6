// Area sampling of half-spaces, by two quads; of cones, and of cylinders whose ends look up and down, by the facets of a prism or pyramid
// of kSides sides with the same area of every section, so that the outlines of flat ends are exact integrals (depth/area/facets.glsl). It
// deviates by at most 2.1e-4 of the radius.

const uint kSides = 128u;
const float kSideAngle = 6.2831853072 / float(kSides);
const float kSameArea = 1.00020083;  // radius of a polygon over that of a circle of the same area: sqrt(angle / sin(angle))
const float kUpright = 0.7;          // cosine of the axis to z of P, from which a cylinder has facets

bool hasFacets(Solid solid) {
  return isKind(solid.kind, kKindCone) || isKind(solid.kind, kKindCylinder) && abs(solid.X_PO.row2.z) > kUpright;
}

// A point of P in cells of the tile and depth.
vec3 inCells(Tile tile, vec3 p_P) { return vec3((p_P.xy - tile.corner) / tile.spacing - tile.first + 0.5, -p_P.z); }
vec3 inCells(Tile tile, Solid solid, vec3 p) { return inCells(tile, apply(solid.X_PO, p)); }

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
    bool looks_down = facetOf(which == 2u   ? high
                              : which == 3u ? low
                                            : p,
                              which == 0u || which == 3u ? q
                              : which == 1u              ? s
                                                         : r,
                              which < 1u    ? s
                              : which == 1u ? r
                              : which == 2u ? s
                                            : p,
                              facet);
    if (looks_down) addFacet(tile, facet, found);
  }
  checkLoop(i < 4u * kSides);
}

// A half-space under the tile, by two quads that lie one behind the other along the plane's gradient: a ramp from the skin's surface to
// full depth, then what is deeper, down to where the tile sees no further. So no depth exceeds the thickness, however steep the plane is.
// All invocations call it.
void addHalfSpace(inout Tile tile, Solid solid, inout Found found) {
  const float kLeastAcross = 1e-9;
  vec3 normal = vec3(solid.X_PO.row0.z, solid.X_PO.row1.z, solid.X_PO.row2.z),
       at = vec3(solid.X_PO.row0.w, solid.X_PO.row1.w, solid.X_PO.row2.w);
  vec2 half_size = 0.5 * (tile.end - tile.first) * tile.spacing, middle = samplePosition(tile, 0.5 * (tile.first + tile.end - 1.0));
  float slope = length(normal.xy), across = max(slope, kLeastAcross), descent = max(normal.z, kLeastDescent);
  vec2 ahead = slope > kLeastAcross ? normal.xy / slope : vec2(1, 0);
  float inside = dot(middle - at.xy, normal.xy) - normal.z * at.z;  // m, how far the middle of the tile is inside
  // Where along `ahead` the plane is at these depths, within the tile.
  float extent = dot(abs(ahead), half_size);
  vec3 ends = clamp((descent * vec3(0, THICKNESS, -tile.z_floor) - inside) / across, -extent, extent);
  if (NUM_ROWS > 0) ends.z = extent;
  found.below_floor = found.below_floor || ends.z < extent;
  vec2 depths = clamp((inside + across * ends.xy) / descent, 0.0, THICKNESS);
  tile.deepest = THICKNESS;
  vec2 aside = vec2(-ahead.y, ahead.x) * length(half_size);
  for (uint k = 0; k < 4; ++k) {  // two triangles of the ramp, two of full depth
    bool is_ramp = k < 2;
    vec2 from = middle + ahead * (is_ramp ? ends.x : ends.y), to = middle + ahead * (is_ramp ? ends.y : ends.z);
    float from_depth = is_ramp ? depths.x : THICKNESS, to_depth = is_ramp ? depths.y : THICKNESS;
    vec3 p = inCells(tile, vec3(from - aside, -from_depth)), q = inCells(tile, vec3(to + aside, -to_depth));
    vec3 r = (k & 1u) == 0 ? inCells(tile, vec3(from + aside, -from_depth)) : inCells(tile, vec3(to - aside, -to_depth));
    Facet facet;
    if (facetOf(p, (k & 1u) == 0 ? r : q, (k & 1u) == 0 ? q : r, facet)) addLargeFacet(tile, facet, found);
  }
}
