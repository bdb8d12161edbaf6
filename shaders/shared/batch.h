// A batch: inputs and state per instance, and what the contact pass outputs.
#ifndef TAXELSIM_SHADERS_SHARED_BATCH_H
#define TAXELSIM_SHADERS_SHARED_BATCH_H

#include "shared/types.h"

TAXELSIM_LAYOUT_BEGIN

// ---- inputs ----

// Pose of the object in a slot. Slots whose object is far from the sensor are left out.
struct PoseRecord {
  vec4 row0, row1, row2;  // X_SO: rows of (R_SO | p), m
  vec4 object;            // index, or -1 without an object; number of the slot; 0, 0
};

// The test for objects behind the skin. R: frame of the sensor's one patch, or S.
struct SkinBase {
  vec4 normal_lowest;  // z of R in S; lowest height in R at which an object presses on the skin, m
  vec4 origin;         // height of the origin of S in R, m; 0, 0, 0
};

// Motion of the object of a pose since the previous step, without what a load search adds: a point p of the object (in S, m) was displaced
// by A p + t. Computed in double on the host, because the difference of two float32 poses would make a resting object creep.
struct MotionRecord {
  vec4 row0, row1, row2;  // rows of (A | t), t in m
  vec4 known;             // 1; or 0 with A = t = 0 if the slot's object has changed or the instance was reset; number of the slot, or -1
                          // without an object; 0, 0
};

TAXELSIM_CONSTANT kSlotBits = 3u;  // bits of a slot's number

TAXELSIM_CONSTANT kFlagNewFrame = 1u;   // the sensor outputs a frame in this step
TAXELSIM_CONSTANT kFlagFirstStep = 2u;  // first step since reset
TAXELSIM_CONSTANT kFlagLoadDriven = 4u;
TAXELSIM_CONSTANT kFlagHeld = 8u;  // the step is one of other instances, common/instances.glsl; without other flags

// One instance.
struct InstanceRecord {
  vec4 drive;   // load, N; gain; standard deviation of log gain; extra noise, counts
  uvec4 keys;   // episode (low word, high word), frame, flags
  uvec4 clock;  // steps since reset; steps back to the force that a frame shows, with RANDOM_SKIN; 0, 0
  vec4 skin;    // with RANDOM_SKIN factors on stiffness, friction, trigger, hysteresis
  vec4 spread;  // with RANDOM_SKIN share of a force that the spread takes; for the host the factor on the delay; spread of the triggers; 0
};

// One step of the whole batch.
struct StepRecord {
  uvec4 batch;       // instances; poses, or capacity for contacts, of an instance; seed (low word, high word)
  vec4 time;         // dt, s; 1/dt, 1/s; low-pass coefficient; standard deviation of the random walk's step, counts
  vec4 creep;        // relaxation of each creep term towards its end value in dt, as a fraction
  uvec4 delay;       // slot of this step in the ring of forces; steps back to the force that a frame shows; 0, 0
  uvec4 candidates;  // 1 if instances with candidates have their own dispatch; 0, 0, 0
  vec4 law;          // parameters of one step of a law whose taxels move
  vec4 contacts;     // contact_band, m; 0, 0, 0
  // A skin that relaxes. Stiffnesses are fractions of the instantaneous stiffness.
  vec4 relaxation;            // equilibrium stiffness, stiffness for the strain added in this step, 0, 0
  vec4 relaxation_fade;       // decay factor of each term's overstress in dt, rounded to float32
  vec4 relaxation_fade_rest;  // the rounding error of relaxation_fade
  vec4 relaxation_growth;     // stiffness of each term for the strain added in this step
  vec4 relaxation_fraction;   // stiffness of each term in a first press
};

// A contact from another physics engine.
struct ContactRecord {
  vec4 point;  // position in S, m; normal force, N
};

// ---- state ----

TAXELSIM_CONSTANT kMaxDelaySteps = 32u;  // forces in the ring of a delay, one per step

// State of a tile: this many elements of four words with rectangles of taxels, then those of its samples, skin/sample_states.glsl.
TAXELSIM_CONSTANT kStateHeader = 2u;

// Friction state of an elastic layer: this many pairs of words with the rectangle of nodes that have state (first row, end row, first col,
// end col), then a pair per node.
TAXELSIM_CONSTANT kFrictionHeader = 2u;
TAXELSIM_CONSTANT kNoFrictionState = 0x7F7FFFF8u;  // bits of x without contact: larger than any value, with kSlotBits free bits

// Status of a load search. In the closing states the contact is evaluated once more, at the upper bound.
TAXELSIM_FLOAT kLoadSearching = 0.0f;
TAXELSIM_FLOAT kLoadCarried = 1.0f;
TAXELSIM_FLOAT kLoadOutOfReach = 2.0f;
TAXELSIM_FLOAT kLoadClosingCarried = 3.0f;
TAXELSIM_FLOAT kLoadClosingOutOfReach = 4.0f;
TAXELSIM_FLOAT kLoadRefining = 5.0f;  // searching below a float's resolution of the offset

