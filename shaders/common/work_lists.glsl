// Lists of instances and tiles for later passes, shared/batch.h. Their order varies from run to run and does not affect results.
// In, out: work, work_instances.
#ifndef COMMON_WORK_LISTS_GLSL
#define COMMON_WORK_LISTS_GLSL

uint placeInList(uint list, uint instance) { return list * step_record.batch.x + instance; }

// Counts a workgroup for every `per_workgroup` entries of the list of a row. Returns the place of a new entry.
uint newEntry(uint row, uint per_workgroup) {
  uint at = atomicAdd(work[row].w, 1u);
  if (at % per_workgroup != 0) return at;
  uint workgroup = at / per_workgroup;
  if (workgroup < kMaxColumns) {
    atomicAdd(work[row].x, 1u);
  } else if (workgroup % kMaxColumns == 0) {
    atomicAdd(work[row].y, 1u);
  }
  return at;
}

void appendToList(uint list, uint instance, uint per_workgroup) {
  work_instances[placeInList(list, newEntry(list, per_workgroup))] = instance;
}

#endif
