// Integers and flags for importers of the device's memory, integer_features.comp.

CONSTANT(11, uint, SOURCE)  // the source of the arrays that are written

VALUE(kFlags, 256u)  // added to the source of an array of flags, which has a byte per flag

BUFFER(0, readonly, IntegerRows)
BUFFER(1, readonly, Features)
BUFFER(2, writeonly, IntegerFeatures)
