// Tactile Jacobian, forces of taxels, taxel_jacobian.comp.

CONSTANT(11, bool, SCALED)  // as in contact.h

UNIFORM(0, Step)
TEXELS(1, Patches)
BUFFER(2, readonly, Taxels)
BUFFER(3, readonly, SpreadScale)
TEXELS(4, ContactCells)
BUFFER(5, writeonly, TaxelJacobian)
TEXELS(6, Instances)
