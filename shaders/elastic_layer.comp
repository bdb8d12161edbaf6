#version 460
#extension GL_GOOGLE_include_directive : require
// Elastic layer: stage 2 (contact law) of one frame for the law `elastic_layer`, its load search, its shear and its relaxation.
//
//   w = A p;   w = d where p > 0,   w >= d where p = 0;      d = target + shift
//
// by conjugate gradients over the nodes in contact, which are found along the way: a step that would pull a node lets go of it, a node that would be
// penetrated is pressed (Polonsky and Keer, Wear 231 (1999) 206). An instance that is driven by its pose has shift 0 and the signed overlap as target; of one
// that is driven by load the target is the shape of the surface below its lowest point, the shift its depth, and pressures are scaled so that their sum is
// the load in every iteration. Displacements are in thicknesses; pressures are what they would move their own cell by, so that A has ones on its diagonal.
//
// A workgroup owns an instance. Nodes come in strips of kStrip along a row; only those of the window are touched, where there is something to
// follow. An invocation owns strips. What costs is A t: a strip of sources and a strip of results need kStrip^2 products, but only 2 kStrip - 1
// coefficients, since A depends on the distance alone, and half of them are at hand from the strip before.
// In:  heights (num_instances x num_nodes), m, with slots in their lowest bits where depth/slots.glsl keeps them, and windows (num_instances x
//      NUM_HEIGHT_TILES) from the contact pass; influence (rows x 2 rows of strips); with friction what the objects did (num_instances x num_slots).
// Out: contact_normal (num_instances x num_taxels), N; contact_shear (num_instances x num_taxels x 2), N; contact_depth; tile_results (num_instances); loads;
//      features of the solution; where asked for how forces change with the sensor's twist: taxel_jacobian (num_instances x 6 x num_taxels), N/m and
//      N/rad, and wrench_jacobian (num_instances x 6 x 6); and the pressures, from which the next frame starts.
// State: where the skin relaxes strain and overstresses of every node, elastic_layer/relaxation.glsl; where there is friction its shear traction.
// Shared memory: 16 LANES + 12 NODE_ROWS + 16 bytes, with friction 8 LANES and 512 more.
// Deterministic: sums run over LANES partial sums in a fixed order, whatever the size of the workgroup.
// Twins: src/reference/elastic_layer.cpp, relaxation.cpp, friction.cpp.

#include "driver/pairs.glsl"
#include "driver/barrier.glsl"
#include "driver/texels.glsl"
#include "shared/batch.h"
#include "shared/elastic_layer.h"
#include "shared/features.h"
#include "shared/sensor.h"
#include "passes/declare.glsl"
#include "passes/elastic_layer.h"

const uint kStripPairs = kStrip / 2;
const uint kRowStrips = (NODE_COLS + kStrip - 1) / kStrip;
const uint kArrayPairs = NODE_ROWS * kRowStrips * kStripPairs;
const float kMiss = kNoHeight;  // height where there is no surface
const float kNever = -kMiss;      // target of a node that cannot be touched
const bool kShears = FRICTION;
const uint kLayerArrays = kNumLayerArrays + (RELAXATION > 0 ? 1 + RELAXATION : 0);

shared vec4 partial[LANES];
// Strips of the window, and those that have sources: by row the first and the end, and of the rows that have any the first and the end.
shared uint window_first[NODE_ROWS];
shared uint source_first[NODE_ROWS], source_end[NODE_ROWS];
shared uint source_rows[2];
shared uint widest;
shared uint num_deep;

bool cut_short = false;  // see contact.comp

#include "common/whole.glsl"
#include "common/workgroup.glsl"
#include "common/transform.glsl"
#include "depth/slots.glsl"

const bool FLAT = false;  // the patch's frame may be any
Affine X_PS;              // patch from sensor

#include "skin/friction.glsl"

vec2 tractionAfter(inout vec2 held, vec2 u, float share, float pressure) { return held = springTraction(held, u, share, pressure); }

#include "elastic_layer/strips.glsl"
#include "elastic_layer/solver.glsl"
#include "skin/skin_step.glsl"
#include "elastic_layer/relaxation.glsl"

