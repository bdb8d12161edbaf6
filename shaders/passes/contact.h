// Contact pass, contact.comp, after passes/depth.h.

CONSTANT(24, bool, HAS_STATE)     // the law needs the depth of the step before
CONSTANT(25, bool, SCALED)        // sources near a border give more to the taxels that are there, readout/spread.glsl
CONSTANT(26, bool, OUTPUT_DEPTH)  // writes contact_depth
CONSTANT(27, float, STIFFNESS)    // Pa/m^EXPONENT; parameters of skin/law.glsl
CONSTANT(28, float, EXPONENT)
CONSTANT(29, float, DAMPING)               // Pa s/m
CONSTANT(30, bool, FRICTION)               // shear with memory, skin/friction.glsl
CONSTANT(31, float, TANGENTIAL_STIFFNESS)  // N/m^3
CONSTANT(32, float, FRICTION_COEFFICIENT)
CONSTANT(33, bool, OUTPUT_SHEAR)        // writes contact_shear
CONSTANT(34, bool, BRISTLES)            // shear by the law lugre, skin/law.glsl, whose parameters follow
CONSTANT(35, float, BRISTLE_STIFFNESS)  // 1/m
CONSTANT(36, float, BRISTLE_DAMPING)    // s/m
CONSTANT(37, float, VISCOUS_FRICTION)   // s/m
CONSTANT(38, float, STATIC_FRICTION)
CONSTANT(39, float, COULOMB_FRICTION)
CONSTANT(40, float, STRIBECK_VELOCITY)    // m/s
CONSTANT(41, uint, RELAXATION)            // terms of the skin's relaxation, skin/sample_states.glsl
CONSTANT(42, bool, OUTPUT_JACOBIAN)       // writes contact_cells, skin/cell_fluxes.glsl
CONSTANT(43, bool, EARLY_EXIT)            // where no object is near: kLeavesUntouched, kManySmallTiles
CONSTANT(44, bool, IS_LAST)               // writes contact_normal and tile_results for the spread; no taxel pass follows
CONSTANT(45, bool, RANDOM_SKIN)           // every instance has its own factors on stiffness and friction
CONSTANT(46, uint, NUM_STATES)            // words that a sample keeps between steps, skin/sample_states.glsl
CONSTANT(47, bool, SELECTS_KINDS)         // processes only the instances whose one object is of OBJECT_KINDS
CONSTANT(48, uint, MOST_ITERATIONS)       // iterations after which a workgroup leaves its other tiles to a second dispatch; 0: never
CONSTANT(49, bool, OUTPUT_WRENCH_CHANGE)  // with OUTPUT_JACOBIAN, writes tile_changes, from which the wrench's derivatives follow

TEXELS(15, SpreadScale)
BUFFER(16, readwrite, State)
TEXELS(17, PastState)
TEXELS(18, Motions)
BUFFER(19, writeonly, ContactNormal)
BUFFER(20, writeonly, ContactShear)
BUFFER(21, writeonly, ContactDepth)
BUFFER(22, readwrite, TileResults)
TEXELS(23, ResultFours)
BUFFER(24, readwrite, Loads)
BUFFER(25, writeonly, ContactCells)
BUFFER(26, writeonly, TileChanges)
