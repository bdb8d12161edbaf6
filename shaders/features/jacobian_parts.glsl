// Parts of an instance, of which tactile_jacobian.comp computes one row of derivatives each: the sensor and its patches (none of a list of
// taxels). The planes of their moments are in shared/model.h. Lengths in m.

const bool kOnePatch = PATCHES == 1;  // its row equals the sensor's, and is not computed apart
const uint kRows = 1 + PATCHES;
const uint kParts = kOnePatch ? 1u : kRows;

// The taxels of one row of an instance: the sensor's or a patch's.
struct Part {
  uint instance;
  uint first, end;  // range of its taxels
  uint plane;
  bool is_grid;  // the taxels are those of the plane's grid; else their positions are in S
  vec2 pitch;    // pitch of the plane
  vec2 size;     // rows and columns of the grid
  vec2 gains;    // factor on all gains of the instance, their spread between taxels
  uvec2 keys;    // keys of the instance for random numbers
  vec2 readout;  // gain; trigger, N, of the first taxel
};

// Part `number` (< kParts) of an instance; empty if it is not due.
Part loadPart(uint instance, uint number, bool is_due) {
  uint plane = kOnePatch ? 0 : number == 0 ? LAST_PLANE : number - 1;
  uvec4 grid = planeRecord(plane).grid;
  bool is_grid = kOnePatch || number > 0;
  uint first = number > 0 ? grid.z : 0;
  uint end = number > 0 ? grid.z + grid.x * grid.y : NUM_TAXELS;
  return Part(instance, first, is_due ? end : first, plane, is_grid, planeRecord(plane).pitch.xy, vec2(grid.xy),
              instanceRecord(instance).drive.yz, instanceRecord(instance).keys.xy, taxels[0].readout.xy);
}

// Position of the taxel in a row and a column of the plane's grid in C, m.
vec3 positionInGrid(Part part, vec2 at) { return vec3((at - 0.5 * (part.size - 1.0)) * part.pitch, 0); }

// Position of a taxel in C, m.
vec3 positionOf(Part part, uint t) {
  if (kOnePatch || part.is_grid) {
    // As in features/contact_parts.glsl.
    float number = float(t - part.first);
    float i = floor((number + 0.5) / part.size.y);
    return positionInGrid(part, vec2(i, number - i * part.size.y));
  }
  return taxels[t].chart.xyz;
}

// ---- readings of taxels, with the clean force or the readout before noise; forces in N ----

// A taxel's force as the features count it, N, and its derivative by the spread force.
vec2 readingOf(Part part, uint t) {
  float force = floatOfFours(SpreadNormal, part.instance * NUM_TAXELS + t);
  if (CLEAN) return vec2(force, 1);
  uvec2 seed = step_record.batch.zw;
  vec2 readout = part.readout;
  if (!SAME_READOUT) readout = taxels[t].readout.xy;
  float gain = part.gains.x * readout.x;
  if (RANDOM && part.gains.y > 0.0) gain *= exp(part.gains.y * gaussian(seed, part.keys, 0, t, kPurposeTaxelGain));
  float trigger = readout.y, x = gain * force - trigger;
  if (isDead(seed, part.keys, t)) return vec2(0);
  // Without a trigger, forces of 0 change too: a contact may be about to cross the taxel's side.
  bool follows = (x > 0.0 || trigger <= 0.0) && x < SATURATION_FORCE;
  return vec2(x > 0.0 ? min(x, SATURATION_FORCE) + TRIGGER : 0.0, follows ? gain : 0.0);
}
