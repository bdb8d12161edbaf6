#version 460
#extension GL_GOOGLE_include_directive : require
// Elastic layer pass: stage 2 (contact law) of one frame for the law `elastic_layer`, with its load search, shear and relaxation.
//
//   A p = d where p > 0,   A p >= d where p = 0;      d = target + shift
//
// solved by conjugate gradients with an active set (elastic_layer/solver.glsl). An instance that is driven by its pose has shift 0, and its
// target is the signed overlap. For an instance that is driven by load, the target is the shape of the surface below its lowest point, the
// shift is the depth of that point, and pressures are scaled so that their sum is the load in every iteration. Displacements are in
// thicknesses; a pressure is given as the displacement that it causes at its own node, so that A has ones on its diagonal.
//
// A workgroup owns an instance; an invocation owns strips of kStrip nodes along a row. Only strips in a window around the contact are
// visited.
// In:  heights (num_instances x num_nodes), m, with slots in their lowest bits (depth/slots.glsl), and windows (num_instances x
//      NUM_HEIGHT_TILES), from the heights pass, with area sampling node_cells (num_instances x num_nodes x kNodeCellWords); influence
//      (node rows x 2 strips of a row, elastic_layer/influence.glsl); with friction motions (num_instances x motions of the step).
// Out: contact_normal (num_instances x num_taxels), N; contact_shear (num_instances x num_taxels x 2), N; contact_depth (num_instances x
//      num_taxels), m; tile_results (num_instances); loads (num_instances); features of the solution; with OUTPUT_JACOBIAN taxel_jacobian
//      (num_instances x 6 x num_taxels), N/m and N/rad, and wrench_jacobian (num_instances x 6 x 6).
// State: pressures, from which the next frame starts; with relaxation strain and overstresses of every node, with area sampling also
// compliances of dents; with friction their shear traction.
// Shared memory: 16 LANES + 8 NODE_ROWS + 12 bytes; with friction 8 LANES + 512 bytes more.
// Deterministic: sums run over LANES partial sums in a fixed order, whatever the size of the workgroup.
// Mutable globals: any_unfinished_loop (driver/loops.glsl); own_partial (driver/workgroup.glsl), own_shear (skin/friction.glsl).
// References: src/reference/elastic_layer.cpp, relaxation.cpp, friction.cpp.

#include "passes/declare.glsl"
#include "shared/elastic_layer.h"
#include "shared/features.h"
#include "passes/elastic_layer.h"

const bool FLAT = false;       // the patch's frame may be any
const bool MANY_SLOTS = true;  // heights may hold the slots of several objects

shared uint num_deep;  // nodes of taxels at full depth

#include "driver/arithmetic.glsl"
#include "common/instances.glsl"
#include "common/transform.glsl"
#include "driver/workgroup.glsl"
#include "driver/loops.glsl"
#include "depth/slots.glsl"
#include "skin/skin_step.glsl"
#include "elastic_layer/strip.glsl"
#include "elastic_layer/window.glsl"
#include "elastic_layer/surface.glsl"
#include "elastic_layer/influence.glsl"
#include "elastic_layer/targets.glsl"
#include "elastic_layer/solver.glsl"
#include "elastic_layer/initial_guess.glsl"
#include "elastic_layer/relaxation.glsl"
#include "elastic_layer/shear.glsl"
#include "elastic_layer/outputs.glsl"
#include "elastic_layer/cell_rates.glsl"
#include "elastic_layer/jacobian.glsl"

// Sets the targets of the window, with those of dents, and shrinks it. `lowest`: height, m. Returns the largest target, or for a skin
// without relaxation that is driven by load 0.
float setAllTargets(Surface surface, SkinStep skin, float lowest, bool by_load, inout Window window) {
  float deepest = by_load ? 0.0 : min(-lowest / THICKNESS, 1.0);
  // Next to a dent the skin may bulge and touch anywhere within its reach.
  float limit = by_load ? -(1.0 + REACH) : RELAXATION > 0 ? -REACH : -REACH * max(deepest, 0.0);
  setTargets(surface, lowest >= kNoHeight ? kNoHeight : limit, window);
  if (RELAXATION == 0) return deepest;
  setCompliances(surface, window);
  float lowered = lowerTargetsByDents(skin, window);
  if (!by_load) limitTargets(surface, -REACH * max(max(lowered, deepest), 0.0), window);
  return lowered;
}

// `offset`: by which a load search has moved the objects along z of S, m. `node_force`: of a node under the pressure 1, N.
void writeOutputs(uint instance, uint num_instances, uint num_slots, Surface surface, Window window, Solution found, uint iterations,
                  float offset, float node_force) {
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

void solveInstance(uint instance, uint num_instances, uint num_slots) {
  if (isHeld(instance)) return;
  uint flags = instanceRecord(instance).keys.w;
  bool is_first = (flags & kFlagFirstStep) != 0;
  bool by_load = LOADS && (flags & kFlagLoadDriven) != 0;
  float node_force = NODE_FORCE;  // force of a node under the pressure 1 of the solution, N
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
  bool no_surface = lowest >= kNoHeight;
  if (by_load) surface.origin = lowest;
  float deepest = setAllTargets(surface, skin, lowest, by_load, window);
  float load = by_load ? instanceRecord(instance).drive.x : 0.0;
  bool too_deep = kLeastShift - deepest > 1.0;  // full depth would not press on the bottom of a dent
  bool idle = no_surface || (by_load ? load <= 0.0 || too_deep : deepest <= 0.0);
  if (idle) setWindow(window, uvec2(0), 0);
  clearPressures(window, is_first);
  if (RELAXATION == 0) setCompliances(surface, window);

  const float kMaxPressureSum = 1e6 * float(NODE_ROWS * NODE_COLS);  // more than any skin carries; keeps the sums finite
  Drive drive = Drive(deepest, by_load, min(load / node_force, kMaxPressureSum));
  Solution found = Solution(0.0, 0.0, 0.0, 0.0);
  uint iterations = 0;
  float status = no_surface || (load > 0.0 && too_deep) ? kLoadOutOfReach : kLoadCarried;
  if (by_load && !no_surface) found.shift = min(-deepest, 1.0);  // at first touch
  if (!idle) {
    if (LOADS && by_load) found.shift = initialShift(window, drive);
    initializePressures(window, drive, found);
    iterations = solve(window, found, drive);
    if (by_load && !drive.by_load) status = kLoadOutOfReach;
  }
  float offset = !by_load || no_surface ? 0.0 : -lowest - found.shift * THICKNESS;
  if (LOADS && by_load && gl_LocalInvocationIndex == 0) loads[instance] = LoadRecord(vec4(offset, 0, 0, status), vec4(0));
  workgroupBarrierWithBuffers();
  if (RELAXATION > 0) updateSkin(skin, window.layer_start);

  writeOutputs(instance, num_instances, num_slots, surface, window, found, iterations, offset, node_force);
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
