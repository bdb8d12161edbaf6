// A mesh cut into small boxes, two levels deep, for culling: groups of clusters of triangles. Not a ray tracer's tree: a workgroup tests
// the boxes of one level side by side.
//
//   mesh -> group (up to 32 clusters) -> cluster (up to 8 triangles)
//
// Vertices lie on a lattice over the mesh's own bounds: 2^21 steps along its longest side (0.1 um for 0.2 m), so that a triangle takes six
// words and neighbours share their vertices to the bit.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "taxelsim/object.h"

namespace taxelsim {

inline constexpr std::uint32_t kLatticeBits = 21;
inline constexpr std::uint32_t kTrianglesPerCluster = 8;
inline constexpr std::uint32_t kClustersPerGroup = 32;

using LatticePoint = std::array<std::uint32_t, 3>;  // each below 2^kLatticeBits

struct ClusterBox {
  LatticePoint low{};
  LatticePoint high{};
  std::uint32_t first = 0;  // triangle of a cluster, cluster of a group
  std::uint32_t count = 0;
};

struct ClusteredMesh {
  double step = 0;          // m per lattice unit
  Vector3 middle{0, 0, 0};  // lattice point (2^20, 2^20, 2^20), in O, m
  std::vector<ClusterBox> groups;
  std::vector<ClusterBox> clusters;                    // those of a group one after another
  std::vector<std::array<LatticePoint, 3>> triangles;  // those of a cluster one after another
};

// Cuts at medians of the longest side; the same mesh gives the same clusters. The mesh must pass checkObject().
ClusteredMesh clusterMesh(const Mesh& mesh);

// The mesh as the device sees it: vertices on the lattice (each within step / 2 per axis), triangles in the clusters' order, m, in O.
Mesh latticeMesh(const ClusteredMesh& clustered);

}  // namespace taxelsim
