// Tactile Jacobian, wrenches of tiles, wrench_jacobian.comp.

CONSTANT(11, bool, HAS_FORCES)  // the law has forces, and a wrench

UNIFORM(0, Step)
BUFFER(1, readonly, Patches)
BUFFER(2, readonly, Tiles)
BUFFER(3, readonly, TileChanges)
BUFFER(4, writeonly, WrenchJacobian)
BUFFER(5, readonly, Instances)
