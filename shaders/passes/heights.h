// Heights pass, heights.comp. Its other constants are in passes/depth.h; AREA: this run writes node_cells instead of heights.

CONSTANT(24, float, REACH)     // height over the skin, m, up to which surfaces matter to the law
CONSTANT(25, bool, HAS_CELLS)  // the run with AREA follows, which may find cells outside the window of the heights

TEXELS(0, Poses)
TEXELS(1, Instances)
UNIFORM(2, Step)
TEXELS(3, Objects)
TEXELS(4, Groups)
TEXELS(5, Clusters)
TEXELS(6, Quads)
TEXELS(7, Patches)
BUFFER(8, readonly, Tiles)
TEXELS(9, Faces)
BUFFER(10, readonly, Candidates)
TEXELS(11, CandidateQuads)
BUFFER(12, readwrite, Work)
BUFFER(13, readwrite, WorkInstances)
BUFFER(14, writeonly, Heights)
BUFFER(15, readwrite, Windows)
BUFFER(16, writeonly, NodeCells)
BUFFER(17, writeonly, Problems)
