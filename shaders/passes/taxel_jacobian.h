// Tactile Jacobian, forces of taxels, taxel_jacobian.comp.

CONSTANT(11, bool, SCALED)  // as in contact.h

UNIFORM(0, Step)
BUFFER(1, readonly, Patches)
BUFFER(2, readonly, Taxels)
BUFFER(3, readonly, SpreadScale)
TEXELS(4, ContactCells)
BUFFER(5, writeonly, TaxelJacobian)
BUFFER(6, readonly, Instances)
