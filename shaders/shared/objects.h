// Objects of a model: analytic solids, meshes, convex polyhedra. Constant after the model is made.
#ifndef TAXELSIM_SHADERS_SHARED_OBJECTS_H
#define TAXELSIM_SHADERS_SHARED_OBJECTS_H

#include "shared/types.h"

TAXELSIM_LAYOUT_BEGIN

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

TAXELSIM_LAYOUT_END

#endif