float node_force;  // of a node under the pressure 1 of the solution, N

// ---- from heights to targets, from pressures to forces ----

// The surface over the nodes of an instance.
struct Surface {
  uint first_height;
  uvec4 reached;  // by the contact pass: rows, cols, half-open; all 0 for nothing
  float origin;   // that overlaps count from, m
};

// Heights over a strip, kMiss outside the nodes and outside what was reached.
Strip heightsOver(Surface surface, uvec2 at) {
  Strip h = strip(kMiss);
  if (at.x < surface.reached.x || at.x >= surface.reached.y) return h;
  for (uint c = 0; c < kStrip; ++c) {
    uint col = at.y * kStrip + c;
    float height = kMiss;
    if (col >= surface.reached.z && col < surface.reached.w) height = withoutSlot(heights[surface.first_height + at.x * NODE_COLS + col]);
    if (c < 4) h.low[c] = height; else h.high[c - 4] = height;
  }
  return h;
}

uvec4 reachedNodes(uint instance) {
  uvec4 reached = uvec4(NODE_ROWS, 0, NODE_COLS, 0);
  for (uint t = 0; t < NUM_HEIGHT_TILES; ++t) {
    uvec4 tile = windows[instance * NUM_HEIGHT_TILES + t].window;
    if (tile.x >= tile.y) continue;
    reached = uvec4(min(reached.x, tile.x), max(reached.y, tile.y), min(reached.z, tile.z), max(reached.w, tile.w));
  }
  return reached.x < reached.y ? reached : uvec4(0);
}

// The lowest height, m; kMiss if there is none. Over the window.
float lowestHeight(Surface surface) {
  for (uint v = gl_LocalInvocationIndex; v < num_parts; v += WORKGROUP) {
    float highest = -kMiss;
    uint k = v;
    for (; k < num_strips; k += LANES) highest = max(highest, largestOf(scaled(heightsOver(surface, stripAt(k)), -1.0)));
    cut_short = cut_short || k < num_strips;
    partial[v] = vec4(highest);
  }
  return -largestOfPartials(num_parts);
}

// How deep below the origin the surface is, thicknesses, at most 1: deeper the skin is not pressed.
vec4 overlapOf(Surface surface, vec4 height) { return min((surface.origin - height) / THICKNESS, 1.0); }
Strip overlapsOver(Surface surface, uvec2 at) {
  Strip h = heightsOver(surface, at);
  return Strip(overlapOf(surface, h.low), overlapOf(surface, h.high));
}
float overlapAt(Surface surface, uvec2 node) {
  return overlapOf(surface, vec4(withoutSlot(heights[surface.first_height + node.x * NODE_COLS + node.y]))).x;
}

vec4 aboveOrNever(vec4 target, float limit) { return mix(vec4(kNever), target, greaterThan(target, vec4(limit))); }

// A strip of the window has this target, but kNever from `limit` down; what is left of it is a source.
void setTarget(uvec2 at, Strip target, float limit) {
  target = Strip(aboveOrNever(target.low, limit), aboveOrNever(target.high, limit));
  writeStrip(kLayerTarget, at, target);
  if (largestOf(target) > kNever) addSource(at);
}

// The window shrinks to the sources. Strips from `end` on have no targets.
void shrinkWindow(uint end) {
  meet();
  uvec2 rows = uvec2(source_rows[0], source_rows[1]);
  for (uint row = rows.x + gl_LocalInvocationIndex; row < rows.y; row += WORKGROUP) {
    if (source_first[row] < source_end[row]) atomicMax(widest, source_end[row] - source_first[row]);
  }
  meet();
  uint width = widest;
  for (uint row = rows.x + gl_LocalInvocationIndex; row < rows.y; row += WORKGROUP) {
    window_first[row] = min(source_first[row], end - width);
  }
  setWindow(uvec2(rows.x, max(rows.y, rows.x) - rows.x), width);
  meet();
}

