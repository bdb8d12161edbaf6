// Parts of an instance, of which contact_features.comp computes one row of features each: the sensor, its patches (none of a list of
// taxels), its regions. The planes of their moments are in shared/model.h. Lengths in m.

const bool kList = PATCHES == 0;      // taxels with positions of their own
const bool kOnePatch = PATCHES == 1;  // its row equals the sensor's, and is not computed apart
const uint kRows = 1 + PATCHES + REGIONS;
const uint kFirstRegion = kOnePatch ? 1u : 1u + PATCHES;  // among the parts that are computed
const uint kParts = kFirstRegion + REGIONS;

// The record of a taxel, shared/model.h.
const uint kFoursOfTaxel = 3u;
vec4 chartOf(uint t) { return floatsOfFour(Taxels, kFoursOfTaxel * t); }
vec4 readoutOf(uint t) { return floatsOfFour(Taxels, kFoursOfTaxel * t + 1u); }
vec4 receptionOf(uint t) { return floatsOfFour(Taxels, kFoursOfTaxel * t + 2u); }

// Whether a taxel of this force reports; `trigger`: N, of clean forces. Agrees with taxel_regions, without reading them.
bool reportsForce(float force, float trigger) { return force > (is_clean ? trigger : 0.0); }

// The taxels of one row of an instance: the sensor's, a patch's or a region's.
struct Part {
  uint first_four;  // index of the instance in forces[] and taxel_regions[]
  uint first, end;  // range that holds its taxels
  uint region;      // its taxels are those of this region; kNoRegion: all in the range
  uint plane;
  bool is_grid;    // the taxels are those of the plane's grid; else their positions are in S
  vec4 pitch;      // pitch of the plane
  vec2 size;       // rows and columns of the grid
  float per_col;   // 1 / columns
  vec3 per_pitch;  // 1 / pitch
};

// Whether the first region has all forces of its instance: its row then has the values of the sensor's, except for the type, and is not
// computed apart.
bool hasOnlyRegion(uint instance) { return kOnePatch && REGIONS > 0 && (regions[instance * REGIONS] & kOnlyRegion) != 0; }

// Part `number` (< kParts) of an instance; empty if it is not due or its region does not exist.
Part loadPart(uint instance, uint number, bool is_due) {
  uint plane = kOnePatch ? 0 : LAST_PLANE;
  uint first = 0, end = NUM_TAXELS, region = kNoRegion;
  bool is_grid = kOnePatch;
  if (number >= kFirstRegion) {
    if (is_due) region = regions[instance * REGIONS + number - kFirstRegion];
    if (region == kNoRegion) end = 0;
  }
  if (!kOnePatch && !kList && number > 0 && end > 0) {
    plane = number < kFirstRegion ? number - 1 : uint(readoutOf(region).z);
    uvec4 grid = planeRecord(plane).grid;
    first = grid.z;
    end = grid.z + grid.x * grid.y;
    is_grid = true;
  }
  if (!is_due) end = 0;
  vec4 pitch = planeRecord(plane).pitch;
  vec2 size = vec2(planeRecord(plane).grid.xy);
  return Part(instance * kTaxelFours, first, end, region, plane, is_grid, pitch, size, 1.0 / size.y, 1.0 / pitch.xyz);
}

// Whether a taxel of the part's range is one of its taxels. `word`: its word in taxel_regions.
bool isOfRegion(Part part, uint word) { return REGIONS == 0 || part.region == kNoRegion || (word & kNoRegion) == part.region; }

// A position in the frame of `taxels`, in C.
vec3 inPlane(Part part, vec3 p) {
  if (kOnePatch || part.plane == LAST_PLANE) return p;
  PlaneRecord plane = planeRecord(part.plane);
  vec3 d = p - vec3(plane.X_SC_row0.w, plane.X_SC_row1.w, plane.X_SC_row2.w);
  return plane.X_SC_row0.xyz * d.x + plane.X_SC_row1.xyz * d.y + plane.X_SC_row2.xyz * d.z;
}

// Position of a taxel in C, m.
vec3 positionOf(Part part, uint t) {
  if (kOnePatch || part.is_grid) {
    // The row by a float multiplication instead of a division (driver/README.md). It is half a taxel from the next row, far more than
    // rounding.
    float number = float(t - part.first);
    float i = floor((number + 0.5) * part.per_col);
    return vec3((vec2(i, number - i * part.size.y) - 0.5 * (part.size - 1.0)) * part.pitch.xy, 0);
  }
  return inPlane(part, chartOf(t).xyz);
}

// Mean position of the force that a taxel receives, in C, m. `reception`: receptionOf(t).
vec3 receptionPosition(Part part, uint t, vec4 reception) { return inPlane(part, vec3(reception.xy, kOnePatch ? 0.0 : readoutOf(t).w)); }
