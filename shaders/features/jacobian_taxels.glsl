// One taxel of the tactile Jacobian: its reading (the clean force, or what the readout makes of it before noise). Forces in N.
// Reference: src/reference/tactile_jacobian.cpp.

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