// Targets of what was reached are its overlaps; kNever from `limit` down, where the window ends.
void aim(Surface surface, float limit) {
  uint end = surface.reached.z / kStrip + window_width;
  clearSources();
  uint k = gl_LocalInvocationIndex;
  for (; k < num_strips; k += WORKGROUP) setTarget(stripAt(k), overlapsOver(surface, stripAt(k)), limit);
  cut_short = cut_short || k < num_strips;
  shrinkWindow(end);
}

// The same with the targets there are.
void narrow(uint end, float limit) {
  clearSources();
  uint k = gl_LocalInvocationIndex;
  for (; k < num_strips; k += WORKGROUP) setTarget(stripAt(k), readStrip(kLayerTarget, stripAt(k)), limit);
  cut_short = cut_short || k < num_strips;
  shrinkWindow(end);
}

// No pressure outside the window, nor anywhere before the first step.
void clearPressures(bool first_step) {
  uint k = gl_LocalInvocationIndex;
  for (; k < NODE_ROWS * kRowStrips; k += WORKGROUP) {
    uvec2 at = uvec2(k / kRowStrips, k % kRowStrips);
    bool in_window = at.x - window_rows.x < window_rows.y && at.y - window_first[at.x] < window_width;
    if (first_step || !in_window) writeStrip(kLayerPressure, at, strip(0.0));
  }
  cut_short = cut_short || k < NODE_ROWS * kRowStrips;
  meet();
}

const float kLeastShift = 1e-6;  // of a load, past first touch

// Springs as soft as a few cells: the depth at which they would carry the load, a first guess of the shift. Newton's method from full depth.
float guessShift(Goal goal) {
  const float kSoftness = 4.0;
  const uint kRounds = 6;
  float shift = 1.0;
  for (uint round = 0; round < kRounds; ++round) {
    for (uint v = gl_LocalInvocationIndex; v < num_parts; v += WORKGROUP) {
      vec2 sums = vec2(0);
      uint k = v;
      for (; k < num_strips; k += LANES) {
        Strip target = readStrip(kLayerTarget, stripAt(k));
        Strip pressed = whereAbove(target, -shift);
        sums += vec2(sumOf(productOf(pressed, Strip(target.low + shift, target.high + shift))), sumOf(pressed));
      }
      cut_short = cut_short || k < num_strips;
      partial[v] = vec4(sums, 0, 0);
    }
    vec2 sums = sumOfPartials(num_parts).xy;
    shift = clamp(shift - (sums.x - kSoftness * goal.sum) / max(sums.y, 1.0), kLeastShift - goal.deepest, 1.0);
  }
  return shift;
}

// What `p` does along the targets, nodes that cannot be touched left out.
float workOf(Strip p, Strip target) { return dotOf(p, Strip(max(target.low, -2.0 - REACH), max(target.high, -2.0 - REACH))); }

