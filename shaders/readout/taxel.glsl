// Stages 4 and 5 of one taxel: its spread force (N) through lag, gain, curve, noise and saturation to counts, and its share of the sums of
// stage 6.

// One instance, the same for all invocations of its team.
struct Instance {
  uint number, first_taxel;
  vec4 drive;         // InstanceRecord
  uvec4 keys;         // InstanceRecord
  bool new_frame;     // the sensor delivers a frame in this step
  uint step;          // since reset
  float noise_level;  // standard deviation, counts
  ImageWindow window;
  uvec2 origin;  // origin of the moments: the taxel in the middle of the window, so that they are no differences of large numbers
};

Instance loadInstance(uint number) {
  Instance instance;
  instance.number = number;
  instance.first_taxel = number * NUM_TAXELS;
  instance.drive = instanceRecord(number).drive;
  instance.keys = instanceRecord(number).keys;
  instance.new_frame = (instance.keys.w & kFlagNewFrame) != 0;
  instance.noise_level = sqrt(NOISE * NOISE + instance.drive.w * instance.drive.w);
  instance.step = hasState() ? instanceRecord(number).clock.x : 0;
  instance.window = imageWindow(number, READS_AT_REST || hasState() || BIAS > 0.0 || RANDOM && instance.noise_level > 0.0);
  instance.origin = instance.window.first + instance.window.count / 2;
  return instance;
}

// Position in C of a taxel, relative to the origin of the moments, m; its area, m^2.
vec4 chartOf(uvec2 at, uvec2 origin) {
  if (!kOnePatch) return taxels[at.x * kCols + at.y].chart;
  return vec4((vec2(at) - vec2(origin)) * vec2(PITCH_X, PITCH_Y), 0, PITCH_X * PITCH_Y);
}

// The spread forces of a taxel in an instance with a width of the spread of its own: a share of its force stays on it.
Spread narrowed(Instance instance, uint t, uvec2 at, Spread spread) {
  float share = instanceRecord(instance.number).spread.x;
  float kept = (1.0 - share) * (SCALED ? 1.0 / spread_scale[t] : 1.0);
  spread.normal *= share;
  spread.shear *= share;
  if (!kOnePatch || all(lessThan(at - instance.window.contact_first, instance.window.contact_count)))
    addSource(spread, instance.first_taxel + t, kept);
  return spread;
}

// The factor of an instance and a taxel on the trigger.
float triggerFactor(Instance instance, uint t, uvec2 seed) {
  float factor = instanceRecord(instance.number).skin.z, spread = instanceRecord(instance.number).spread.z;
  return spread > 0.0 ? factor * exp(spread * gaussian(seed, instance.keys.xy, 0, t, kPurposeTaxelTrigger)) : factor;
}

// Writes the outputs of one taxel and adds it to the sums.
void readTaxel(Instance instance, Lag lag, uint t, uvec2 at, Spread spread, uvec2 seed, inout ImageSums sums) {
  if (RANDOM_SKIN) spread = narrowed(instance, t, at, spread);
  if (OUTPUT_NORMAL) spread_normal[instance.first_taxel + t] = spread.normal;
  if (SHEAR) {
    spread_shear[2 * (instance.first_taxel + t)] = spread.shear.x;
    spread_shear[2 * (instance.first_taxel + t) + 1] = spread.shear.y;
  }
  vec4 chart = chartOf(at, instance.origin);
  float nominal_trigger = TAXELS_ALIKE ? TRIGGER : taxels[t].readout.y;
  addForce(sums.clean, spread.normal, chart, spread.normal > max(nominal_trigger, 0.0));
  LagState states = statesOf(instance.number, t, instance.step);
  float force = laggedForce(lag, states, spread.normal);
  float drift = 0.0;
  if (RANDOM_WALK)
    drift = updateRandomWalk(states, step_record.time.w * gaussian(seed, instance.keys.xy, instance.step, t, kPurposeRandomWalk));
  if (!instance.new_frame) return;
  float gain = TAXELS_ALIKE ? instance.drive.y : instance.drive.y * taxels[t].readout.x;
  if (RANDOM && instance.drive.z > 0.0) gain *= exp(instance.drive.z * gaussian(seed, instance.keys.xy, 0, t, kPurposeTaxelGain));
  float offset = offsetOf(seed, instance.keys.xy, instance.keys.z, t, instance.noise_level) + drift;
  float trigger = RANDOM_SKIN ? nominal_trigger * triggerFactor(instance, t, seed) : nominal_trigger;
  uint counts = countsOf(force, gain, trigger, offset);
  if (isDead(seed, instance.keys.xy, t)) counts = 0;
  image[instance.first_taxel + t] = counts;
  addForce(sums.measured, nominalForce(counts), chart, counts > 0);
  if (float(counts) >= SATURATION) sums.num_saturated += 1.0;
}

// Stages 3 to 5 of row `i` of the window and, with kRowsAtOnce 2, of the next row if there is one.
void readRows(Instance instance, Kernel kernel, Lag lag, uint i, uvec2 seed, inout ImageSums sums, inout ImageSums next_sums) {
  ImageSums row = noSums(), next_row = noSums();
  uvec2 at = instance.window.first + uvec2(i, 0);
  uint end = at.y + instance.window.count.y;
  Columns columns;
  if (kSliding) startColumns(instance.first_taxel, instance.window, at, columns);
  for (; at.y < end; ++at.y) {
    uint t = at.x * kCols + at.y;
    if (!kOnePatch && t >= NUM_TAXELS) continue;
    if (kSliding) slideColumns(instance.first_taxel, instance.window, at, columns);
    Spread spread;
    if (kSliding) {
      spread = spreadSliding(kernel, columns, 0);
    } else if (kOnePatch) {
      spread = spreadOnGrid(instance.first_taxel, instance.window, ivec2(at));
    } else {
      spread = spreadByList(instance.first_taxel, t);
    }
    readTaxel(instance, lag, t, at, spread, seed, row);
    if (kRowsAtOnce > 1 && i + 1 < instance.window.count.x) {
      readTaxel(instance, lag, t + kCols, at + uvec2(1, 0), spreadSliding(kernel, columns, 1), seed, next_row);
    }
  }
  checkLoop(at.y < end);
  addSums(sums, row);
  addSums(next_sums, next_row);
}
