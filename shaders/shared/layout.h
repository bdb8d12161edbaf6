// Structs and constants that host and device share; compiled by C++ and by GLSL (std430). Only 16-byte rows, so that both lay them out
// alike. Frames by monogram: S sensor, P patch, O object, C chart (the frame of moments: P of a single patch, else S).
#ifndef TAXELSIM_SHADERS_SHARED_LAYOUT_H
#define TAXELSIM_SHADERS_SHARED_LAYOUT_H

#ifdef __cplusplus
#include <glm/glm.hpp>
namespace taxelsim::layout {
using uint = std::uint32_t;
using glm::ivec4;
using glm::uvec4;
using glm::vec4;
#define TAXELSIM_CONSTANT inline constexpr uint
#define TAXELSIM_FLOAT inline constexpr float
#else
#define TAXELSIM_CONSTANT const uint
#define TAXELSIM_FLOAT const float
#endif

// ---- objects ----

TAXELSIM_CONSTANT kKindMesh = 0u;
TAXELSIM_CONSTANT kKindSphere = 1u;
TAXELSIM_CONSTANT kKindCylinder = 2u;
TAXELSIM_CONSTANT kKindCapsule = 3u;
TAXELSIM_CONSTANT kKindBox = 4u;
TAXELSIM_CONSTANT kKindHalfSpace = 5u;
TAXELSIM_CONSTANT kKindCone = 6u;
TAXELSIM_CONSTANT kKindTorus = 7u;
TAXELSIM_CONSTANT kKindPolyhedron = 8u;  // a convex mesh of few faces

// A mesh lies on a lattice of its own: position in O = lattice_origin + lattice_step * q, q of kLatticeBits bits per axis, unsigned.
TAXELSIM_CONSTANT kLatticeBits = 21u;
// Triangles come in pairs that share an edge: vertices p, q, r, s of (p, q, r) and, unless s is r, (r, q, s).
TAXELSIM_CONSTANT kQuadWords = 8u;  // four vertices of two words: x | y << 21, y >> 11 | z << 10
TAXELSIM_CONSTANT kQuadsPerCluster = 4u;
TAXELSIM_CONSTANT kClustersPerGroup = 32u;
// Seen by a sensor, vertices are rounded to 2^-subpixel_bits of the samples' spacing, and quads are either all small, no edge longer than
// 2^kSmallEdgeBits of these units, or rastered row by row.
TAXELSIM_CONSTANT kSubpixelMask = 0xFFu;
TAXELSIM_CONSTANT kLargeTriangles = 0x100u;
TAXELSIM_CONSTANT kSmallEdgeBits = 14u;

struct ObjectRecord {
  uvec4 kind_groups;  // kind; of meshes first group, number of groups, subpixel bits | kLargeTriangles; of polyhedra first face
  vec4 parameters;    // of analytic solids: radius and half length, half sizes, radius and height, both radii
  vec4 lattice;       // of meshes: the middle of the lattice in O, m; lattice_step, m
  vec4 center;        // of the bounding box, in O, m
  vec4 half_size;     // of the bounding box, m
};

// An axis-aligned box around the quads of a cluster or the clusters of a group: three words of low | high << 16 per axis in units of
// 2^kBoxShift lattice steps, rounded outwards. The fourth word of a group is first cluster | (number of clusters - 1) << kFirstBits. A
// cluster holds the kQuadsPerCluster quads of its own number; where it has fewer, the rest are points.
TAXELSIM_CONSTANT kBoxShift = 5u;
TAXELSIM_CONSTANT kFirstBits = 27u;

// ---- the sensor ----

struct PatchRecord {
  vec4 row0, row1, row2;  // X_PS: rows of (R_PS | p)
  uvec4 grid;             // rows, cols, first taxel, 0
  vec4 spacing;           // sample spacing along x, y of P, m; sample area, m^2; how deep under the skin surfaces are seen, m
};

// A rectangle of whole taxels that one workgroup computes.
struct TileRecord {
  uvec4 place;  // patch, first row, first col, 0
  uvec4 size;   // rows, cols, 0, 0
};

// Per taxel, two rows.
struct TaxelRecord {
  vec4 chart;    // position in C, m; area, m^2
  vec4 readout;  // gain, trigger (N), patch, 0
};

TAXELSIM_CONSTANT kMaxCurvePieces = 16u;

struct SensorRecord {
  vec4 curve0;  // coefficients 1 to 4, counts / N^m
  vec4 curve1;  // coefficient 5, 0, 0, 0
  // Of a curve of straight pieces: where each begins, N and counts; its slope, counts/N, and the inverse of that.
  vec4 curve_pieces[kMaxCurvePieces];
  vec4 X_SC_row0, X_SC_row1, X_SC_row2;
  vec4 hysteresis_strength;  // of up to four elements
  vec4 hysteresis_width;     // N
  vec4 creep_fraction;       // of up to four terms
};

// A plane in which moments are taken: that of a patch, or xy of S, which is the last one. Chart C here is P or S.
struct PlaneRecord {
  vec4 X_SC_row0, X_SC_row1, X_SC_row2;
  uvec4 grid;   // rows, cols, first taxel; how many taxels away from one that does not report forces are those of a wide face
  vec4 pitch;   // along x and y, m; the larger of them; N at a taxel per Pa on a wide face
  vec4 spread;  // xx, xy, yy: what the spread and the taxels' size add to second moments, m^2; 0
};

// Taxels of a row of the image pass where the sensor is not one grid patch, or its spread no kernel.
TAXELSIM_CONSTANT kListCols = 16u;

// ---- a batch ----

struct PoseRecord {
  vec4 row0, row1, row2;  // X_SO: rows of (R_SO | p)
  vec4 object;            // index or -1, 0, 0, 0
};

// What the object in a slot has done since the step before, before a load search moves it: a point p of it, in S, was displaced by A p + t,
// the rows being (A | t). Computed in double on the host: the difference of two float32 poses would make a resting object creep.
struct MotionRecord {
  vec4 row0, row1, row2;
  vec4 known;  // 1, or 0 where the slot holds another object than before or the instance has been reset: then A and t are 0; 0, 0, 0
};

// A slot's number fits into so many bits.
TAXELSIM_CONSTANT kSlotBits = 3u;

TAXELSIM_CONSTANT kFlagNewFrame = 1u;   // the sensor delivers a frame in this step
TAXELSIM_CONSTANT kFlagFirstStep = 2u;  // the first step since reset
TAXELSIM_CONSTANT kFlagLoadDriven = 4u;

// What the contact pass need look at of an instance's mesh, kept from step to step: shaders/keep_candidates.comp. The quads' numbers are in
// a buffer of their own, kMostCandidates of an instance.
TAXELSIM_CONSTANT kMostCandidates = 640u;
TAXELSIM_CONSTANT kNoCandidates = 0xFFFFFFFFu;
TAXELSIM_CONSTANT kFewestGroups = 2u;  // of a mesh that has candidates: a smaller one is culled at once
struct CandidateRecord {
  vec4 row0, row1, row2;  // X_PO when they were found; where there are none, in the step before
  vec4 center;            // of the part of the window that the object's bounds reached, in P, m; steps since; where there are none, steps
                          // until they are looked for again
  vec4 half_size;         // of that part, m; share of the steps ahead that is looked, where all were too many candidates
  vec4 low, high;         // how far points of the object may move along x, y, z of P, m; 0
  uvec4 list;             // object + 1, 0 for none; number of candidates or kNoCandidates; 0, 0
};

// Lists of instances that passes go through, with as many workgroups as they need: columns, rows, 1 (VkDispatchIndirectCommand), entries.
// After these a row whose first word counts the instances that have candidates.
TAXELSIM_CONSTANT kListToFind = 0u;   // candidates are to be found
TAXELSIM_CONSTANT kListWithout = 1u;  // the contact pass looks at the whole mesh
TAXELSIM_CONSTANT kListWith = 2u;     // it looks at candidates
TAXELSIM_CONSTANT kNumLists = 3u;
TAXELSIM_CONSTANT kMostColumns = 65535u;  // of workgroups

struct InstanceRecord {
  vec4 drive;   // load (N), gain, spread of log gain, extra noise (counts)
  uvec4 keys;   // episode (low, high word), frame, flags
  uvec4 clock;  // steps since reset, 0, 0, 0
};

struct StepRecord {
  uvec4 batch;       // instances; slots, or in a batch of contacts the room for contacts of an instance; seed (low, high word)
  vec4 time;         // dt (s), 1/dt, share of the low-pass, standard deviation of the random walk's step (counts)
  vec4 creep;        // share of the way to its end that each term goes in dt
  uvec4 delay;       // slot of this step in the ring of forces, steps back to the force that a frame shows, 0, 0
  uvec4 candidates;  // 1: instances that have candidates are done apart; 0, 0, 0
  vec4 law;          // of a law with taxels that move: what a step does to them
  vec4 contacts;     // contact_band (m), 0, 0, 0
  // Of a skin that relaxes; stiffnesses as shares of the instantaneous.
  vec4 relaxation;            // what stays for ever, that of strain added in this step, 0, 0
  vec4 relaxation_fade;       // what of each term's overstress is left after dt
  vec4 relaxation_fade_rest;  // the same, what float32 leaves out
  vec4 relaxation_growth;     // of each term, that of strain added in this step
  vec4 relaxation_fraction;   // the same in a first press
};

// A contact from another engine.
struct ContactRecord {
  vec4 point;  // position in S, m; normal force, N
};

// Height of no surface, m: 2^100, whose lowest bits are free for a slot's number.
TAXELSIM_FLOAT kNoHeight = 1.2676506e30f;

// Forces that the ring of a delay keeps, one a step.
TAXELSIM_CONSTANT kMaxDelaySteps = 32u;
// Per tile the state of friction is kFrictionHeader pairs of words, the rectangle of taxels whose samples have one (first row, end row,
// first col, end col, of the patch), then a pair per sample: along x and y of P the traction (Pa), or of the law lugre how far the bristles
// are bent, in units of friction; kNoContact where nothing touched. An elastic layer is one tile, its nodes are the taxels and samples.
TAXELSIM_CONSTANT kFrictionHeader = 2u;
TAXELSIM_CONSTANT kNoContact = 0x7F7FFFF8u;  // as the bits of x: larger than any of them, and free for a slot's number

// Words per tile that precede those of the samples in the state of a skin that relaxes: the rectangle of taxels that has been reached.
TAXELSIM_CONSTANT kRelaxationHeader = 4u;

// What the contact pass leaves per instance and tile.
struct TileResult {
  vec4 force;    // on the sensor, in S, N; samples at least as deep as the skin is thick
  vec4 torque;   // about S's origin, in S, N m; sum of the taxels' normal forces, N
  uvec4 window;  // of one grid: rectangle of taxels that may carry force: first row, end row, first col, end col; empty: all 0. Else 1
                 // where a patch that looks along z of S met a surface too deep to be seen; 0, 0, 0
};

// Status of a load search. Closing: evaluated once more, at the upper bound, then carried or out of reach.
TAXELSIM_FLOAT kLoadSearching = 0.0f;
TAXELSIM_FLOAT kLoadCarried = 1.0f;
TAXELSIM_FLOAT kLoadOutOfReach = 2.0f;
TAXELSIM_FLOAT kLoadClosingCarried = 3.0f;
TAXELSIM_FLOAT kLoadClosingOutOfReach = 4.0f;

// State of the load search of one instance.
struct LoadRecord {
  vec4 bracket;  // offset (m), a lower and an upper bound of it, status
  vec4 forces;   // at the lower and the upper bound, N; at the offset; evaluations so far
};

// ---- features ----
// An instance's features in the feature buffer: block after block, each (num_instances x components).

TAXELSIM_CONSTANT kFeatureTotalForce = 0u;
TAXELSIM_CONSTANT kFeaturePeakForce = 1u;
TAXELSIM_CONSTANT kFeatureCenterOfPressure = 2u;  // 3
TAXELSIM_CONSTANT kFeatureSecondMoments = 5u;     // 3
TAXELSIM_CONSTANT kFeatureEigenvalues = 8u;       // 2
TAXELSIM_CONSTANT kFeatureEdgeAngle = 10u;
TAXELSIM_CONSTANT kFeatureEdgeConfidence = 11u;
TAXELSIM_CONSTANT kFeatureContactArea = 12u;
TAXELSIM_CONSTANT kNumImageFeatures = 13u;  // the block of measured ones starts at 0, that of clean ones here
TAXELSIM_CONSTANT kFeatureSaturated = 26u;
TAXELSIM_CONSTANT kFeatureContactWrench = 27u;  // 6
TAXELSIM_CONSTANT kFeatureOverPenetration = 33u;
TAXELSIM_CONSTANT kFeatureLoadOffset = 34u;
TAXELSIM_CONSTANT kFeatureLoadReached = 35u;
TAXELSIM_CONSTANT kFeatureOffArrayLoad = 36u;
TAXELSIM_CONSTANT kFeatureOffArrayContacts = 37u;
// Of laws that are solved over all samples at once.
TAXELSIM_CONSTANT kFeatureContactResidual = 38u;
TAXELSIM_CONSTANT kFeatureContactIterations = 39u;
TAXELSIM_CONSTANT kNumFeatures = 40u;

// ---- contact features ----
// Rows of an instance: the sensor, its patches (none of a list of taxels), its regions. Block after block as above, each (num_instances x
// num_rows x components): the image features at the numbers that they have above, then these, then the number of regions (num_instances).

TAXELSIM_CONSTANT kContactWindowedEdgeAngle = 13u;
TAXELSIM_CONSTANT kContactWindowedEdgeConfidence = 14u;
TAXELSIM_CONSTANT kContactTilt = 15u;  // 2
TAXELSIM_CONSTANT kContactTiltConfidence = 17u;
TAXELSIM_CONSTANT kContactType = 18u;
TAXELSIM_CONSTANT kContactPatch = 19u;
TAXELSIM_CONSTANT kNumContactFeatures = 20u;

// ---- tactile Jacobian ----
// How features change with the six coordinates of the sensor's twist, v and w in S. Rows of an instance: the sensor, its patches (none of a
// list of taxels). Block after block as above, each (num_instances x num_rows x components x 6), then the wrench's (num_instances x 6 x 6).

TAXELSIM_CONSTANT kJacobianCenterOfPressure = 0u;  // 3 x 6
TAXELSIM_CONSTANT kJacobianTotalForce = 18u;       // 6
TAXELSIM_CONSTANT kJacobianEdgeAngle = 24u;        // 6
TAXELSIM_CONSTANT kNumJacobian = 30u;
TAXELSIM_CONSTANT kNumWrenchJacobian = 36u;

// What the contact pass leaves for it of a taxel: skin/cell_fluxes.glsl.
struct CellRecord {
  vec4 low_x, high_x, low_y, high_y;  // along each side: integrals of f (N/m), of G (N), of f times the coordinate along it (N). Last:
                                      // integrals of f' over the cell times 1, x, y (N/m, N, N); 1 where all this was written, else 0
};
// And of a tile, for each partial sum of that pass: the changes of force and its first moments about the origin of P by the object's twist
// in P; of a tile that nothing is near only kNoHeight, as the first of them.
TAXELSIM_CONSTANT kTileChanges = 18u;  // 6 x 3

// ContactType of the public header.
TAXELSIM_FLOAT kContactNone = 0.0f;
TAXELSIM_FLOAT kContactPoint = 1.0f;
TAXELSIM_FLOAT kContactEdge = 2.0f;
TAXELSIM_FLOAT kContactArea = 3.0f;

// A taxel's word: its region, named by the lowest taxel in it, or kNoRegion where it does not report; plus kCoreTaxel where it lies so far
// inside that its force is that of a wide face, and kCoreInRow where that is so along its row.
TAXELSIM_CONSTANT kNoRegion = 0x3FFFFFFFu;
TAXELSIM_CONSTANT kCoreInRow = 0x40000000u;
TAXELSIM_CONSTANT kCoreTaxel = 0x80000000u;

// ---- elastic layer ----
// Arrays over its nodes are rows of strips of kStrip nodes, the last one filled up; an instance has one array of each kind.
TAXELSIM_CONSTANT kStrip = 8u;
TAXELSIM_CONSTANT kLayerPressure = 0u;  // as what it would move its own cell by, thicknesses; lasts from frame to frame
TAXELSIM_CONSTANT kLayerTarget = 1u;    // the displacement asked for, thicknesses
TAXELSIM_CONSTANT kLayerExcess = 2u;    // displacement under the pressures less the target
TAXELSIM_CONSTANT kLayerDirection = 3u;
TAXELSIM_CONSTANT kLayerAnswer = 4u;  // the displacement under the direction
TAXELSIM_CONSTANT kNumLayerArrays = 5u;
// Of a skin that relaxes, both from frame to frame and in the units of pressures; then one more for each further term.
TAXELSIM_CONSTANT kLayerStrain = 5u;
TAXELSIM_CONSTANT kLayerOverstress = 6u;

// ---- random numbers; base/philox.h has the same values ----
TAXELSIM_CONSTANT kPurposeReadoutNoise = 1u;
TAXELSIM_CONSTANT kPurposeTaxelGain = 2u;
TAXELSIM_CONSTANT kPurposeBias = 4u;
TAXELSIM_CONSTANT kPurposeDeadTaxel = 5u;
TAXELSIM_CONSTANT kPurposeRandomWalk = 6u;

#ifdef __cplusplus
}  // namespace taxelsim::layout
#endif
#undef TAXELSIM_CONSTANT
#undef TAXELSIM_FLOAT

#endif
