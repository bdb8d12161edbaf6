// Mends a simplified mesh: puts vertices of the original back, and turns edges, wherever the two surfaces are farther apart than allowed,
// until they are proven not to be. Not a simplifier: the number of triangles never falls.
#pragma once

#include <algorithm>
#include <array>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "geometry/surface_distance.h"
#include "geometry/triangle_tree.h"
#include "taxelsim/object.h"

namespace taxelsim {

class Mender {
 public:
  using Triangle = std::array<std::uint32_t, 3>;

  // `original` must outlive this.
  Mender(const Mesh& original, double max_error);

  // `triangles` over the vertices of the original, with what had to be changed so that no point of either surface is farther than max_error
  // from the other. Nothing when that takes more than `max_triangles`, comes to no end, or isExhausted(). Edges of a single triangle stay.
  std::optional<std::vector<Triangle>> mend(std::vector<Triangle> triangles, std::size_t max_triangles);

  // All calls together have taken so much effort that no further one will prove anything.
  bool isExhausted() const { return effort_.isExhausted(); }

 private:
  // A place where a triangle of the draft is too far from the original, or the other way round.
  struct Fault {
    double distance = 0;                  // m; 0: none
    std::optional<std::uint32_t> vertex;  // of the original, that the triangle needs; none where they all are there
    Vector3 place{0, 0, 0};
  };
  struct Edge {
    std::uint32_t low;  // vertices, low < high
    std::uint32_t high;
    std::uint32_t triangle;

    Edge(std::uint32_t a, std::uint32_t b, std::uint32_t index) : low(std::min(a, b)), high(std::max(a, b)), triangle(index) {}
  };

  void findVerticesBeyond(const TriangleTree& tree);
  void findTrianglesBeyond(const TriangleTree& tree);
  void addFault(std::uint32_t triangle, const Triangle& missing, const Vector3& place);

  bool mendFaults();
  bool insertVertex(std::uint32_t triangle);
  bool turnEdge(std::uint32_t triangle);
  void replace(std::uint32_t triangle, std::span<const Triangle> parts);

  std::array<Edge, 3> edgesOf(std::uint32_t triangle) const;
  std::span<const Edge> sharingOf(const Edge& edge) const;
  std::array<Triangle, 2> halvesOf(const Edge& edge, std::uint32_t vertex) const;
  static std::uint32_t cornerOpposite(const Edge& edge, const Triangle& triangle);
  static bool isBefore(const Edge& a, const Edge& b);
  double squaredDistanceTo(const Edge& edge, const Vector3& place) const;
  bool hasArea(const Triangle& triangle) const;
  Vector3 positionOf(std::uint32_t vertex) const;

  const Mesh& original_;
  TriangleTree tree_;                    // of the original
  std::vector<std::uint32_t> vertices_;  // of the original, those that it uses
  double max_error_;
  Effort effort_;

  Mesh draft_;                     // over the original's vertices
  std::vector<bool> is_in_draft_;  // each vertex
  std::vector<bool> is_within_;    // each triangle of the draft: proven to be near the original

  // Of a round: faults and edges of the draft as it began, and which triangles are not as they were.
  std::vector<Fault> faults_;  // of each triangle, the worst
  bool has_faults_ = false;
  std::vector<Edge> edges_;  // sorted, so that those of triangles which share one stand side by side
  std::vector<bool> is_changed_;
};

}  // namespace taxelsim
