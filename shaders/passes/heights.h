// Heights pass, heights.comp, after passes/depth.h. With AREA this run writes node_cells instead of heights.

CONSTANT(24, float, REACH)     // height over the skin, m, up to which surfaces matter to the law
CONSTANT(25, bool, HAS_CELLS)  // the run with AREA follows, which may find cells outside the window of the heights

BUFFER(15, writeonly, Heights)
BUFFER(16, readwrite, Windows)
BUFFER(17, writeonly, NodeCells)