// Pressures to start from, and their excess: those of the frame before, where they press what is to be pressed now, else in proportion to depth; as many
// times that as make up the load, or do most.
void begin(Solution found, Goal goal) {
  for (uint v = gl_LocalInvocationIndex; v < num_parts; v += WORKGROUP) {
    vec2 sums = vec2(0);
    uint k = v;
    for (; k < num_strips; k += LANES) {
      uvec2 at = stripAt(k);
      Strip target = readStrip(kLayerTarget, at);
      Strip p = productOf(readStrip(kLayerPressure, at), whereAbove(target, kNever));
      writeStrip(kLayerPressure, at, p);
      sums += vec2(workOf(p, target), sumOf(p));
    }
    cut_short = cut_short || k < num_strips;
    partial[v] = vec4(sums, 0, 0);
  }
  vec2 work = sumOfPartials(num_parts).xy;
  const float kFitting = 0.25;  // mean depth under the old pressures, of the deepest node's
  bool warm = work.y > 0.0 && work.x + found.shift * work.y > kFitting * (goal.deepest + found.shift) * work.y;

  clearSources();
  for (uint v = gl_LocalInvocationIndex; v < num_parts; v += WORKGROUP) {
    uint k = v;
    for (; k < num_strips; k += LANES) {
      uvec2 at = stripAt(k);
      Strip target = readStrip(kLayerTarget, at);
      Strip p = readStrip(kLayerPressure, at);
      if (!warm) p = Strip(max(target.low + found.shift, 0.0), max(target.high + found.shift, 0.0));
      writeStrip(kLayerPressure, at, p);
      writeStrip(kLayerDirection, at, strip(0.0));
      if (largestOf(p) > 0.0) addSource(at);
    }
    cut_short = cut_short || k < num_strips;
  }
  meet();
  for (uint v = gl_LocalInvocationIndex; v < num_parts; v += WORKGROUP) {
    vec4 sums = vec4(0);  // pressures times targets, times displacements; pressures
    uint k = v;
    for (; k < num_strips; k += LANES) {
      uvec2 at = stripAt(k);
      Strip p = readStrip(kLayerPressure, at), moved = displacementAt(at, kLayerPressure);
      writeStrip(kLayerProduct, at, moved);
      sums += vec4(workOf(p, readStrip(kLayerTarget, at)), dotOf(p, moved), sumOf(p), 0);
    }
    cut_short = cut_short || k < num_strips;
    partial[v] = sums;
  }
  vec4 sums = sumOfPartials(num_parts);
  float factor = LOADS && goal.by_load ? goal.sum / max(sums.z, 1e-30) : max(sums.x, 0.0) / max(sums.y, 1e-30);
  uint k = gl_LocalInvocationIndex;
  for (; k < num_strips; k += WORKGROUP) {
    uvec2 at = stripAt(k);
    writeStrip(kLayerPressure, at, scaled(readStrip(kLayerPressure, at), factor));
    writeStrip(kLayerResidual, at, minus(scaled(readStrip(kLayerProduct, at), factor), readStrip(kLayerTarget, at)));
  }
  cut_short = cut_short || k < num_strips;
  meet();
}

// Whether a node carries a taxel, not the margin, along a strip of row `at.x`.
Strip onTaxels(uvec2 at) {
  bool row = at.x >= MARGIN_ROWS && at.x < NODE_ROWS - MARGIN_ROWS;
  vec4 col = float(at.y * kStrip) + vec4(0, 1, 2, 3);
  vec2 range = row ? vec2(MARGIN_COLS, NODE_COLS - MARGIN_COLS) : vec2(0);
  return Strip(vec4(greaterThanEqual(col, vec4(range.x))) * vec4(lessThan(col, vec4(range.y))),
               vec4(greaterThanEqual(col + 4.0, vec4(range.x))) * vec4(lessThan(col + 4.0, vec4(range.y))));
}

// One value of an array over the nodes.
float valueAt(uint kind, uvec2 node) {
  uvec2 words = wordsOf(layer[stripAddress(kind, uvec2(node.x, node.y / kStrip)) + node.y % kStrip / 2]);
  return uintBitsToFloat((node.y & 1u) == 0 ? words.x : words.y);
}

#include "elastic_layer/shear.glsl"
#include "elastic_layer/jacobian.glsl"

