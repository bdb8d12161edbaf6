// Mesh clusters for culling on the device: a hierarchy of bounding boxes with two levels. Unlike a bounding volume hierarchy for ray
// tracing it has a wide, fixed fan-out, so that a workgroup tests all boxes of one level in parallel.
//
//   mesh -> group (up to 32 clusters) -> cluster (up to 4 quads) -> quad (two triangles that share an edge)
//
// Construction:
//   1. Quantize the vertices to a lattice over the mesh's bounding box: 2^21 steps along its longest side (0.1 um for 0.2 m). A vertex then
//      takes two 32-bit words, and triangles that share a vertex get it bitwise equal.
//   2. Pair adjacent triangles into quads by greedy matching (Karp-Sipser). A quad needs four vertices instead of six, and one box instead
//      of two. A triangle without a partner becomes a quad whose last two vertices are equal.
//   3. Sort the quads by recursive median splits along the longest side of their centroids' bounding box, at multiples of the group size,
//      then within each group at multiples of the cluster size. Groups and clusters are runs of consecutive quads.
//
// The result is deterministic: ties are broken by index.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "taxelsim/object.h"

namespace taxelsim {

inline constexpr std::uint32_t kLatticeBits = 21;
inline constexpr std::uint32_t kQuadsPerCluster = 4;
inline constexpr std::uint32_t kClustersPerGroup = 32;

using LatticePoint = std::array<std::uint32_t, 3>;  // quantized position, each coordinate < 2^kLatticeBits
using Quad = std::array<LatticePoint, 4>;           // triangles (0, 1, 2) and, unless vertices 2 and 3 are equal, (2, 1, 3)

struct ClusterBox {
  LatticePoint low{};
  LatticePoint high{};
  std::uint32_t first = 0;  // index of its first quad (cluster) or cluster (group)
  std::uint32_t count = 0;  // number of quads or clusters
};

struct ClusteredMesh {
  double step = 0;          // m per lattice unit
  Vector3 middle{0, 0, 0};  // m, in O, position of lattice point (2^20, 2^20, 2^20)
  std::vector<ClusterBox> groups;
  std::vector<ClusterBox> clusters;  // consecutive for each group
  std::vector<Quad> quads;           // consecutive for each cluster
};

// `mesh` must pass checkObject().
ClusteredMesh clusterMesh(const Mesh& mesh);

// The quantized mesh, as the device sees it: m, in O; triangles in the order of the quads. Vertices differ from those of the original by at
// most step / 2 per axis, not counting float rounding.
Mesh latticeMesh(const ClusteredMesh& clustered);

}  // namespace taxelsim
