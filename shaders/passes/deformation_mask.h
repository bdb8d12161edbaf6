// Pass of the law deformation_mask, deformation_mask.comp.

CONSTANT(11, bool, SCALED)           // as in contact.h
CONSTANT(12, float, LAW_0)           // saturation pressure, Pa
CONSTANT(13, uint, MASK_SOURCES)     // sources of a taxel, even, where the sensor is not one grid patch
CONSTANT(14, uint, TEAM)             // invocations that share an instance
CONSTANT(15, uint, PARTIALS)         // LANES for every team of more than one invocation
CONSTANT(16, bool, OUTPUT_RESPONSE)  // writes law_state, for the tactile Jacobian

TEXELS(0, Instances)
UNIFORM(1, Step)
BUFFER(2, readonly, SpreadScale)
TEXELS(3, Mask)
BUFFER(4, readonly, ContactNormal)
TEXELS(5, TileResults)
BUFFER(6, readonly, Taxels)
BUFFER(7, writeonly, LawState)
BUFFER(8, readwrite, MaskedNormal)
BUFFER(9, writeonly, Problems)
TEXELS(10, ForceFours)  // ContactNormal
