// Which tiles a workgroup computes, one after another: REPEAT of all tiles or of a list of instances (shared/batch.h).
//
// Some drivers end the loops of an invocation after a number of iterations in total (driver/loops.glsl), and a tile under a fine mesh
// may take a large part of them, but few tiles do. With MOST_ITERATIONS a workgroup that has exceeded this budget leaves its other tiles to
// a second dispatch of the same kernel, whose workgroups take one tile each. In, out: work, work_instances.

#include "common/work_lists.glsl"
#include "driver/loops.glsl"

shared uint tile_list[REPEAT];  // tiles to be computed
shared uint num_listed_tiles;

const bool kLeavesTiles = MOST_ITERATIONS > 0u;
bool isSecondDispatch() { return kLeavesTiles && work[kSecondDispatch].x != 0; }
bool exceedsBudget() { return kLeavesTiles && num_iterations > MOST_ITERATIONS; }

// Index in work_instances[] of an entry of the list of left tiles, which follows the lists of instances.
uint leftTileIndex(uint at) { return kNumLists * step_record.batch.x + at; }
void leaveTile(uint number) { work_instances[leftTileIndex(appendEntry(kLeftTiles, 1u))] = number; }

// Number of a tile over all instances, by its index in the dispatch. Only sensors with one tile have lists of instances.
uint tileNumbered(uint index) {
  if (isSecondDispatch()) return work_instances[leftTileIndex(index)];
  return LIST < kNumLists ? work_instances[listIndex(LIST, index)] : index;
}

// Indices of this workgroup's tiles in the dispatch: first and end.
uvec2 tileRange() {
  bool second = isSecondDispatch();
  uint all = step_record.batch.x * NUM_TILES;
  if (LIST < kNumLists) all = work[LIST].w;
  if (second) all = work[kLeftTiles].w;
  uint first = min(workgroupNumber() * (second ? 1u : REPEAT), all);  // a dispatch in two dimensions may have more workgroups than work
  return uvec2(first, min(first + (second ? 1u : REPEAT), all));
}
