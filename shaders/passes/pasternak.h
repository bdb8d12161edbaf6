// Two-parameter foundation, pasternak.comp.

CONSTANT(11, uint, NODES_PER_SAMPLE)  // along each side
CONSTANT(12, float, THICKNESS)        // m
CONSTANT(13, float, SPRING)           // of a node, N/m
CONSTANT(14, float, LINK_X)           // between neighbours along x of P, N/m
CONSTANT(15, float, LINK_Y)
CONSTANT(16, float, DECAY_X)  // of the free surface over a spacing
CONSTANT(17, float, DECAY_Y)
CONSTANT(18, float, OVER_RELAXATION)  // of a sweep
CONSTANT(19, uint, SWEEPS)
CONSTANT(20, uint, MARGIN)            // nodes around the overlap that move, at least
CONSTANT(21, uint, NUM_HEIGHT_TILES)  // of the contact pass
CONSTANT(22, bool, LOADS)             // some instance is driven by load
CONSTANT(23, bool, OUTPUT_DEPTH)      // writes contact_depth
CONSTANT(24, bool, AREA)              // outlines cut links, common/cut_links.glsl

VALUE(kBlockRows, 4)  // nodes of a block, pasternak/blocks.glsl
VALUE(kBlockCols, 16)

TEXELS(0, Instances)
UNIFORM(1, Step)
UNIFORM(2, SensorBlock)
TEXELS(3, Heights)
TEXELS(4, Windows)
BUFFER(5, readonly, SpreadScale)
BUFFER(6, coherent, Foundation)
BUFFER(7, writeonly, ContactNormal)
BUFFER(8, writeonly, ContactDepth)
BUFFER(9, writeonly, TileResults)
BUFFER(10, readwrite, Loads)
BUFFER(11, writeonly, Features)
BUFFER(12, writeonly, Problems)
BUFFER(13, readonly, NodeCells)
COHERENT_TEXELS(14, FoundationRows)  // Foundation
