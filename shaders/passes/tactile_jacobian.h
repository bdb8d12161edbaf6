// Tactile Jacobian of the features, tactile_jacobian.comp.

VALUE(kMostSums, 7)  // sums of any scan

CONSTANT(11, bool, CLEAN)
CONSTANT(12, uint, TEAM)                     // invocations that share a part
CONSTANT(13, uint, PATCHES)                  // rows of patches
CONSTANT(14, uint, LAST_PLANE)               // that of S
CONSTANT(15, uint, PARTIALS)                 // kMostSums x LANES for every team of more than one invocation
CONSTANT(16, uint, NUM_ENTRIES)              // entries of a taxel's list of sources, where the sensor is not one grid patch
CONSTANT(17, float, TRIGGER)                 // N, of the nominal curve
CONSTANT(18, float, SATURATION_FORCE)        // N over the trigger at which a taxel saturates
CONSTANT(19, bool, RANDOM)                   // some instance draws gains
CONSTANT(20, float, DEAD_TAXEL_PROBABILITY)  // probability
CONSTANT(21, bool, SAME_READOUT)             // all taxels have the gain and the trigger of the first

TEXELS(0, Instances)
UNIFORM(1, Step)
BUFFER(2, readonly, Taxels)
TEXELS(3, Planes)
BUFFER(4, readonly, SpreadRows)
TEXELS(5, SpreadNormal)
TEXELS(6, TaxelJacobian)
BUFFER(7, readonly, WrenchJacobian)
BUFFER(8, writeonly, TactileJacobian)
BUFFER(9, writeonly, Problems)
