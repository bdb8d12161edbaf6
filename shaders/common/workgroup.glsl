// Number of this workgroup: Commands::dispatch() folds large numbers of workgroups into two dimensions.
uint workgroupNumber() { return gl_WorkGroupID.x + gl_WorkGroupID.y * gl_NumWorkGroups.x; }
