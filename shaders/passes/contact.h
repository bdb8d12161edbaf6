// Contact pass, contact.comp.

VALUE(kNoSearch, 0)         // no instance is driven by load
VALUE(kSearchInTile, 1)     // the pass searches over its one tile
VALUE(kSearchOverTiles, 2)  // load.comp searches over all tiles
VALUE(kSearchEnded, 3)      // the frame at the offsets that a search has found

CONSTANT(11, uint, TILE_SAMPLES)  // most samples of a tile
CONSTANT(12, bool, FLAT)          // the frame of the one patch is S
CONSTANT(13, bool, HAS_STATE)     // the law needs the depth of the step before
CONSTANT(14, uint, SEARCH)        // kNoSearch, kSearchInTile ...
CONSTANT(15, float, THICKNESS)    // m
CONSTANT(16, bool, SCALED)        // sources near a border give more to the taxels that are there, readout/spread.glsl
CONSTANT(17, bool, MANY_SLOTS)    // several objects may be near an instance
CONSTANT(18, uint, OBJECT_KINDS)  // bit per kind of object in the model
CONSTANT(19, uint,
         TRIANGLE_SIZES)  // bit 0: meshes of small triangles, bit 1: of large ones, bits 2 and 3: the same for closed ones, with AREA
CONSTANT(20, bool, OUTPUT_DEPTH)  // writes contact_depth
CONSTANT(21, uint, NUM_FACES)     // of each polyhedron; shorter ones repeat some
CONSTANT(22, float, LAW_0)        // parameters of the contact law, skin/laws/
CONSTANT(23, float, LAW_1)
CONSTANT(24, float, LAW_2)
CONSTANT(25, bool, FRICTION)               // shear with memory, skin/friction.glsl
CONSTANT(26, float, TANGENTIAL_STIFFNESS)  // N/m^3
CONSTANT(27, float, FRICTION_COEFFICIENT)
CONSTANT(28, bool, OUTPUT_SHEAR)        // writes contact_shear
CONSTANT(29, bool, BRISTLES)            // shear by the law lugre, skin/laws/lugre.glsl, whose parameters follow
CONSTANT(30, float, BRISTLE_STIFFNESS)  // 1/m
CONSTANT(31, float, BRISTLE_DAMPING)    // s/m
CONSTANT(32, float, VISCOUS_FRICTION)   // s/m
CONSTANT(33, float, STATIC_FRICTION)
CONSTANT(34, float, COULOMB_FRICTION)
CONSTANT(35, float, STRIBECK_VELOCITY)  // m/s
CONSTANT(36, uint, RELAXATION)          // terms of the skin's relaxation, skin/relaxation.glsl
CONSTANT(37, uint, GROUPS_PER_BATCH)    // groups of clusters culled between two barriers; the list of clusters has room for all of theirs
CONSTANT(38, bool, OUTPUT_JACOBIAN)     // writes contact_cells, skin/cell_fluxes.glsl
CONSTANT(39, bool, EARLY_EXIT)          // where no object is near: kLeavesUntouched, kManySmallTiles
CONSTANT(40, float, REACH)              // up to which height over the skin surfaces matter to the law, m
CONSTANT(41, uint, LIST)                // of instances that are processed: kListWholeMesh, kListCandidates; kNumLists: all
CONSTANT(42, bool, IS_LAST)             // writes contact_normal and tile_results for the spread; no taxel pass follows
CONSTANT(43, bool, AREA)                // the depth of a sample is the mean over its cell, depth/area/cell_depths.glsl
CONSTANT(44, bool, RANDOM_SKIN)         // every instance has factors of its own on stiffness and friction
CONSTANT(45, bool, VARIATION)           // with AREA, for friction and exponents: cells know how the depth varies within them
CONSTANT(46, bool, KEEPS_SLOTS)         // an instance has several slots, of which friction knows which object it was with
CONSTANT(47, bool, HAS_CELLS)           // the law is coupled and sampled by area: the pass runs again, with AREA, and adds node_cells
CONSTANT(48, uint, NUM_STATES)          // words that a sample keeps between steps, skin/sample_states.glsl
CONSTANT(49, bool, SELECTS_KINDS)       // the dispatch processes the instances whose one object is of OBJECT_KINDS; others process the rest
CONSTANT(50, uint,
         MOST_ITERATIONS)  // after which a workgroup leaves its other tiles to a second dispatch, depth/tile_sequence.glsl; 0: never
CONSTANT(51, bool, OUTPUT_WRENCH_CHANGE)  // with OUTPUT_JACOBIAN, writes tile_changes, from which the wrench's derivatives follow

TEXELS(0, Poses)
TEXELS(1, Instances)
UNIFORM(2, Step)
TEXELS(3, Objects)
TEXELS(4, Groups)
TEXELS(5, Clusters)
TEXELS(6, Quads)
TEXELS(7, Patches)
BUFFER(8, readonly, Tiles)
TEXELS(9, SpreadScale)
BUFFER(10, readwrite, State)
BUFFER(11, writeonly, ContactNormal)  // Heights for globally coupled laws
BUFFER(12, writeonly, ContactDepth)
BUFFER(13, readwrite, TileResults)  // Windows for globally coupled laws
BUFFER(14, readwrite, Loads)
BUFFER(15, writeonly, Problems)
TEXELS(16, Faces)
TEXELS(17, Motions)
TEXELS(18, PastState)
BUFFER(19, writeonly, ContactShear)
BUFFER(20, writeonly, ContactCells)
BUFFER(21, writeonly, TileChanges)
BUFFER(22, readonly, Candidates)
TEXELS(23, CandidateQuads)
BUFFER(24, readwrite, Work)
BUFFER(25, readwrite, WorkInstances)
BUFFER(26, writeonly, NodeCells)
TEXELS(27, ResultFours)
