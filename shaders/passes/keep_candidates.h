// Lists of instances by what is to be done about their candidates, keep_candidates.comp. FLAT, OUTPUT_JACOBIAN, REACH and AREA as in
// contact.h.

CONSTANT(11, bool, FLAT)
CONSTANT(12, bool, OUTPUT_JACOBIAN)
CONSTANT(13, float, REACH)
CONSTANT(14, uint, LISTED_PER_WORKGROUP)  // instances of a list that one workgroup of the contact pass processes
CONSTANT(15, bool, AREA)
CONSTANT(16, uint, FOUND_PER_WORKGROUP)  // the same of find_candidates.comp

TEXELS(0, Poses)
UNIFORM(1, Step)
TEXELS(2, Objects)
TEXELS(3, Patches)
BUFFER(4, readonly, Tiles)
BUFFER(5, readwrite, Candidates)
BUFFER(6, readwrite, Work)
BUFFER(7, writeonly, WorkInstances)
