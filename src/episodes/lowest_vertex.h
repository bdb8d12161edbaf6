// lowestPoint() of object.h for one object and many orientations: a mesh is sorted into a tree of boxes once, so that an orientation costs
// a walk down the tree instead of a look at every triangle. Scenes that draw an orientation for every frame need that.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "taxelsim/object.h"

namespace taxelsim {

class LowestVertex {
 public:
  // Keeps a reference: `object` must outlive this.
  explicit LowestVertex(const Object& object);

  // What lowestPoint(object, R_SO) gives, up to the order in which the vertices of a level face are summed. Throws what it throws.
  Vector3 find(const Quaternion& R_SO) const;

 private:
  using Vertex = std::array<float, 3>;

  // A box around vertices [first, end). Nodes lie in depth-first order: the left child follows its parent; a leaf has right == 0.
  struct Node {
    Vertex min, max;
    std::uint32_t first, end, right;
  };

  void build(std::uint32_t first, std::uint32_t end);
  double bound(const Node& node, const Vector3& u) const;
  void findLowest(std::uint32_t index, const Vector3& u, double& lowest) const;
  void sumBelow(std::uint32_t index, const Vector3& u, double level, Vector3& sum, double& count) const;

  const Object& object_;
  std::vector<Vertex> vertices_;  // those that a triangle uses, in the tree's order; empty for solids
  std::vector<Node> nodes_;
  double slack_ = 0;  // m
};

}  // namespace taxelsim
