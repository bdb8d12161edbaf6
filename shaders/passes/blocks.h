// Every array that passes bind: the name of its block, the type of an element, the name that shaders give it. A host buffer belongs to
// exactly one block, so it cannot be bound in place of another.
//
// n = num_instances, t = num_taxels; (a x b) is row-major.

// ---- the model ----
#define BLOCK_Objects BLOCK(Objects, ObjectRecord, objects[])
#define BLOCK_Groups BLOCK(Groups, uvec4, groups[])        // boxes of groups of clusters
#define BLOCK_Clusters BLOCK(Clusters, uvec4, clusters[])  // boxes of clusters of quads
#define BLOCK_Quads BLOCK(Quads, uint, quads[])            // quads of triangles, kQuadWords each
#define BLOCK_Faces BLOCK(Faces, vec4, faces[])            // faces of polyhedra: normal and offset (m), in O
#define BLOCK_SensorBlock BLOCK(SensorBlock, SensorRecord, sensor)
#define BLOCK_Patches BLOCK(Patches, PatchRecord, patches[])
#define BLOCK_Tiles BLOCK(Tiles, TileRecord, tiles[])
#define BLOCK_Taxels BLOCK(Taxels, TaxelRecord, taxels[])
#define BLOCK_SpreadRows BLOCK(SpreadRows, vec4, spread_rows[])
#define BLOCK_SpreadScale BLOCK(SpreadScale, float, spread_scale[])  // (t)
#define BLOCK_MaskScale \
  BLOCK(MaskScale, float, mask_scale[])       // (t): force that a source gives to deformation_mask per newton, on one grid patch
#define BLOCK_Mask BLOCK(Mask, vec2, mask[])  // (MASK_SOURCES / 2 x t x 2), deformation_mask: source taxel (as bits), weight
#define BLOCK_Influence BLOCK(Influence, float, influence[])  // (node rows x 2 rows of strips), elastic layer
#define BLOCK_Planes BLOCK(Planes, PlaneRecord, planes[])
#define BLOCK_Neighbours BLOCK(Neighbours, uint, neighbours[])               // (NUM_NEIGHBOURS x t), of lower number
#define BLOCK_LoadBounds BLOCK(LoadBounds, LoadBoundsRecord, load_bounds[])  // a record per object
#define BLOCK_FeatureSource BLOCK(FeatureSource, uint, feature_source)       // source of contact features: 0 the image, 1 the clean forces

// ---- a batch: inputs ----
#define BLOCK_Poses BLOCK(Poses, PoseRecord, poses[])          // (n x poses of the step), up to (n x num_slots)
#define BLOCK_Motions BLOCK(Motions, MotionRecord, motions[])  // as Poses
#define BLOCK_Instances BLOCK(Instances, InstanceRecord, instances[])
#define BLOCK_Step BLOCK(Step, StepRecord, step_record)
#define BLOCK_Loads BLOCK(Loads, LoadRecord, loads[])
#define BLOCK_Contacts BLOCK(Contacts, ContactRecord, contacts[])  // (n x max_contacts)
#define BLOCK_NumContacts BLOCK(NumContacts, uint, num_contacts[])
#define BLOCK_Cotangents BLOCK(Cotangents, float, cotangents[])                  // (n x t), per N
#define BLOCK_ForceCotangents BLOCK(ForceCotangents, float, force_cotangents[])  // (n x t), per N: times the gains of the taxels