// Load search of one instance. The objects are moved along z of S by the offset, which is added to their poses, and by the rest, which is
// added to the heights over the patches. The bracket is of the offset; while refining, of the rest.
struct LoadRecord {
  vec4 bracket;  // offset, lower bound, upper bound, m; status
  vec4 forces;   // force along -z of S at the lower bound, at the upper bound, N; rest, m; number of evaluations
};

// Bounds of an object in O, infinite ones cut, from which a search over tiles begins.
struct LoadBoundsRecord {
  vec4 center, half_size;  // m; 0
};

// ---- area sampling ----

// A cell is at the full thickness of the skin if an object covers more than this share of it, with this part of the thickness as the mean
// depth of the covered part.
TAXELSIM_FLOAT kLeastShareOfFull = 0.25f;
TAXELSIM_FLOAT kFullDepth = 0.999f;

// ---- outputs of the contact pass ----

TAXELSIM_FLOAT kNoHeight = 1.2676506e30f;  // height without a surface, m: 2^100, whose lowest kSlotBits bits are free

// Result of one tile of an instance. Frame S.
struct TileResult {
  vec4 force;    // force on the sensor, N; number of samples at least as deep as the skin's thickness
  vec4 torque;   // torque about the origin of S, N m; sum of the taxels' normal forces, N
  uvec4 window;  // one grid patch: rectangle of taxels that may have force (first row, end row, first col, end col), empty if none.
                 // Else: 1 if a patch that looks along z of S met a surface too deep to be seen; 0, 0, 0
};

// Sums of one taxel for the tactile Jacobian: skin/cell_fluxes.glsl. f is the pressure, G its integral over depth; f' is df/d(depth).
struct CellRecord {
  vec4 low_x, high_x, low_y, high_y;  // integrals along each side of the cell: of f (N/m), of G (N), of f times the coordinate along the
                                      // side (N). Last components: integrals of f' over the cell times 1, x, y (N/m, N, N); 1 if the
                                      // record was written, else 0
};
// And of one tile, for each partial sum: changes of force and of its first moments about the origin of P by the object's twist in P. A tile
// without a near surface has only kNoHeight as its first word.
TAXELSIM_CONSTANT kTileChanges = 18u;  // 6 x 3

// ---- candidates: mesh quads that the contact pass tests for an instance, kept from step to step (shaders/keep_candidates.comp) ----

TAXELSIM_CONSTANT kMaxCandidates = 640u;        // per instance; the size of its part of the buffer of quad numbers
TAXELSIM_CONSTANT kNoCandidates = 0xFFFFFFFFu;  // instead of the number of candidates
TAXELSIM_CONSTANT kMinGroups = 2u;              // a mesh with fewer groups is culled in the contact pass

// Candidates of one instance. Frame P.
struct CandidateRecord {
  vec4 row0, row1, row2;  // X_PO when the candidates were found; without candidates, X_PO of the previous step
  vec4 center;            // centre of the part of the window inside the object's bounds, m; steps since, or without candidates the steps
                          // until the next search
  vec4 half_size;         // half sizes of that part, m; factor on the number of steps that candidates are found for, 0 for 1
  vec4 low, high;         // bounds of the displacement of the object's points along x, y, z, m; 0
  uvec4 list;             // object + 1, or 0 for none; number of candidates, or kNoCandidates; 0, 0
};

// Lists of instances. Each has a row: columns, rows and layers of workgroups (VkDispatchIndirectCommand), then the number of entries. The
// first word of row kNumLists counts the instances with candidates.
TAXELSIM_CONSTANT kListFindCandidates = 0u;  // instances whose candidates are to be found
TAXELSIM_CONSTANT kListWholeMesh = 1u;       // instances for which the contact pass culls the whole mesh
TAXELSIM_CONSTANT kListCandidates = 2u;      // instances for which the contact pass tests candidates
TAXELSIM_CONSTANT kNumLists = 3u;
TAXELSIM_CONSTANT kMaxColumns = 65535u;  // columns of workgroups, the smallest limit that Vulkan permits

// Further rows: the tiles that workgroups of the contact pass have left to a second dispatch (shaders/depth/tile_sequence.glsl), and in the
// first word of the last row, whether that dispatch runs. Their list follows those of instances.
TAXELSIM_CONSTANT kLeftTiles = 4u;
TAXELSIM_CONSTANT kSecondDispatch = 5u;
TAXELSIM_CONSTANT kNumWorkRows = 6u;

TAXELSIM_LAYOUT_END

#endif
