// Passes over taxels that some laws run between contact and image: mass_spring_damper.comp, proximity.comp.

CONSTANT(11, bool, SCALED)  // as in contact.h; the contact pass leaves the scale to these passes
CONSTANT(12, float, LAW_0)  // parameters of the law
CONSTANT(13, float, LAW_1)
CONSTANT(14, bool, SHEAR)  // contact_shear is an output
CONSTANT(15, float, FRICTION_COEFFICIENT)

TEXELS(0, Instances)
UNIFORM(1, Step)
BUFFER(2, readonly, SpreadScale)
BUFFER(3, readwrite, ContactNormal)
BUFFER(4, readwrite, LawState)
BUFFER(5, readwrite, TileResults)
BUFFER(6, writeonly, Problems)
BUFFER(7, readwrite, ContactShear)
TEXELS(8, ForceFours)   // ContactNormal
TEXELS(9, ResultFours)  // TileResults