#define BLOCK_IntegerRows BLOCK(IntegerRows, uvec4, integer_rows[])  // arrays of IntegerFeatures: source, its first value, size, first word
#define BLOCK_InputIds BLOCK(InputIds, int, input_ids[])             // (n x num_slots), as the next two for place.comp
#define BLOCK_InputPoses BLOCK(InputPoses, double, input_poses[])    // (n x num_slots x 7), m
#define BLOCK_InputLoads BLOCK(InputLoads, float, input_loads[])     // (n), N
#define BLOCK_InputPositions BLOCK(InputPositions, double, input_positions[])  // (n x max_contacts x 3), m
#define BLOCK_InputForces BLOCK(InputForces, double, input_forces[])           // (n x max_contacts), N
#define BLOCK_InputCounts BLOCK(InputCounts, int, input_counts[])              // (n), contact points
#define BLOCK_InputProblems BLOCK(InputProblems, uint, input_problems[])       // (kNumInputProblems), place.comp
#define BLOCK_PlacedPoses BLOCK(PlacedPoses, double, placed_poses[])           // (n x num_slots x kPlacedNumbers)
#define BLOCK_Servos BLOCK(Servos, ServoRecord, servos[])
#define BLOCK_Loop BLOCK(Loop, LoopRecord, servo_loop)
#define BLOCK_Robot BLOCK(Robot, RobotRecord, robot)
#define BLOCK_LoopStarts BLOCK(LoopStarts, LoopStartRecord, loop_starts[])  // (n)

// ---- a batch: between steps and between passes ----
#define BLOCK_Candidates BLOCK(Candidates, CandidateRecord, candidates[])
#define BLOCK_CandidateQuads BLOCK(CandidateQuads, uint, candidate_quads[])  // (n x kMaxCandidates)
#define BLOCK_Work BLOCK(Work, uvec4, work[])                                // (kNumWorkRows)
#define BLOCK_WorkInstances BLOCK(WorkInstances, uint, work_instances[])     // ((kNumLists + num_tiles) x n)
#define BLOCK_State BLOCK(State, uvec4, state[])                             // state of tiles and their samples, skin/sample_states.glsl
#define BLOCK_FrictionState BLOCK(FrictionState, uvec2, friction_state[])    // elastic layer: kFrictionHeader, then one entry per node
#define BLOCK_LawState BLOCK(LawState, vec2, law_state[])                    // (n x t), laws with taxel passes
#define BLOCK_ContactNormal BLOCK(ContactNormal, float, contact_normal[])    // (n x t), N
#define BLOCK_MaskedNormal BLOCK(MaskedNormal, float, masked_normal[])       // (n x t), N, law deformation_mask
#define BLOCK_ContactShear BLOCK(ContactShear, float, contact_shear[])       // (n x t x 2), N
#define BLOCK_ContactDepth BLOCK(ContactDepth, float, contact_depth[])       // (n x t), m
#define BLOCK_TileResults BLOCK(TileResults, TileResult, tile_results[])     // (n x num_tiles)
#define BLOCK_Heights BLOCK(Heights, uint, heights[])                        // (n x num_nodes), elastic layer: m as bits, depth/slots.glsl
#define BLOCK_NodeCells BLOCK(NodeCells, uint, node_cells[])                 // (n x num_nodes x kNodeCellWords), shared/elastic_layer.h
#define BLOCK_Windows BLOCK(Windows, uvec4, windows[])               // (n x tiles of heights): nodes under objects, as TileResult::window
#define BLOCK_Layer BLOCK(Layer, uvec2, layer[])                     // arrays over strips of nodes, kLayer...
#define BLOCK_TaxelStates BLOCK(TaxelStates, float, taxel_states[])  // (n x num_states x t), readout/lag.glsl
#define BLOCK_ImageWindows BLOCK(ImageWindows, uvec4, image_windows[])  // window of the step before: first row and column, their numbers
#define BLOCK_AxisPlays BLOCK(AxisPlays, float, axis_plays[])           // (n x 3 x t), N, three_axis.comp
#define BLOCK_Forces BLOCK(Forces, float, forces[])  // (n x t, features/taxel_words.glsl), N, that contact features are computed from
#define BLOCK_TaxelRegions BLOCK(TaxelRegions, uint, taxel_regions[])        // as Forces
#define BLOCK_RegionSums BLOCK(RegionSums, uint, region_sums[])              // as Forces
#define BLOCK_Regions BLOCK(Regions, uint, regions[])                        // (n x max_regions)
#define BLOCK_ContactCells BLOCK(ContactCells, CellRecord, contact_cells[])  // (n x t)
#define BLOCK_TileChanges BLOCK(TileChanges, float, tile_changes[])          // (n x num_tiles x LANES x kTileChanges)
#define BLOCK_TaxelJacobian BLOCK(TaxelJacobian, float, taxel_jacobian[])    // (n x 6 x t), N/m and N/rad
#define BLOCK_MaskedJacobian BLOCK(MaskedJacobian, float, masked_jacobian[])
#define BLOCK_WrenchJacobian BLOCK(WrenchJacobian, float, wrench_jacobian[])  // (n x num_tiles x 6 x 6)
#define BLOCK_LoopState BLOCK(LoopState, double, loop_state[])                // (values of a loop x n), passes/servo.h

