// Constants that follow from those of passes/depth.h. They leave out the code that a model, sensor or batch does not need
// (driver/README.md).

#include "driver/constants.glsl"

const bool kHasMesh = (OBJECT_KINDS & 1u) != 0;
const bool kHasAnalytic = (OBJECT_KINDS & ~1u) != 0;
// Estimated iterations of one invocation: shared/iterations.h.
const uint kIterationsOfSample = AREA                                       ? kIterationsPerCell
                                 : (OBJECT_KINDS & (1u << kKindTorus)) != 0 ? kIterationsPerSampleOfTorus
                                                                            : kIterationsPerSample;
const uint kIterationsOfTriangle = AREA ? kIterationsPerTriangleOfCells : kIterationsPerTriangle;
const bool kOnlyPolyhedra = OBJECT_KINDS == (1u << kKindPolyhedron);
// Heights go through the tile, except for a single analytic solid, whose heights are computed where they are summed. A torus needs the tile
// since its heights are expensive; the Jacobian needs it where the words of the neighbours of a row of samples do not fit into RowWords,
// skin/tile_pressures.glsl.
const bool kReadsNeighbours = BOTH(OUTPUT_JACOBIAN, SAMPLES > 4u);
bool usesTile() {
  return AREA || kReadsNeighbours || kHasMesh || MANY_SLOTS || SEARCH == kSearchInTile || (OBJECT_KINDS & (1u << kKindTorus)) != 0;
}

// How triangles are drawn: depth/raster.glsl, depth/area/facets.glsl. The constant TRIANGLE_SIZES removes the ways that the model does not
// need, and the test of the only one.
const uint kBySamples = 1u, kBySpans = 2u, kBySums = 4u, kByLargeSums = 8u;
bool isDrawn(uint way, bool wanted) { return TRIANGLE_SIZES == way || ((TRIANGLE_SIZES & way) != 0 && wanted); }
