#version 460
#extension GL_GOOGLE_include_directive : require
// Load search pass, over all tiles of a sensor: computes the next offset after each evaluation by the contact pass. For sensors that are
// not one tile in a plane z = const of S; on those contact.comp searches by itself.
//
// The load is the force of the objects along -z of S, without friction. That force falls as the offset grows: the bracket's lower bound
// carries too much (or sinks deeper than the skin), its upper bound too little. Regula falsi alternates with bisection; with area sampling
// the force is a continuous function with a slope, and Newton's method replaces both once the object touches. A float resolves an offset of
// 0.1 m to 7e-9 m, 7e-5 of a depth of 0.1 mm: once the bracket is a few of these steps wide, the offset stays and its rest is searched,
// LoadRecord. An invocation owns one instance.
// In:  tile_results (num_instances x num_tiles): the forces at the offset that was tried.
// Out: loads (num_instances): the next offset, or that the search has ended.
// Shared memory: none.
// Deterministic: tiles are summed in order.
// Reference: src/reference/load.cpp.

#include "passes/declare.glsl"
#include "passes/load.h"

const float kTolerance = 1e-6;      // share of the load; some ten roundings of a float
const float kAccepted = 1e-3;       // share of the load, when the bracket is as narrow as floats allow
const float kDeeper = 1e30;         // stands for the force at an offset at which a sample is deeper than the skin
const float kCoarse = 3e-8;         // m: width of the bracket where the search of the rest begins
const float kFine = 1e-12;          // m: width of the bracket where it ends
const float kRestBracket = 1.5e-7;  // m: half of its width where Newton's method begins it
const float kNoStep = 1e30;         // m
const float kNewtonSteps = 20.0;    // evaluations, after which the bracket is narrowed without slopes

#include "common/instances.glsl"

// Whether a bracket is at most `width` wide, or as narrow as floats allow.
bool isNarrow(vec4 bracket, float width) {
  float low = bracket.y, high = bracket.z, middle = 0.5 * (low + high);
  return high - low <= width || middle == low || middle == high;
}

// Sums over the tiles of an instance at the offset that was tried.
struct Tried {
  float force, slope;  // along -z of S, N, and by the depth, N/m
  bool too_deep;
};

Tried sumOfTiles(uint instance) {
  Tried tried = Tried(0.0, 0.0, false);
  float deep = 0.0;
  uint behind = 0;
  for (uint t = 0; t < NUM_TILES; ++t) {
    TileResult result = tileResult(instance * NUM_TILES + t);
    tried.force -= result.force.z;
    deep += result.force.w;
    if (NEWTON) tried.slope += result.torque.w;
    if (NUM_ROWS == 0) behind |= result.window.x;
  }
  // Surfaces below the floor and no force: the search has passed through the body.
  tried.too_deep = deep > 0.0 || (tried.force == 0.0 && behind > 0);
  return tried;
}

// Moves one end of the bracket to `at`, the offset or the rest that was tried.
void narrow(inout LoadRecord record, Tried tried, float at, float load) {
  if (tried.too_deep || tried.force > load) {
    record.bracket.y = at;
    record.forces.x = tried.too_deep ? kDeeper : tried.force;
  } else {
    record.bracket.z = at;
    record.forces.y = tried.force;
  }
}

// The next offset, or the next rest, inside of the bracket. `at`: the one that was tried; `newton`: the step of Newton's method.
float nextAfter(LoadRecord record, Tried tried, float at, float newton, float load) {
  float low = record.bracket.y, high = record.bracket.z, f_low = record.forces.x, f_high = record.forces.y, evaluations = record.forces.w;
  if (NEWTON && evaluations < kNewtonSteps) {
    // From above, in growing steps until the object touches. Newton's method approaches from below; from above it may go far too deep.
    float step = tried.force > 0.0 || tried.too_deep ? max(newton, -FIRST_STEP) : -FIRST_STEP * exp2(evaluations - 1.0);
    if (at + step > low && at + step < high) return at + step;
  }
  if (f_low < kDeeper && f_high > 0.0 && mod(evaluations, 2.0) != 0.0) {
    return clamp(low + (high - low) * (f_low - load) / (f_low - f_high), low, high);
  }
  return 0.5 * (low + high);
}

void main() {
  uint instance = workgroupNumber() * WORKGROUP + gl_LocalInvocationIndex;
  if (!isProcessed(instance)) return;
  LoadRecord record = loads[instance];
  float status = record.bracket.w;
  if ((instanceRecord(instance).keys.w & kFlagLoadDriven) == 0) {
    loads[instance].bracket.w = kLoadCarried;  // driven by its pose: one evaluation suffices
    return;
  }
  if (status == kLoadCarried || status == kLoadOutOfReach) return;
  bool refining = status == kLoadRefining;
  if (status != kLoadSearching && !refining) {
    loads[instance].bracket.w = status == kLoadClosingCarried ? kLoadCarried : kLoadOutOfReach;
    return;
  }

  Tried tried = sumOfTiles(instance);
  float load = instanceRecord(instance).drive.x, at = refining ? record.forces.z : record.bracket.x;
  record.forces.w += 1.0;
  if (!tried.too_deep && load > 0.0 && abs(tried.force - load) <= kTolerance * load) {
    loads[instance].bracket.w = kLoadCarried;
    return;
  }
  narrow(record, tried, at, load);
  float newton = tried.slope > 0.0 && !tried.too_deep ? (tried.force - load) / tried.slope : kNoStep;
  if (NEWTON && !refining && load > 0.0 && abs(newton) < kCoarse) {
    // The rest counts from the offset that was tried, in a bracket that allows for a slope that is wrong by half an order of magnitude.
    refining = true;
    at = 0.0;
    record.bracket = vec4(record.bracket.x, -kRestBracket, kRestBracket, kLoadRefining);
    record.forces.xy = vec2(kDeeper, 0.0);
  }
  if (!refining && load > 0.0 && record.forces.x < kDeeper && isNarrow(record.bracket, kCoarse)) {
    refining = true;
    record.bracket = vec4(record.bracket.z, 2.0 * (record.bracket.y - record.bracket.z), 0.0, kLoadRefining);
  }
  float next = nextAfter(record, tried, at, newton, load);
  if (record.forces.w + 1.0 >= float(EVALUATIONS) || isNarrow(record.bracket, refining ? kFine : 0.0)) {
    // At the upper bound the skin carries slightly less than the load, or far less if the load would need a sample deeper than the skin.
    next = record.bracket.z;
    record.bracket.w = record.forces.y >= load * (1.0 - kAccepted) ? kLoadClosingCarried : kLoadClosingOutOfReach;
  }
  if (refining) {
    record.forces.z = next;
  } else {
    record.bracket.x = next;
  }
  loads[instance] = record;
}
