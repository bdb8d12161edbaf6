// Search for candidates, find_candidates.comp. All constants as in contact.h.

CONSTANT(11, bool, FLAT)
CONSTANT(12, bool, OUTPUT_JACOBIAN)
CONSTANT(13, float, REACH)
CONSTANT(14, uint, GROUPS_PER_BATCH)
CONSTANT(15, bool, AREA)
CONSTANT(16, uint, LISTED_PER_WORKGROUP)  // instances of a list that one workgroup of the contact pass processes

TEXELS(0, Poses)
UNIFORM(1, Step)
TEXELS(2, Objects)
TEXELS(3, Groups)
TEXELS(4, Clusters)
TEXELS(5, Quads)
TEXELS(6, Patches)
BUFFER(7, readonly, Tiles)
BUFFER(8, readwrite, Candidates)
BUFFER(9, writeonly, CandidateQuads)
BUFFER(10, readwrite, Work)
BUFFER(11, readwrite, WorkInstances)
BUFFER(12, writeonly, Problems)
