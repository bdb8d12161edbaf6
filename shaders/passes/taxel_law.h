// Passes over taxels that some laws run between contact and image: mass_spring_damper.comp, deformation_mask.comp, rescale.comp,
// proximity.comp.

CONSTANT(11, bool, SCALED)  // as in contact.h; the contact pass leaves the scale to these passes
CONSTANT(12, float, LAW_0)  // parameters of the law
CONSTANT(13, float, LAW_1)
CONSTANT(14, bool, SHEAR)  // contact_shear is an output
CONSTANT(15, float, FRICTION_COEFFICIENT)
CONSTANT(16, uint, MASK_SOURCES)  // of a taxel; even

BUFFER(0, readonly, Instances)
BUFFER(1, readonly, Step)
BUFFER(2, readonly, SpreadScale)
TEXELS(3, Mask)
BUFFER(4, readwrite, ContactNormal)
BUFFER(5, readwrite, LawState)
BUFFER(6, readwrite, TileResults)
BUFFER(7, readonly, Taxels)
BUFFER(8, writeonly, Problems)
BUFFER(9, readwrite, ContactShear)
