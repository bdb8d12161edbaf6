// Stage 4: how the readout changes a taxel's force (N) over time. include/taxelsim/sensor.h, Readout. Reference: src/reference/lag.cpp.
//
//   spread force -> hysteresis -> creep -> low-pass -> delay ring -> force that a frame shows
//
// States of a taxel in taxel_states, NUM_TAXELS apart: one per hysteresis element and creep term, one of the low-pass and one of the random
// walk if they are on, then the ring of forces of the delay. In the first step since reset all count as 0: a sensor long unloaded.

struct Lag {
  vec4 hysteresis_strength, hysteresis_width;  // per element; width in N
  vec4 creep_fraction;                         // per term
  vec4 creep_share;                            // per term: share of the way to its end in this step
};

// A function: glslang 12 orders long constant expressions so that the module is invalid.
uint numStates() { return NUM_HYSTERESIS + NUM_CREEP + uint(LOW_PASS) + uint(RANDOM_WALK) + (DELAY ? kMaxDelaySteps : 0u); }

bool hasState() { return numStates() > 0; }

Lag loadLag() {
  Lag lag = Lag(vec4(0), vec4(0), vec4(0), vec4(0));
  if (NUM_HYSTERESIS > 0) {
    lag.hysteresis_strength = sensor.hysteresis_strength;
    lag.hysteresis_width = sensor.hysteresis_width;
  }
  if (NUM_CREEP > 0) {
    lag.creep_fraction = sensor.creep_fraction;
    lag.creep_share = step_record.creep;
  }
  return lag;
}

struct LagState {
  uint first;        // index in taxel_states
  uint step;         // since reset
  uint back;         // steps back to the force that a frame shows
  float hysteresis;  // the instance's factor on hysteresis
};

LagState statesOf(uint instance, uint t, uint step) {
  uint back = RANDOM_SKIN ? instanceRecord(instance).clock.y : step_record.delay.y;
  return LagState(instance * numStates() * NUM_TAXELS + t, step, back, RANDOM_SKIN ? instanceRecord(instance).skin.w : 1.0);
}

uint stateIndex(LagState states, uint number) { return states.first + number * NUM_TAXELS; }

// Values that the step before has stored. An invocation fetches a state of a taxel before it stores that state, and no other invocation
// stores it.
float pastState(LagState states, uint number) { return floatOfFours(PastTaxelStates, stateIndex(states, number)); }

float stateBefore(LagState states, uint number) { return states.step == 0 ? 0.0 : pastState(states, number); }

// Moves a first-order state towards x, constant over the step, by the exact share of the way.
float approach(LagState states, uint number, float x, float share) {
  float before = stateBefore(states, number);
  float after = before + share * (x - before);
  taxel_states[stateIndex(states, number)] = after;
  return after;
}

// Prandtl-Ishlinskii model: a play element follows x at a distance of at most its width.
float hysteresis(Lag lag, LagState states, float x) {
  float y = x;
  for (uint e = 0; e < NUM_HYSTERESIS; ++e) {
    float width = lag.hysteresis_width[e];
    float play = max(x - width, min(x + width, stateBefore(states, e)));
    taxel_states[stateIndex(states, e)] = play;
    y += (RANDOM_SKIN ? states.hysteresis : 1.0) * lag.hysteresis_strength[e] * (play - x);
  }
  return y;
}

float creep(Lag lag, LagState states, float x) {
  float y = x;
  for (uint m = 0; m < NUM_CREEP; ++m) y += lag.creep_fraction[m] * approach(states, NUM_HYSTERESIS + m, x, lag.creep_share[m]);
  return y;
}

// The newest force takes the place of the oldest in the ring, so the read comes first.
float delayed(LagState states, float x) {
  const uint kRing = numStates() - kMaxDelaySteps;
  uint slot = step_record.delay.x, back = states.back;
  float then = x;
  if (back > 0) then = states.step < back ? 0.0 : pastState(states, kRing + (slot - back) % kMaxDelaySteps);
  taxel_states[stateIndex(states, kRing + slot)] = x;
  return then;
}

// The force that a frame of this step shows, N.
float laggedForce(Lag lag, LagState states, float spread_force) {
  float force = creep(lag, states, hysteresis(lag, states, spread_force));
  if (LOW_PASS) force = approach(states, NUM_HYSTERESIS + NUM_CREEP, force, step_record.time.z);
  if (DELAY) force = delayed(states, force);
  return force;
}

// Adds `increment` to the random walk of a taxel's offset; returns the offset, counts.
float updateRandomWalk(LagState states, float increment) {
  const uint kWalk = NUM_HYSTERESIS + NUM_CREEP + uint(LOW_PASS);
  float offset = stateBefore(states, kWalk) + increment;
  taxel_states[stateIndex(states, kWalk)] = offset;
  return offset;
}
