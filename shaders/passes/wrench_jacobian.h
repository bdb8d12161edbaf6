// Tactile Jacobian, wrenches of tiles, wrench_jacobian.comp.

CONSTANT(11, bool, HAS_FORCES)  // the law has forces, and a wrench

UNIFORM(0, Step)
TEXELS(1, Patches)
BUFFER(2, readonly, Tiles)
BUFFER(3, readonly, TileChanges)
BUFFER(4, writeonly, WrenchJacobian)
TEXELS(5, Instances)
