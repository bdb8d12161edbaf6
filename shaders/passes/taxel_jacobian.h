// Tactile Jacobian, forces of taxels and wrenches of tiles, taxel_jacobian.comp.

CONSTANT(11, bool, SCALED)      // as in contact.h
CONSTANT(12, bool, HAS_FORCES)  // the law has forces, and a wrench

BUFFER(0, readonly, Step)
BUFFER(1, readonly, Patches)
BUFFER(2, readonly, Tiles)
BUFFER(3, readonly, Taxels)
BUFFER(4, readonly, SpreadScale)
BUFFER(5, readonly, ContactCells)
BUFFER(6, readonly, TileChanges)
BUFFER(7, writeonly, TaxelJacobian)
BUFFER(8, writeonly, WrenchJacobian)
BUFFER(9, readonly, Instances)
