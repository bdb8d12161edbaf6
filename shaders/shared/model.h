// A model: its objects, the work that they take, and its sensor. Constant after the model is made.
#ifndef TAXELSIM_SHADERS_SHARED_MODEL_H
#define TAXELSIM_SHADERS_SHARED_MODEL_H

#include "shared/types.h"

TAXELSIM_LAYOUT_BEGIN

// ---- objects: analytic solids, meshes, convex polyhedra ----

TAXELSIM_CONSTANT kKindMesh = 0u;
TAXELSIM_CONSTANT kKindSphere = 1u;
TAXELSIM_CONSTANT kKindCylinder = 2u;
TAXELSIM_CONSTANT kKindCapsule = 3u;
TAXELSIM_CONSTANT kKindBox = 4u;
TAXELSIM_CONSTANT kKindHalfSpace = 5u;
TAXELSIM_CONSTANT kKindCone = 6u;
TAXELSIM_CONSTANT kKindTorus = 7u;
TAXELSIM_CONSTANT kKindPolyhedron = 8u;  // a convex mesh with few faces

// Mesh vertices are quantized to a lattice: position in O = lattice origin + lattice step * q, with kLatticeBits unsigned bits per axis.
TAXELSIM_CONSTANT kLatticeBits = 21u;

// Two triangles that share an edge form a quad with vertices p, q, r, s: triangles (p, q, r) and (r, q, s). A quad with s = r has one
// triangle. A vertex takes two words: x | y << 21, y >> 11 | z << 10.
TAXELSIM_CONSTANT kQuadWords = 8u;
TAXELSIM_CONSTANT kQuadsPerCluster = 4u;
TAXELSIM_CONSTANT kClustersPerGroup = 32u;

// The rasterizer rounds vertices to 2^-subpixel_bits of the sample spacing. A mesh without kLargeTriangles has no edge longer than
// 2^kSmallEdgeBits of these units. A mesh with kLargeTriangles is rasterized row by row.
TAXELSIM_CONSTANT kSubpixelMask = 0xFFu;
TAXELSIM_CONSTANT kLargeTriangles = 0x100u;
TAXELSIM_CONSTANT kSmallEdgeBits = 14u;
// A closed mesh whose triangles all wind counter-clockwise seen from outside.
TAXELSIM_CONSTANT kClosed = 0x200u;

// One object. Frame O.
struct ObjectRecord {
  uvec4 kind_groups;  // kind; mesh: first group, number of groups, subpixel bits | kLargeTriangles | kClosed; polyhedron: first face
  vec4 parameters;    // analytic solid, m: radius and half length; half sizes; radius and height; major and minor radius
  vec4 lattice;       // mesh: centre of the lattice, m; lattice step, m
  vec4 center;        // centre of the bounding box, m; 0
  vec4 half_size;     // half sizes of the bounding box, m; 0
};

// Bounding boxes of clusters and groups are uvec4. The first three words are low | high << 16 of one axis of O each, in units of
// 2^kBoxShift lattice steps, rounded outwards. The fourth word of a group is first cluster | (number of clusters - 1) << kFirstBits.
// Cluster c holds quads kQuadsPerCluster * c and following; unused quads are degenerate.
TAXELSIM_CONSTANT kBoxShift = 5u;
TAXELSIM_CONSTANT kFirstBits = 27u;

// Loop iterations that work takes, as estimated: by the host, which gives a workgroup no more than the driver permits, and by the contact
// pass, which counts those of the tiles so far (shaders/driver/loops.glsl).
TAXELSIM_CONSTANT kIterationsPerSample = 3u;
TAXELSIM_CONSTANT kIterationsPerSampleOfTorus = 48u;  // the mean; a ray takes at most 96
TAXELSIM_CONSTANT kIterationsPerTriangle = 2u;
// With area sampling: triangles next to each other share cells; of a solid, most cells on an edge take scan lines.
TAXELSIM_CONSTANT kIterationsPerTriangleOfCells = 4u;
TAXELSIM_CONSTANT kIterationsPerCell = 8u;

// ---- sensor: patches, tiles, taxels, readout ----

// A planar grid of taxels.
struct PatchRecord {
  vec4 row0, row1, row2;  // X_PS: rows of (R_PS | p), m
  uvec4 grid;             // rows, cols, first taxel, 0
  vec4 spacing;           // sample spacing along x and y of P, m; sample area, m^2; largest depth under the skin that is seen, m
};

// A rectangle of whole taxels that one workgroup computes.
struct TileRecord {
  uvec4 origin;  // patch, first row, first col, 0
  uvec4 size;    // rows, cols, 0, 0
};

// One taxel.
struct TaxelRecord {
  vec4 chart;    // position in C, m; area, m^2
  vec4 readout;  // gain; trigger, N; patch; z of the position in `reception`
  // The force that the point spread brings to the taxel if every taxel has the same force: the mean position of its sources, in C, x and y,
  // m; the trigger again, so that a fit takes one fetch; its sum over that force, times the calibrated gain.
  vec4 reception;
};

TAXELSIM_CONSTANT kMaxCurvePieces = 16u;

// Readout of the whole sensor. Force-to-output curve: a polynomial, or straight pieces.
struct SensorRecord {
  vec4 curve0;                         // coefficients 1 to 4, counts/N^k for coefficient k
  vec4 curve1;                         // coefficient 5; the largest x that the polynomial is taken at, N; 0, 0
  vec4 curve_pieces[kMaxCurvePieces];  // start of each straight piece, N and counts; its slope, counts/N; inverse slope, N/counts
  vec4 X_SC_row0, X_SC_row1, X_SC_row2;
  vec4 hysteresis_strength;  // per element, up to four
  vec4 hysteresis_width;     // per element, N
  vec4 creep_fraction;       // per term, up to four
};

// A plane in which moments are computed: that of a patch (C is P), or xy of S (C is S), which is the last one.
struct PlaneRecord {
  vec4 X_SC_row0, X_SC_row1, X_SC_row2;
  uvec4 grid;   // rows; cols; first taxel; a taxel at least this far from all silent taxels belongs to a wide face, in taxels
  vec4 pitch;   // along x and y of C, m; the larger of both, m; taxel force per pressure on a wide face, N/Pa
  vec4 spread;  // second moments of the point spread and of a taxel: xx, xy, yy of C, m^2; 0
  vec4 even;    // second moments of the plane's taxels under even pressure: xx, xy, yy of C, m^2; 0
};

// The mask of the law deformation_mask on grids: RobWorkSim's, integrated over a taxel and over its neighbours along sides and diagonals.
TAXELSIM_FLOAT kMaskMiddle = 0.52464f, kMaskSide = 0.10387f, kMaskCorner = 0.01497f;

// Columns of the image pass for a sensor that is not one grid patch, or whose point spread is not a kernel.
TAXELSIM_CONSTANT kListCols = 16u;

TAXELSIM_LAYOUT_END

#endif
