// Tactile Jacobian of the law deformation_mask, through its mask, mask_jacobian.comp.

CONSTANT(11, float, LAW_0)        // saturation pressure, Pa
CONSTANT(12, uint, MASK_SOURCES)  // sources of a taxel, even

UNIFORM(0, Step)
TEXELS(1, Mask)
BUFFER(2, readonly, Taxels)
BUFFER(3, readonly, LawState)
BUFFER(4, readonly, TaxelJacobian)
BUFFER(5, writeonly, MaskedJacobian)
TEXELS(6, Instances)
