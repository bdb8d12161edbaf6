#version 460
#extension GL_GOOGLE_include_directive : require
// Elastic layer pass: stage 2 (contact law) of one frame for the law `elastic_layer`, with its load search, shear and relaxation.
//
//   A p = d where p > 0,   A p >= d where p = 0;      d = target + shift
//
// solved by conjugate gradients with an active set (elastic_layer/solver.glsl). An instance that is driven by its pose has shift 0, and its target is the signed
// overlap. For an instance that is driven by load, the target is the shape of the surface below its lowest point, the shift is the depth of that point, and
// pressures are scaled so that their sum is the load in every iteration. Displacements are in thicknesses; a pressure is given as the displacement that it
// causes at its own node, so that A has ones on its diagonal.
//
// A workgroup owns an instance; an invocation owns strips of kStrip nodes along a row. Only strips in a window around the contact are visited.
// In:  heights (num_instances x num_nodes), m, with slots in their lowest bits (depth/slots.glsl), and windows (num_instances x NUM_HEIGHT_TILES), from the
//      contact pass; influence (node rows x 2 strips of a row, elastic_layer/influence.glsl); with friction motions (num_instances x num_slots).
// Out: contact_normal (num_instances x num_taxels), N; contact_shear (num_instances x num_taxels x 2), N; contact_depth (num_instances x num_taxels), m;
//      tile_results (num_instances); loads (num_instances); features of the solution; with OUTPUT_JACOBIAN taxel_jacobian (num_instances x 6 x num_taxels), N/m
//      and N/rad, and wrench_jacobian (num_instances x 6 x 6).
// State: pressures, from which the next frame starts; with relaxation strain and overstresses of every node; with friction their shear traction.
// Shared memory: 16 LANES + 12 NODE_ROWS + 16 bytes; with friction 8 LANES + 512 bytes more.
// Deterministic: sums run over LANES partial sums in a fixed order, whatever the size of the workgroup.
// Mutable globals: any_unfinished_loop (driver/loop_limit.glsl).
// Twins: src/reference/elastic_layer.cpp, relaxation.cpp, friction.cpp.

#include "driver/pairs.glsl"
#include "driver/barrier.glsl"
#include "driver/texels.glsl"
#include "shared/batch.h"
#include "shared/elastic_layer.h"
#include "shared/features.h"
#include "shared/sensor.h"
#include "common/specialization.glsl"
layout(constant_id = 11) const uint NODE_ROWS = 12;
layout(constant_id = 12) const uint NODE_COLS = 28;
layout(constant_id = 13) const uint MARGIN_ROWS = 0;  // nodes of the margin on either side
layout(constant_id = 14) const uint MARGIN_COLS = 0;
layout(constant_id = 15) const float THICKNESS = 0.002;  // m
layout(constant_id = 16) const float REACH = 2.0;        // gaps that matter, in depths of the deepest node
layout(constant_id = 17) const float NODE_FORCE = 1.0;   // of a node under a pressure that moves its own cell by a thickness, N
layout(constant_id = 18) const uint ITERATIONS = 10;
layout(constant_id = 19) const float TOLERANCE = 1e-3;
layout(constant_id = 20) const uint NUM_HEIGHT_TILES = 1;  // of the contact pass
layout(constant_id = 21) const bool LOADS = false;         // some instance is driven by load
layout(constant_id = 22) const bool OUTPUT_DEPTH = false;  // contact_depth is wanted
layout(constant_id = 23) const bool MANY_SLOTS = false;    // an instance may touch several objects
layout(constant_id = 24) const bool FRICTION = false;      // shear with memory, skin/friction.glsl
layout(constant_id = 25) const float TANGENTIAL_STIFFNESS = 1e8;  // N/m^3
layout(constant_id = 26) const float FRICTION_COEFFICIENT = 1.0;
layout(constant_id = 27) const bool OUTPUT_SHEAR = false;  // contact_shear is wanted
layout(constant_id = 28) const uint RELAXATION = 0;        // terms of the skin's relaxation
layout(constant_id = 29) const bool OUTPUT_JACOBIAN = false;  // taxel_jacobian and wrench_jacobian are wanted, elastic_layer/jacobian.glsl

layout(std430, set = 0, binding = 0) readonly buffer Instances { InstanceRecord instances[]; };
layout(std430, set = 0, binding = 1) readonly buffer Step { StepRecord step_record; };
layout(std430, set = 0, binding = 2) readonly buffer SensorBlock { SensorRecord sensor; };
layout(std430, set = 0, binding = 3) readonly buffer Heights { uint heights[]; };
layout(std430, set = 0, binding = 4) readonly buffer Windows { TileResult windows[]; };
FOURS(5, Influence);
layout(std430, set = 0, binding = 6) readonly buffer SpreadScale { float spread_scale[]; };
layout(std430, set = 0, binding = 7) coherent buffer Layer { Pair layer[]; };
layout(std430, set = 0, binding = 8) writeonly buffer ContactNormal { float contact_normal[]; };
layout(std430, set = 0, binding = 9) writeonly buffer ContactDepth { float contact_depth[]; };
layout(std430, set = 0, binding = 10) writeonly buffer TileResults { TileResult tile_results[]; };
layout(std430, set = 0, binding = 11) buffer Loads { LoadRecord loads[]; };
layout(std430, set = 0, binding = 12) writeonly buffer Features { float features[]; };
layout(std430, set = 0, binding = 13) writeonly buffer Problems { uint problems[]; };
layout(std430, set = 0, binding = 14) readonly buffer Motions { MotionRecord motions[]; };
layout(std430, set = 0, binding = 15) coherent buffer FrictionState { Pair friction_state[]; };
layout(std430, set = 0, binding = 16) writeonly buffer ContactShear { float contact_shear[]; };
layout(std430, set = 0, binding = 17) writeonly buffer TaxelJacobian { float taxel_jacobian[]; };
layout(std430, set = 0, binding = 18) writeonly buffer WrenchJacobian { float wrench_jacobian[]; };

