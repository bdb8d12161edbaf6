// Lists of instances and tiles for later passes, shared/batch.h. Their order varies from run to run and does not affect results.
// In, out: work, work_instances.

// Index in work_instances[] of the entry `at` of a list.
uint listIndex(uint list, uint at) { return list * step_record.batch.x + at; }

// Appends an entry to the list of a row of `work`, and a workgroup for every `per_workgroup` entries. Returns the index of the entry.
uint appendEntry(uint row, uint per_workgroup) {
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
  work_instances[listIndex(list, appendEntry(list, per_workgroup))] = instance;
}
