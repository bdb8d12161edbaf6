// A mesh cut into small boxes, two levels deep, for culling: groups of clusters of triangles. Not a ray tracer's tree: a
// workgroup tests the boxes of one level side by side.
//
//   mesh -> group (up to 32 clusters) -> cluster (up to 4 quads) -> quad (two triangles that share an edge)
//
// A quad is read and turned into samples at once: four vertices instead of six, and one box to walk instead of two. A triangle left without
// a partner is a quad whose last two vertices are one. Vertices lie on a lattice over the mesh's own bounds: 2^21 steps along its longest
// side (0.1 um for 0.2 m), so that a vertex takes two words and neighbours share theirs to the bit.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "taxelsim/object.h"

namespace taxelsim {

inline constexpr std::uint32_t kLatticeBits = 21;
inline constexpr std::uint32_t kQuadsPerCluster = 4;
inline constexpr std::uint32_t kClustersPerGroup = 32;

using LatticePoint = std::array<std::uint32_t, 3>;  // each below 2^kLatticeBits
using Quad = std::array<LatticePoint, 4>;           // triangles (0, 1, 2) and, unless 3 is 2, (2, 1, 3)

struct ClusterBox {
  LatticePoint low{};
  LatticePoint high{};
  std::uint32_t first = 0;  // quad of a cluster, cluster of a group
  std::uint32_t count = 0;
};

struct ClusteredMesh {
  double step = 0;          // m per lattice unit
  Vector3 middle{0, 0, 0};  // lattice point (2^20, 2^20, 2^20), in O, m
  std::vector<ClusterBox> groups;
  std::vector<ClusterBox> clusters;  // those of a group one after another
  std::vector<Quad> quads;           // those of a cluster one after another
};

// Cuts at medians of the longest side; the same mesh gives the same clusters. The mesh must pass checkObject().
ClusteredMesh clusterMesh(const Mesh& mesh);

// The mesh as the device sees it: vertices on the lattice (each within step / 2 per axis), triangles in the order of quads, m, in O.
Mesh latticeMesh(const ClusteredMesh& clustered);

}  // namespace taxelsim
