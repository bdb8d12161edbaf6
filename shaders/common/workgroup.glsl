// The number of this workgroup, over the two dimensions that Commands::dispatch() folds the work into.
uint workgroupNumber() { return gl_WorkGroupID.x + gl_WorkGroupID.y * gl_NumWorkGroups.x; }
