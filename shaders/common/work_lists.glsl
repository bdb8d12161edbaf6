// Lists of instances for later passes, shared/candidates.h. Their order varies from run to run and does not affect results.
// In, out: work, work_instances.

uint placeInList(uint list, uint instance) { return list * step_record.batch.x + instance; }

// Appends an instance, and counts a workgroup for every `per_workgroup` instances of the list.
void appendToList(uint list, uint instance, uint per_workgroup) {
  uint at = atomicAdd(work[list].w, 1u);
  work_instances[placeInList(list, at)] = instance;
  if (at % per_workgroup != 0) return;
  uint workgroup = at / per_workgroup;
  if (workgroup < kMaxColumns) {
    atomicAdd(work[list].x, 1u);
  } else if (workgroup % kMaxColumns == 0) {
    atomicAdd(work[list].y, 1u);
  }
}
