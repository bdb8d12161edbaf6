// Stage 4: what the readout makes of a taxel's force over time. include/taxelsim/sensor.h, Readout. Twin: src/reference/lag.cpp.
//
// States of a taxel, NUM_TAXELS apart: one of each hysteresis element and creep term, of the low-pass and of the random walk where there are such, then
// the ring of forces of the delay. In the first step since reset they count as 0: a sensor long unloaded.
//
//   spread force -> hysteresis -> creep -> low-pass -> ring -> force that a frame shows

// Parameters, fetched once.
vec4 hysteresis_strength, hysteresis_width, creep_fraction, creep_share;

// A function: glslang 12 orders long constant expressions so that the module is invalid.
uint numStates() {
  return NUM_HYSTERESIS + NUM_CREEP + uint(LOW_PASS) + uint(RANDOM_WALK) + (DELAY ? kMaxDelaySteps : 0u);
}

bool hasState() { return numStates() > 0; }

void loadLag() {
  if (NUM_HYSTERESIS > 0) {
    hysteresis_strength = sensor.hysteresis_strength;
    hysteresis_width = sensor.hysteresis_width;
  }
  if (NUM_CREEP > 0) {
    creep_fraction = sensor.creep_fraction;
    creep_share = step_record.creep;
  }
}

// Where a taxel's states are, and how long they have been.
struct TaxelTime {
  uint first;  // in taxel_states
  uint step;   // since reset
};

uint stateAt(TaxelTime of, uint number) { return of.first + number * NUM_TAXELS; }

float stateBefore(TaxelTime of, uint number) { return of.step == 0 ? 0.0 : taxel_states[stateAt(of, number)]; }

// Moves a first-order state towards x, which is held over the step, by the exact share of the way.
float approach(TaxelTime of, uint number, float x, float share) {
  float before = stateBefore(of, number);
  float after = before + share * (x - before);
  taxel_states[stateAt(of, number)] = after;
  return after;
}

// Prandtl and Ishlinskii: a play element follows x at a distance of at most its width.
float hysteresis(TaxelTime of, float x) {
  float y = x;
  for (uint e = 0; e < NUM_HYSTERESIS; ++e) {
    float width = hysteresis_width[e];
    float play = max(x - width, min(x + width, stateBefore(of, e)));
    taxel_states[stateAt(of, e)] = play;
    y += hysteresis_strength[e] * (play - x);
  }
  return y;
}

float creep(TaxelTime of, float x) {
  float y = x;
  for (uint m = 0; m < NUM_CREEP; ++m) y += creep_fraction[m] * approach(of, NUM_HYSTERESIS + m, x, creep_share[m]);
  return y;
}

// The oldest force leaves the ring as the newest enters, so the read comes first.
float delayed(TaxelTime of, float x) {
  const uint kRing = numStates() - kMaxDelaySteps;
  uint slot = step_record.delay.x, back = step_record.delay.y;
  float then = x;
  if (back > 0) then = of.step < back ? 0.0 : taxel_states[stateAt(of, kRing + (slot - back) % kMaxDelaySteps)];
  taxel_states[stateAt(of, kRing + slot)] = x;
  return then;
}

// The force that a frame of this step shows.
float lagged(TaxelTime of, float spread_force) {
  float force = creep(of, hysteresis(of, spread_force));
  if (LOW_PASS) force = approach(of, NUM_HYSTERESIS + NUM_CREEP, force, step_record.time.z);
  if (DELAY) force = delayed(of, force);
  return force;
}

// Counts that a taxel's offset has drifted by since reset.
float drifted(TaxelTime of, float increment) {
  const uint kWalk = NUM_HYSTERESIS + NUM_CREEP + uint(LOW_PASS);
  float offset = stateBefore(of, kWalk) + increment;
  taxel_states[stateAt(of, kWalk)] = offset;
  return offset;
}
