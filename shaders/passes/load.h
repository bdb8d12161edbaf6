// Load search over all tiles of a sensor, load.comp.

CONSTANT(11, uint, EVALUATIONS)  // after which the search closes with the best it has
CONSTANT(12, bool, NEWTON)       // tile_results have the slope of the force, kSumsSlopes
CONSTANT(13, float, FIRST_STEP)  // m, of Newton's method

TEXELS(0, Instances)
UNIFORM(1, Step)
TEXELS(2, TileResults)
BUFFER(3, readwrite, Loads)