const float kMiss = kNoHeight;  // height where there is no surface
const bool kShears = FRICTION;
const bool FLAT = false;        // the patch's frame may be any

shared uint num_deep;  // nodes of taxels at full depth

#include "common/whole.glsl"
#include "common/workgroup.glsl"
#include "common/transform.glsl"
#include "driver/loop_limit.glsl"
#include "depth/slots.glsl"
#include "skin/friction.glsl"
#include "skin/skin_step.glsl"
#include "elastic_layer/strip.glsl"
#include "elastic_layer/window.glsl"
#include "elastic_layer/influence.glsl"
#include "elastic_layer/surface.glsl"
#include "elastic_layer/targets.glsl"
#include "elastic_layer/solver.glsl"
#include "elastic_layer/initial_guess.glsl"
#include "elastic_layer/relaxation.glsl"
#include "elastic_layer/shear.glsl"
#include "elastic_layer/outputs.glsl"
#include "elastic_layer/jacobian.glsl"

void solveInstance(uint instance, uint num_instances, uint num_slots) {
  uint flags = instances[instance].keys.w;
  bool is_first = (flags & kFlagFirstStep) != 0;
  bool by_load = LOADS && (flags & kFlagLoadDriven) != 0;
  float node_force = NODE_FORCE;  // of a node under the pressure 1 of the solution, N
  SkinStep skin = noSkinStep();
  if (RELAXATION > 0) {
    skin = skinStep(is_first);
    node_force *= skin.gain;
  }
  if (gl_LocalInvocationIndex == 0) num_deep = 0;

  Surface surface = Surface(instance * NODE_ROWS * NODE_COLS, reachedNodes(instance), 0.0);
  Window window = reachedWindow(instance, surface);
  workgroupBarrierWithBuffers();
  float lowest = lowestHeight(surface, window);
  bool no_surface = lowest >= kMiss;
  if (by_load) surface.origin = lowest;
  float deepest = by_load ? 0.0 : min(-lowest / THICKNESS, 1.0);
  // Next to a dent the skin may bulge and touch anywhere within its reach.
  float limit = by_load ? -(1.0 + REACH) : RELAXATION > 0 ? -REACH : -REACH * max(deepest, 0.0);
  setTargets(surface, no_surface ? kMiss : limit, window);
  if (RELAXATION > 0) {
    float lowered = lowerTargetsByDents(skin, window);
    if (!by_load) limitTargets((surface.reached.w + kStrip - 1u) / kStrip, -REACH * max(max(lowered, deepest), 0.0), window);
    deepest = lowered;
  }
  float load = by_load ? instances[instance].drive.x : 0.0;
  bool too_deep = kLeastShift - deepest > 1.0;  // full depth would not press on the bottom of a dent
  bool idle = no_surface || (by_load ? load <= 0.0 || too_deep : deepest <= 0.0);
  if (idle) setWindow(window, uvec2(0), 0);
  clearPressures(window, is_first);

  const float kMaxPressureSum = 1e6 * float(NODE_ROWS * NODE_COLS);  // more than any skin carries; keeps the sums finite
  Drive drive = Drive(deepest, by_load, min(load / node_force, kMaxPressureSum));
  Solution found = Solution(0.0, 0.0, 0.0, 0.0);
  uint iterations = 0;
  float status = no_surface || (load > 0.0 && too_deep) ? kLoadOutOfReach : kLoadCarried;
  if (by_load && !no_surface) found.shift = min(-deepest, 1.0);  // at first touch
  if (!idle) {
    if (LOADS && by_load) found.shift = initialShift(window, drive);
    initializePressures(window, found.shift, drive);
    iterations = solve(window, found, drive);
    if (by_load && !drive.by_load) status = kLoadOutOfReach;
  }
  float offset = !by_load || no_surface ? 0.0 : -lowest - found.shift * THICKNESS;
  if (LOADS && by_load && gl_LocalInvocationIndex == 0) loads[instance].bracket = vec4(offset, 0, 0, status);
  workgroupBarrierWithBuffers();
  if (RELAXATION > 0) updateSkin(skin, window.layer_start);

  uvec4 pressed = uvec4(0);
  Shear shear = Shear(vec2(0), vec3(0));
  if (FRICTION) {
    pressed = pressedNodes(window);
    shear = shearNodes(instance, num_slots, surface, window.layer_start, pressed, found.shift, offset, node_force);
  }
  uvec4 taxels = writeTaxels(instance, surface, window, pressed, found.shift, node_force);
  writeResults(instance, num_instances, surface, window, found, iterations, taxels, shear, node_force);
  if (OUTPUT_JACOBIAN) writeJacobian(instance, surface, window, found.shift, node_force);
}

void main() {
  uvec4 batch = step_record.batch;
  uint first = workgroupNumber() * REPEAT;
  uint end = min(first + REPEAT, batch.x);
  uint instance = first;
  for (; instance < end; ++instance) {
    solveInstance(instance, batch.x, batch.y);
    workgroupBarrierWithBuffers();
  }
  checkLoop(instance < end);
  reportUnfinishedLoops();
}