// Forces of the taxels that were reached, N, and the mean depth of their samples, m; returns the rectangle of these taxels. `pressed`: the nodes that shear.
uvec4 writeTaxels(uint instance, Surface surface, uvec4 pressed, float shift) {
  uvec2 margin = uvec2(MARGIN_ROWS, MARGIN_COLS);
  uvec4 reached = surface.reached;
  uvec2 first_node = max(reached.xz, margin), end_node = min(reached.yw, uvec2(NODE_ROWS - MARGIN_ROWS, NODE_COLS - MARGIN_COLS));
  bool any_node = (num_strips > 0 || RELAXATION > 0) && all(lessThan(first_node, end_node));
  uvec2 first = (first_node - margin) / SAMPLES, count = (end_node - margin + SAMPLES - 1u) / SAMPLES - first;
  if (!any_node) first = count = uvec2(0);
  for (uint k = gl_LocalInvocationIndex; k < NUM_TAXELS; k += WORKGROUP) {
    uvec2 at = uvec2(k / NUM_COLS, k % NUM_COLS);
    bool inside = all(lessThan(at - first, count));
    if (!inside && !OUTPUT_DEPTH) continue;
    float pressure = 0.0, depth = 0.0;
    vec2 traction = vec2(0);
    for (uint a = 0; inside && a < SAMPLES; ++a) {
      for (uint b = 0; b < SAMPLES; ++b) {
        uvec2 node = margin + at * SAMPLES + uvec2(a, b);
        // The surface is known where it was reached; a taxel's nodes may lie beside.
        if (any(lessThan(node, first_node)) || any(greaterThanEqual(node, end_node))) continue;
        pressure += valueAt(kLayerPressure, node);
        if (OUTPUT_DEPTH) depth += max(overlapAt(surface, node) + shift, 0.0);
        if (OUTPUT_SHEAR && isKept(node, pressed)) traction += heldAt(shearState(instance, node));
      }
    }
    uint taxel = instance * NUM_TAXELS + k;
    contact_normal[taxel] = pressure * node_force * spread_scale[k];
    if (OUTPUT_DEPTH) contact_depth[taxel] = depth * THICKNESS / float(SAMPLES * SAMPLES);
    if (OUTPUT_SHEAR) {
      vec2 shear = traction * nodeArea() * spread_scale[k];
      contact_shear[2 * taxel] = shear.x;
      contact_shear[2 * taxel + 1] = shear.y;
    }
  }
  return uvec4(first.x, first.x + count.x, first.y, first.y + count.y);
}

// Wrench, loads and what else is told of an instance.
void report(uint instance, uint num_instances, Surface surface, Solution found, uint iterations, uvec4 taxels, Shear shear) {
  vec2 spacing = nodeSpacing();
  for (uint v = gl_LocalInvocationIndex; v < num_parts; v += WORKGROUP) {
    vec4 sums = vec4(0);  // pressures, these times x and y of P, pressures on taxels
    float deep = 0.0;
    uint k = v;
    for (; k < num_strips; k += LANES) {
      uvec2 at = stripAt(k);
      Strip p = readStrip(kLayerPressure, at), overlap = readStrip(kLayerTarget, at), on_taxels = onTaxels(at);
      if (RELAXATION > 0) overlap = overlapsOver(surface, at);
      vec2 corner = nodePosition(uvec2(at.x, at.y * kStrip));
      Strip along = Strip(corner.y + vec4(0, 1, 2, 3) * spacing.y, corner.y + vec4(4, 5, 6, 7) * spacing.y);
      float sum = sumOf(p);
      sums += vec4(sum, sum * corner.x, dotOf(p, along), dotOf(p, on_taxels));
      deep += dotOf(on_taxels, whereAbove(Strip(overlap.low + found.shift, overlap.high + found.shift), 0.9999999));
    }
    cut_short = cut_short || k < num_strips;
    partial[v] = sums;
    if (deep > 0.0) atomicAdd(num_deep, uint(deep));
  }
  vec4 sums = sumOfPartials(num_parts) * node_force;
  if (gl_LocalInvocationIndex != 0) return;
  mat3 R_SP = transpose(mat3(sensor.X_SC_row0.xyz, sensor.X_SC_row1.xyz, sensor.X_SC_row2.xyz));
  vec3 force = R_SP * vec3(shear.force, -sums.x);
  // The skin is pressed along -z of P: torque (x, y, 0) x (0, 0, -f).
  vec3 torque = R_SP * (vec3(-sums.z, sums.y, 0) + shear.torque) + cross(vec3(sensor.X_SC_row0.w, sensor.X_SC_row1.w, sensor.X_SC_row2.w), force);
  tile_results[instance].force = vec4(force, float(num_deep));
  tile_results[instance].torque = vec4(torque, sums.w);
  tile_results[instance].window = taxels;
  features[kFeatureOffArrayLoad * num_instances + instance] = max(sums.x - sums.w, 0.0);
  features[kFeatureContactResidual * num_instances + instance] = found.residual;
  features[kFeatureContactIterations * num_instances + instance] = float(iterations);
}

