// Which tiles a workgroup computes, one after another: REPEAT of all tiles or of a list of instances (shared/batch.h).
//
// Some drivers end the loops of an invocation after a number of iterations in total (driver/loops.glsl), and a tile under a fine mesh
// may take a large part of them, but few tiles do. With MOST_ITERATIONS a workgroup that has taken so many leaves its other tiles to a
// second dispatch of the same kernel, whose workgroups take one tile each.
// In, out: work, work_instances.
#ifndef DEPTH_TILE_SEQUENCE_GLSL
#define DEPTH_TILE_SEQUENCE_GLSL

#include "common/work_lists.glsl"
#include "driver/loops.glsl"

shared uint tile_list[REPEAT];  // tiles to be computed
shared uint num_listed_tiles;

const bool kLeavesTiles = MOST_ITERATIONS > 0u;
bool isSecondDispatch() { return kLeavesTiles && work[kSecondDispatch].x != 0; }
bool leavesNextTile() { return kLeavesTiles && num_iterations > MOST_ITERATIONS; }

// Place of a tile in the list of those left, which is behind the lists of instances.
uint placeOfLeftTile(uint at) { return kNumLists * step_record.batch.x + at; }
void leaveTile(uint number) { work_instances[placeOfLeftTile(newEntry(kLeftTiles, 1u))] = number; }

// Number of a tile over all instances, by its place among those of the dispatch. Lists of instances are of sensors with one tile.
uint tileNumbered(uint place) {
  if (isSecondDispatch()) return work_instances[placeOfLeftTile(place)];
  return LIST < kNumLists ? work_instances[placeInList(LIST, place)] : place;
}

// The places of this workgroup's tiles: the first one, and that behind the last one.
uvec2 placesOfTiles() {
  bool second = isSecondDispatch();
  uint all = step_record.batch.x * NUM_TILES;
  if (LIST < kNumLists) all = work[LIST].w;
  if (second) all = work[kLeftTiles].w;
  uint first = min(workgroupNumber() * (second ? 1u : REPEAT), all);  // a dispatch in two dimensions may have more workgroups than work
  return uvec2(first, min(first + (second ? 1u : REPEAT), all));
}

#endif
