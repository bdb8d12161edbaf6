// Load search over all tiles of a sensor, load.comp.

CONSTANT(11, uint, EVALUATIONS)  // after which the search closes with the best it has
CONSTANT(12, bool, NEWTON)       // tile_results have the slope of the force, kSumsSlopes
CONSTANT(13, float, FIRST_STEP)  // m, of Newton's method

BUFFER(0, readonly, Instances)
UNIFORM(1, Step)
BUFFER(2, readonly, TileResults)
BUFFER(3, readwrite, Loads)
