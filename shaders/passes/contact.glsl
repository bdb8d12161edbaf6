// Constants and buffers of the contact pass. makeContactKernel() in src/simulation/model.cpp lists the constants in the same order.

#include "shared/batch.h"
#include "shared/candidates.h"
#include "shared/objects.h"
#include "shared/sensor.h"

layout(constant_id = 11) const uint TILE_SAMPLES = 1344;  // most samples of a tile
layout(constant_id = 12) const bool FLAT = true;          // the one patch's frame is the sensor's
layout(constant_id = 13) const bool HAS_STATE = false;    // the law needs the depth of the step before
layout(constant_id = 14) const uint SEARCH = 0;          // load search: kNoSearch, kSearchInTile, kSearchOverTiles
layout(constant_id = 15) const float THICKNESS = 0.002;  // m
layout(constant_id = 16) const bool SCALED = true;       // sources near a border give more to the taxels that are there, readout/spread.glsl
layout(constant_id = 17) const bool MANY_SLOTS = false;  // an instance may touch several objects
layout(constant_id = 18) const uint KINDS = 1;           // bit per kind of object in the model
layout(constant_id = 19) const uint TRIANGLES = 3;       // bit 0: meshes of small triangles, bit 1: of large ones
layout(constant_id = 20) const bool OUTPUT_DEPTH = false;  // contact_depth is wanted
layout(constant_id = 21) const uint FACES = 1;           // of each polyhedron, some perhaps listed twice
layout(constant_id = 22) const float LAW_0 = 1.73e8;     // parameters of the contact law, skin/laws/
layout(constant_id = 23) const float LAW_1 = 1.0;
layout(constant_id = 24) const float LAW_2 = 0.0;
layout(constant_id = 25) const bool FRICTION = false;     // shear with memory, skin/friction.glsl
layout(constant_id = 26) const float TANGENTIAL_STIFFNESS = 1e8;  // N/m^3
layout(constant_id = 27) const float FRICTION_COEFFICIENT = 1.0;
layout(constant_id = 28) const bool OUTPUT_SHEAR = false;  // contact_shear is wanted
layout(constant_id = 29) const bool BRISTLES = false;     // that shear is of the law lugre, skin/laws/lugre.glsl; its parameters
layout(constant_id = 30) const float BRISTLE_STIFFNESS = 1e5;  // 1/m
layout(constant_id = 31) const float BRISTLE_DAMPING = 316.0;  // s/m
layout(constant_id = 32) const float VISCOUS_FRICTION = 0.4;   // s/m
layout(constant_id = 33) const float STATIC_FRICTION = 1.5;
layout(constant_id = 34) const float COULOMB_FRICTION = 1.0;
layout(constant_id = 35) const float STRIBECK_VELOCITY = 1e-3;  // m/s
layout(constant_id = 36) const uint RELAXATION = 0;  // terms of the skin's relaxation, skin/relaxation.glsl
layout(constant_id = 37) const uint GROUPS_PER_BATCH = 32;  // groups are culled a batch at a time, so that the list of clusters has room for all of theirs
layout(constant_id = 38) const bool OUTPUT_JACOBIAN = false;  // contact_cells and tile_changes are wanted, skin/cell_fluxes.glsl

layout(constant_id = 39) const bool LEAVE_UNTOUCHED = true;  // where nothing is near, kLeavesUntouched and kManySmallTiles

layout(constant_id = 40) const float REACH = 0.0;       // up to which height over the skin surfaces matter to the law, m
layout(constant_id = 41) const uint LIST = kNumLists;    // of instances that this pass goes through: kListWholeMesh, kListCandidates; all
layout(constant_id = 42) const bool IS_LAST = true;      // to write contact_normal and tile_results; of some laws, passes over taxels do

// A software driver computes both sides of every branch and a loop's body at least once, so what a model, sensor or batch does not need is left
// out by constants.
const uint kNoSearch = 0u;         // no instance is driven by load
const uint kSearchInTile = 1u;     // in this pass, over its one tile
const uint kSearchOverTiles = 2u;  // by load.comp, over all tiles
const uint kSearchEnded = 3u;      // the frame of a sensor with friction or relaxation at the offsets that this search has found
const bool kHasMesh = (KINDS & 1u) != 0;
const bool kHasAnalytic = (KINDS & ~1u) != 0;
const bool kOnlyPolyhedra = KINDS == (1u << kKindPolyhedron);
// Heights go through the tile, but for a single analytic solid, whose heights are computed where they are summed; not a torus's, which take long, nor where
// a sample's neighbours are asked for.
bool usesTile() { return OUTPUT_JACOBIAN || kHasMesh || MANY_SLOTS || SEARCH == kSearchInTile || (KINDS & (1u << kKindTorus)) != 0; }

FOURS(0, Poses);
layout(std430, set = 0, binding = 1) readonly buffer Instances { InstanceRecord instances[]; };
layout(std430, set = 0, binding = 2) readonly buffer Step { StepRecord step_record; };
FOURS(3, Objects);
FOURS(4, Groups);
FOURS(5, Clusters);
FOURS(6, Quads);
layout(std430, set = 0, binding = 7) readonly buffer Patches { PatchRecord patches[]; };
layout(std430, set = 0, binding = 8) readonly buffer Tiles { TileRecord tiles[]; };
layout(std430, set = 0, binding = 9) readonly buffer SpreadScale { float spread_scale[]; };
layout(std430, set = 0, binding = 10) buffer State { float state[]; };
layout(std430, set = 0, binding = 11) writeonly buffer ContactNormal { float contact_normal[]; };
layout(std430, set = 0, binding = 12) writeonly buffer ContactDepth { float contact_depth[]; };
layout(std430, set = 0, binding = 13) buffer TileResults { TileResult tile_results[]; };
layout(std430, set = 0, binding = 14) buffer Loads { LoadRecord loads[]; };
layout(std430, set = 0, binding = 15) writeonly buffer Problems { uint problems[]; };
FOURS(16, Faces);
layout(std430, set = 0, binding = 17) readonly buffer Motions { MotionRecord motions[]; };
layout(std430, set = 0, binding = 18) buffer FrictionState { Pair friction_state[]; };
layout(std430, set = 0, binding = 19) writeonly buffer ContactShear { float contact_shear[]; };
layout(std430, set = 0, binding = 20) writeonly buffer ContactCells { CellRecord contact_cells[]; };
layout(std430, set = 0, binding = 21) writeonly buffer TileChanges { float tile_changes[]; };
layout(std430, set = 0, binding = 22) readonly buffer Candidates { CandidateRecord candidates[]; };
layout(std430, set = 0, binding = 23) readonly buffer CandidateQuads { uint candidate_quads[]; };
layout(std430, set = 0, binding = 24) buffer Work { uvec4 work[]; };
layout(std430, set = 0, binding = 25) buffer WorkInstances { uint work_instances[]; };
