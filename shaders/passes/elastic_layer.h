// Elastic layer, elastic_layer.comp.

CONSTANT(11, uint, NODE_ROWS)
CONSTANT(12, uint, NODE_COLS)
CONSTANT(13, uint, MARGIN_ROWS)  // nodes of the margin on either side
CONSTANT(14, uint, MARGIN_COLS)
CONSTANT(15, float, THICKNESS)   // m
CONSTANT(16, float, REACH)       // gaps that matter, in depths of the deepest node
CONSTANT(17, float, NODE_FORCE)  // force of a node under a pressure that moves its own cell by a thickness, N
CONSTANT(18, uint, ITERATIONS)
CONSTANT(19, float, TOLERANCE)             // the solver ends when contact_residual is no larger
CONSTANT(20, uint, NUM_HEIGHT_TILES)       // tiles of the heights pass
CONSTANT(21, bool, LOADS)                  // some instance is driven by load
CONSTANT(22, bool, OUTPUT_DEPTH)           // writes contact_depth
CONSTANT(23, bool, KEEPS_SLOTS)            // as in passes/depth.h
CONSTANT(24, bool, FRICTION)               // shear with memory, skin/friction.glsl
CONSTANT(25, float, TANGENTIAL_STIFFNESS)  // N/m^3
CONSTANT(26, float, FRICTION_COEFFICIENT)
CONSTANT(27, bool, OUTPUT_SHEAR)     // writes contact_shear
CONSTANT(28, uint, RELAXATION)       // terms of the skin's relaxation
CONSTANT(29, bool, OUTPUT_JACOBIAN)  // writes taxel_jacobian and wrench_jacobian, elastic_layer/jacobian.glsl
CONSTANT(30, bool, AREA)             // nodes are partly covered cells, elastic_layer/cells.glsl, which uses the following
CONSTANT(31, float, CELL_DISC)       // compliances over a whole cell's
CONSTANT(32, float, CELL_FREE)
CONSTANT(33, float, CELL_BASE)
CONSTANT(34, float, POINT_COMPLIANCE)  // compliance of a point, times distance, m
CONSTANT(35, float, IMAGE_DEPTH)       // depth of the image of a load under the base, m; 0 without a base

TEXELS(0, Instances)
UNIFORM(1, Step)
UNIFORM(2, SensorBlock)
TEXELS(3, Heights)
BUFFER(4, readonly, Windows)
TEXELS(5, Influence)
BUFFER(6, readonly, SpreadScale)
BUFFER(7, coherent, Layer)
BUFFER(8, writeonly, ContactNormal)
BUFFER(9, writeonly, ContactDepth)
BUFFER(10, writeonly, TileResults)
BUFFER(11, readwrite, Loads)
BUFFER(12, writeonly, Features)
BUFFER(13, writeonly, Problems)
TEXELS(14, Motions)
BUFFER(15, coherent, FrictionState)
BUFFER(16, writeonly, ContactShear)
BUFFER(17, writeonly, TaxelJacobian)
BUFFER(18, writeonly, WrenchJacobian)
BUFFER(19, readonly, NodeCells)
COHERENT_TEXELS(20, LayerStrips)  // Layer
