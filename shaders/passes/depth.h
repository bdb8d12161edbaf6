// Stage 1, shared by the contact pass and the heights pass: which surfaces a tile sees, and how. Their own lists go on.

VALUE(kNoSearch, 0)         // no instance is driven by load
VALUE(kSearchInTile, 1)     // the search runs over the one tile, in the pass or in the elastic layer after it
VALUE(kSearchOverTiles, 2)  // load.comp searches over all tiles
VALUE(kSearchEnded, 3)      // the frame at the offsets that a search has found

CONSTANT(11, uint, TILE_SAMPLES)      // most samples of a tile
CONSTANT(12, bool, FLAT)              // the frame of the one patch is S
CONSTANT(13, uint, SEARCH)            // kNoSearch, kSearchInTile ...
CONSTANT(14, float, THICKNESS)        // m
CONSTANT(15, bool, MANY_SLOTS)        // several objects may be near an instance
CONSTANT(16, uint, OBJECT_KINDS)      // bit per kind of object in the model
CONSTANT(17, uint, TRIANGLE_SIZES)    // bit 0: meshes of small triangles, bit 1: of large ones, bits 2 and 3: closed ones, with AREA
CONSTANT(18, uint, NUM_FACES)         // faces of each polyhedron; shorter ones repeat some
CONSTANT(19, uint, GROUPS_PER_BATCH)  // groups of clusters culled between two barriers; the list of clusters has room for all of theirs
CONSTANT(20, uint, LIST)              // instances that are processed: kListWholeMesh, kListCandidates; kNumLists: all
CONSTANT(21, bool, AREA)              // the depth of a sample is the mean over its cell, depth/area/cell_depths.glsl
CONSTANT(22, bool, VARIATION)         // with AREA: cells know how the depth varies within them
CONSTANT(23, bool, KEEPS_SLOTS)       // words of samples hold the slot of their object, for friction with several objects

TEXELS(0, Poses)
TEXELS(1, Instances)
UNIFORM(2, Step)
TEXELS(3, Objects)
TEXELS(4, Groups)
TEXELS(5, Clusters)
TEXELS(6, Quads)
TEXELS(7, Faces)
TEXELS(8, Patches)
BUFFER(9, readonly, Tiles)
BUFFER(10, readonly, Candidates)
TEXELS(11, CandidateQuads)
BUFFER(12, readwrite, Work)
BUFFER(13, readwrite, WorkInstances)
BUFFER(14, writeonly, Problems)