// ---- a batch: results ----
#define BLOCK_Image BLOCK(Image, uint, image[])                         // (n x t), counts
#define BLOCK_TaxelCounts BLOCK(TaxelCounts, int, taxel_counts[])       // (n x t x 3), counts
#define BLOCK_SpreadNormal BLOCK(SpreadNormal, float, spread_normal[])  // (n x t), N
#define BLOCK_SpreadShear BLOCK(SpreadShear, float, spread_shear[])     // (n x t x 2), N
#define BLOCK_Features BLOCK(Features, float, features[])               // kFeature..., block after block
#define BLOCK_IntegerFeatures \
  BLOCK(IntegerFeatures, uint, integer_features[])  // integers and flags among the features, integer_features.comp
#define BLOCK_ContactFeatures BLOCK(ContactFeatures, float, features[])
#define BLOCK_TactileJacobian BLOCK(TactileJacobian, float, features[])           // kJacobian..., block after block
#define BLOCK_SpreadJacobian BLOCK(SpreadJacobian, float, spread_jacobian[])      // (n x 6 x t), N/m and N/rad
#define BLOCK_TwistGradient BLOCK(TwistGradient, float, twist_gradient[])         // (n x 6), per m and per rad
#define BLOCK_GainGradient BLOCK(GainGradient, float, gain_gradient[])            // (n x t)
#define BLOCK_ObjectPoses BLOCK(ObjectPoses, double, object_poses[])              // (n x 7), X_SO: position, m, rotation w, x, y, z
#define BLOCK_SensorPoses BLOCK(SensorPoses, double, sensor_poses[])              // (n x 7), X_WS in the same form
#define BLOCK_Actions BLOCK(Actions, double, actions[])                           // (n x 6), v, m/s, w, rad/s
#define BLOCK_RobotStatuses BLOCK(RobotStatuses, uint, robot_status[])            // (n), flags of RobotStatus
#define BLOCK_JointPositions BLOCK(JointPositions, double, joint_positions[])     // (n x num_joints), rad or m
#define BLOCK_JointVelocities BLOCK(JointVelocities, double, joint_velocities[])  // (n x num_joints), per s
#define BLOCK_Problems BLOCK(Problems, uint, problems[])                          // (1): 1 where a driver ended a loop early

// ---- host only: copied from, or bound in place of another block ----
#define BLOCK_EmptyWork \
  BLOCK(EmptyWork, uvec4, empty_work[])  // initial value of Work in every frame, and the row kSecondDispatch of a second dispatch
