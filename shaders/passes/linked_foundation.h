// Two-parameter foundation on several patches, linked_foundation.comp.

CONSTANT(11, uint, NODES_PER_SAMPLE)  // along each side
CONSTANT(12, float, THICKNESS)        // m
CONSTANT(13, float, OVER_RELAXATION)  // of a sweep
CONSTANT(14, uint, SWEEPS)
CONSTANT(15, uint, NUM_COLORS)        // of nodes
CONSTANT(16, uint, MOST_OF_COLOR)     // nodes of one color in a block
CONSTANT(17, uint, NUM_FOURS)         // fours of links of a node, at most
CONSTANT(18, uint, NUM_HEIGHT_TILES)  // of the contact pass
CONSTANT(19, bool, LOADS)             // some instance is driven by load
CONSTANT(20, bool, OUTPUT_DEPTH)      // writes contact_depth
CONSTANT(21, uint, BLOCKS_PER_TAXEL)
CONSTANT(22, bool, AREA)  // outlines cut links, common/cut_links.glsl

TEXELS(0, Instances)
UNIFORM(1, Step)
TEXELS(2, Patches)
BUFFER(3, readonly, Heights)
BUFFER(4, readonly, Windows)
BUFFER(5, readonly, SpreadScale)
TEXELS(6, FoundationNodes)
TEXELS(7, FoundationLinks)
BUFFER(8, readonly, FoundationBlocks)
BUFFER(9, readonly, NearBlocks)
BUFFER(10, coherent, Foundation)
BUFFER(11, writeonly, ContactNormal)
BUFFER(12, writeonly, ContactDepth)
BUFFER(13, writeonly, TileResults)
BUFFER(14, readonly, Loads)
BUFFER(15, writeonly, Features)
BUFFER(16, writeonly, Problems)
BUFFER(17, readonly, NodeCells)