void pressInstance(uint instance, uint num_instances, uint num_slots) {
  layer_start = instance * kLayerArrays * kArrayPairs;
  uint flags = instances[instance].keys.w;
  bool is_first = (flags & kFlagFirstStep) != 0;
  bool by_load = LOADS && (flags & kFlagLoadDriven) != 0;
  node_force = NODE_FORCE;
  if (RELAXATION > 0) {
    skin_is_new = is_first;
    loadSkinStep(is_first);
    node_force *= skin_gain;
  }
  if (gl_LocalInvocationIndex == 0) num_deep = 0;

  Surface surface = Surface(instance * NODE_ROWS * NODE_COLS, reachedNodes(instance), 0.0);
  uint first_strip = surface.reached.z / kStrip, end_strip = (surface.reached.w + kStrip - 1u) / kStrip;
  for (uint row = gl_LocalInvocationIndex; row < NODE_ROWS; row += WORKGROUP) window_first[row] = first_strip;
  setWindow(uvec2(surface.reached.x, surface.reached.y - surface.reached.x), end_strip - first_strip);
  meet();
  float lowest = lowestHeight(surface);
  bool above = lowest >= kMiss;  // there is nothing
  if (by_load) surface.origin = lowest;
  float deepest = by_load ? 0.0 : min(-lowest / THICKNESS, 1.0);
  // Around a dent skin that bulges may be met anywhere in its reach.
  float limit = by_load ? -(1.0 + REACH) : RELAXATION > 0 ? -REACH : -REACH * max(deepest, 0.0);
  aim(surface, above ? kMiss : limit);
  if (RELAXATION > 0) {
    float sunk = sinkTargets();
    if (!by_load) narrow(end_strip, -REACH * max(max(sunk, deepest), 0.0));
    deepest = sunk;
  }
  float load = by_load ? instances[instance].drive.x : 0.0;
  bool too_deep = kLeastShift - deepest > 1.0;  // full depth would not press on the bottom of a dent
  bool idle = above || (by_load ? load <= 0.0 || too_deep : deepest <= 0.0);
  if (idle) setWindow(uvec2(0), 0);
  clearPressures(is_first);

  // More than any skin carries is as good as endless.
  const float kMost = 1e6 * float(NODE_ROWS * NODE_COLS);
  Goal goal = Goal(deepest, by_load, min(load / node_force, kMost));
  Solution found = Solution(0.0, 0.0, 0.0, 0.0);
  uint iterations = 0;
  float status = above || (load > 0.0 && too_deep) ? kLoadOutOfReach : kLoadCarried;
  if (by_load && !above) found.shift = min(-deepest, 1.0);  // at first touch
  if (!idle) {
    if (LOADS && by_load) found.shift = guessShift(goal);
    begin(found, goal);
    iterations = solve(found, goal);
    if (by_load && !goal.by_load) status = kLoadOutOfReach;
  }
  float offset = !by_load || above ? 0.0 : -lowest - found.shift * THICKNESS;
  if (LOADS && by_load && gl_LocalInvocationIndex == 0) loads[instance].bracket = vec4(offset, 0, 0, status);
  meet();
  if (RELAXATION > 0) keepSkin();
  uvec4 pressed = uvec4(0);
  Shear shear = Shear(vec2(0), vec3(0));
  if (FRICTION) {
    pressed = pressedNodes();
    shear = shearNodes(instance, num_slots, surface, pressed, found.shift, offset);
  }
  uvec4 taxels = writeTaxels(instance, surface, pressed, found.shift);
  report(instance, num_instances, surface, found, iterations, taxels, shear);
  if (OUTPUT_JACOBIAN) keepJacobian(instance, surface, found.shift);
}

void main() {
  uvec4 batch = step_record.batch;
  uint first = workgroupNumber() * REPEAT;
  uint end = min(first + REPEAT, batch.x);
  uint instance = first;
  for (; instance < end; ++instance) {
    pressInstance(instance, batch.x, batch.y);
    meet();
  }
  if (cut_short || instance < end) problems[0] = 1;
}
