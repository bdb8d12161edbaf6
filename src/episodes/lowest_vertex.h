// Lowest point of an object for many orientations: lowestPoint() of object.h, accelerated for meshes by a bounding volume hierarchy.
//
// A hierarchy of axis-aligned boxes over the vertices is built once by median splits. A query descends into the box with the lower bound
// first and prunes boxes that cannot contain a lower vertex, instead of visiting all triangles. Scenes need one query per episode.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "taxelsim/object.h"

namespace taxelsim {

class LowestVertex {
 public:
  // `object` must outlive this.
  explicit LowestVertex(const Object& object);

  // Equals lowestPoint(object, R_SO) up to the summation order of the vertices of a level face. Throws what lowestPoint() throws.
  Vector3 find(const Quaternion& R_SO) const;

 private:
  using Vertex = std::array<float, 3>;

  // Box around vertices [first, end). Nodes are in depth-first order: the left child follows its parent. Leaves have right == 0.
  struct Node {
    Vertex min, max;
    std::uint32_t first, end, right;
  };

  void build(std::uint32_t first, std::uint32_t end);
  double lowerBound(const Node& node, const Vector3& u) const;
  void findLowest(std::uint32_t index, const Vector3& u, double& lowest) const;
  void sumBelow(std::uint32_t index, const Vector3& u, double level, Vector3& sum, double& count) const;

  const Object& object_;
  std::vector<Vertex> vertices_;  // vertices used by a triangle, in tree order; empty for solids
  std::vector<Node> nodes_;
  double slack_ = 0;  // m: vertices up to this far above the lowest one count as level with it
};

}  // namespace taxelsim
