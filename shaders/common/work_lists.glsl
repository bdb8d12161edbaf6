// Lists of instances for passes to come; shared/candidates.h. Which order they get is chance, and does not show.

uint placeInList(uint list, uint instance) { return list * step_record.batch.x + instance; }

void enlist(uint list, uint instance, uint per_workgroup) {
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
