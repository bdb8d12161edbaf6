// Contacts from another engine, contacts.comp.

CONSTANT(11, uint, NUM_PATCHES)
CONSTANT(12, bool, FLAT)        // the frame of the one patch is S
CONSTANT(13, float, THICKNESS)  // m
CONSTANT(14, bool, SCALED)      // sources near a border give more to the taxels that are there, readout/spread.glsl
CONSTANT(15, uint, TEAM)        // invocations that share an instance

UNIFORM(0, Step)
BUFFER(1, readonly, Contacts)
BUFFER(2, readonly, NumContacts)
TEXELS(3, Patches)
BUFFER(4, readonly, SpreadScale)
BUFFER(5, readwrite, ContactNormal)
BUFFER(6, writeonly, TileResults)
BUFFER(7, writeonly, Features)
BUFFER(8, writeonly, Problems)
TEXELS(9, Instances)