#define BLOCK_PastState BLOCK(PastState, uvec4, past_state[])                     // State, to be fetched as texels
#define BLOCK_PastTaxelStates BLOCK(PastTaxelStates, float, past_taxel_states[])  // TaxelStates, to be fetched as texels
#define BLOCK_LayerStrips BLOCK(LayerStrips, uvec4, layer_strips[])               // Layer, to be loaded four words at a time
#define BLOCK_ForceFours BLOCK(ForceFours, vec4, force_fours[])      // ContactNormal or MaskedNormal, to be loaded four taxels at a time
#define BLOCK_ResultFours BLOCK(ResultFours, uvec4, result_fours[])  // TileResults, to be loaded four words at a time
#define BLOCK_Triggers BLOCK(Triggers, float, triggers[])            // (t, padded to fours), N
#define BLOCK_CleanFeatureSource BLOCK(CleanFeatureSource, uint, feature_source)
#define BLOCK_CleanContactFeatures BLOCK(CleanContactFeatures, float, features[])
#define BLOCK_CleanTactileJacobian BLOCK(CleanTactileJacobian, float, features[])  // with the wrench's after that of the features
#define BLOCK_ServoFeatures BLOCK(ServoFeatures, float, servo_features[])          // Features or ContactFeatures

// All of them, for the host.
// clang-format off
#define ALL_BLOCKS                                                                                              \
  BLOCK_Objects BLOCK_Groups BLOCK_Clusters BLOCK_Quads BLOCK_Faces                                             \
  BLOCK_SensorBlock BLOCK_Patches BLOCK_Tiles BLOCK_Taxels BLOCK_SpreadRows BLOCK_SpreadScale BLOCK_Mask BLOCK_MaskScale         \
  BLOCK_Influence BLOCK_Planes BLOCK_Neighbours BLOCK_FeatureSource BLOCK_Triggers                                                                                 \
  BLOCK_Poses BLOCK_Motions BLOCK_Instances BLOCK_Step BLOCK_Loads BLOCK_Contacts BLOCK_NumContacts              \
  BLOCK_Cotangents BLOCK_ForceCotangents                                                                        \
  BLOCK_Servos BLOCK_Loop BLOCK_Robot BLOCK_LoopStarts BLOCK_LoopState                                          \
  BLOCK_JointPositions BLOCK_JointVelocities                                                                    \
  BLOCK_ObjectPoses BLOCK_SensorPoses BLOCK_Actions BLOCK_RobotStatuses BLOCK_ServoFeatures                      \
  BLOCK_Candidates BLOCK_CandidateQuads BLOCK_Work BLOCK_WorkInstances                                          \
  BLOCK_State BLOCK_FrictionState BLOCK_LawState BLOCK_ContactNormal BLOCK_MaskedNormal BLOCK_ContactShear BLOCK_ContactDepth       \
  BLOCK_TileResults BLOCK_Heights BLOCK_NodeCells BLOCK_Windows BLOCK_Layer BLOCK_TaxelStates BLOCK_ImageWindows BLOCK_AxisPlays \
  BLOCK_Forces BLOCK_TaxelRegions BLOCK_RegionSums BLOCK_Regions                                                \
  BLOCK_ContactCells BLOCK_TileChanges BLOCK_TaxelJacobian BLOCK_MaskedJacobian BLOCK_WrenchJacobian             \
  BLOCK_Image BLOCK_TaxelCounts BLOCK_SpreadNormal BLOCK_SpreadShear BLOCK_Features BLOCK_ContactFeatures BLOCK_TactileJacobian    \
  BLOCK_SpreadJacobian BLOCK_TwistGradient BLOCK_GainGradient BLOCK_Problems BLOCK_IntegerFeatures BLOCK_IntegerRows BLOCK_LoadBounds \
  BLOCK_InputIds BLOCK_InputPoses BLOCK_InputLoads BLOCK_InputPositions BLOCK_InputForces BLOCK_InputCounts BLOCK_InputProblems BLOCK_PlacedPoses                                                                     \
  BLOCK_EmptyWork BLOCK_PastState BLOCK_PastTaxelStates BLOCK_LayerStrips BLOCK_ForceFours BLOCK_ResultFours BLOCK_CleanFeatureSource BLOCK_CleanContactFeatures BLOCK_CleanTactileJacobian
// clang-format on
