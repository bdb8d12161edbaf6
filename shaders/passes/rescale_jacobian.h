// Tactile Jacobian of the law deformation_mask, through its rescaling, rescale_jacobian.comp.

CONSTANT(11, bool, SCALED)  // as in contact.h

UNIFORM(0, Step)
BUFFER(1, readonly, SpreadScale)
BUFFER(2, readonly, LawState)
TEXELS(3, TileResults)
BUFFER(4, readonly, MaskedJacobian)
BUFFER(5, readwrite, TaxelJacobian)
BUFFER(6, writeonly, Problems)
TEXELS(7, Instances)
